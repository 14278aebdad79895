use super::{Command, Controller, Target};
use crate::Mechanism;
use crate::error::{SetupError, require};
use crate::tick::Mode;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::StepError;

/// Holds a mechanism against gravity wherever it is, and lets it be moved: u = V_q(q) − d M(q)v.
///
/// Targets are ignored. Source: Siciliano et al., "Robotics", 2009, section 8.5.1, without the proportional term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Float {
    /// Drag d ≥ 0, 1/s: the rate at which an exact model slows down if nothing else acts; 0 leaves that to the mechanism's own friction.
    pub drag: f32,
}

impl Float {
    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("drag", self.drag, self.drag.is_finite() && self.drag >= 0.0, "finite and not negative, 1/s")
    }
}

impl<const N: usize> Controller<N> for Float {
    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        _: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let gravity = model.inverse_dynamics(&state.q, &[0.0; N], &[0.0; N])?;
        let momentum = model.inertial_force(&state.q, &state.v);
        let u = core::array::from_fn(|i| gravity[i] - self.drag * momentum[i]);
        Ok(Command { u, mode: Mode::Float })
    }
}
