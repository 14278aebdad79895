//! The observer of core behind an interface of slices.

use crate::control::{copied, write};
use crate::{Control, ReplicaError, Step, SystemOf};
use leastaction_core::discrete::{Newton, Report};
use leastaction_core::observer::{Integrator, Observer, Tuning};

/// The state of a mechanism from its encoders' readings alone; see [`leastaction_core::observer`].
pub trait Watch: Send {
    /// Steps the model under the force that acted since the last samples; nothing before the first ones.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where the step cannot be solved. The estimate is then what it was.
    fn predict(&mut self, control: Control) -> Result<Option<Report<f32>>, ReplicaError>;

    /// Takes the samples of a step, rad or m, `None` where one is missing.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where the estimate would not be finite. It is then what it was.
    fn correct(&mut self, measured: &[Option<f32>]) -> Result<(), ReplicaError>;

    /// Writes q and v as estimated, and says whether there is an estimate: every coordinate was measured.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where the inertia is singular.
    fn estimate(&self, q: &mut [f32], v: &mut [f32]) -> Result<bool, ReplicaError>;

    /// Writes what the encoders read more than there is, rad or m.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    fn zeros(&self, to: &mut [f32]) -> Result<(), ReplicaError>;

    /// Whether the estimate is fit to act on.
    fn trusted(&self) -> bool;
}

/// The observer of a system; `angle` says which encoders forget whole turns.
pub(crate) fn watch<'c, const N: usize>(
    system: &'c SystemOf<'c, N>,
    (step, newton): (Step, Newton<f32>),
    angle: &[bool],
    tuning: Tuning<f32>,
) -> Result<Box<dyn Watch + 'c>, ReplicaError> {
    let integrator = Integrator::new(step.order, step.h, newton);
    Ok(Box::new(Observer::new(system, integrator, copied("angle", angle)?, tuning)))
}

impl<const N: usize> Watch for Observer<'_, f32, crate::AnyLagrangian<'_, N>, crate::ForcesOf<'_, N>, N> {
    fn predict(&mut self, control: Control) -> Result<Option<Report<f32>>, ReplicaError> {
        Ok(Self::predict(self, &control.sized()?)?)
    }

    fn correct(&mut self, measured: &[Option<f32>]) -> Result<(), ReplicaError> {
        Ok(Self::correct(self, &copied("the reading", measured)?)?)
    }

    fn estimate(&self, q: &mut [f32], v: &mut [f32]) -> Result<bool, ReplicaError> {
        let Some(state) = Self::estimate(self)? else { return Ok(false) };
        write("q", &state.q, q)?;
        write("v", &state.v, v)?;
        Ok(true)
    }

    fn zeros(&self, to: &mut [f32]) -> Result<(), ReplicaError> {
        write("the zeros", &Self::zeros(self), to)
    }

    fn trusted(&self) -> bool {
        Self::trusted(self)
    }
}
