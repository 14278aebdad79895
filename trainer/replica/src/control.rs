use crate::ReplicaError;
use leastaction_core::discrete::Order;
use leastaction_core::forces;
use leastaction_core::model::TrainedStep;

/// Step of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Order of the integrator.
    pub order: Order,
    /// Step size h > 0, s.
    pub h: f32,
}

impl From<TrainedStep> for Step {
    fn from(TrainedStep { order, h, .. }: TrainedStep) -> Self {
        Self { order, h }
    }
}

/// Control force τ over one step, at the actuator's output: its values at both ends, linear between them. N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control<'t> {
    /// Force τ at the start.
    pub start: &'t [f32],
    /// Force τ at the end.
    pub end: &'t [f32],
}

impl<'t> Control<'t> {
    /// Creates a control with the same force at both ends (zero-order hold).
    pub const fn held(tau: &'t [f32]) -> Self {
        Self { start: tau, end: tau }
    }

    /// Converts the control to N coordinates.
    pub(crate) fn sized<const N: usize>(self) -> Result<forces::Control<f32, N>, ReplicaError> {
        Ok(forces::Control { start: array("tau", self.start)?, end: array("tau", self.end)? })
    }
}

/// Returns the numbers of a slice, which must have N.
pub(crate) fn array<const N: usize>(what: &'static str, x: &[f32]) -> Result<[f32; N], ReplicaError> {
    copied(what, x)
}

/// Returns the entries of a slice, which must have N.
pub(crate) fn copied<T: Copy, const N: usize>(what: &'static str, x: &[T]) -> Result<[T; N], ReplicaError> {
    x.try_into().map_err(|_| ReplicaError::Length { what, expected: N, found: x.len() })
}

/// Writes numbers to a slice, which must have the same length.
pub(crate) fn write(what: &'static str, from: &[f32], to: &mut [f32]) -> Result<(), ReplicaError> {
    ReplicaError::check_length(what, from.len(), to.len())?;
    to.copy_from_slice(from);
    Ok(())
}
