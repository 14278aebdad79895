//! Core's observer behind a slice interface.

use crate::control::{copied, write};
use crate::{Control, ReplicaError, Step, SystemOf};
use leastaction_core::discrete::{Newton, Report};
use leastaction_core::observer::{Integrator, Observer, Tuning};

/// Estimate of a mechanism's state from the readings of its encoders alone; see [`leastaction_core::observer`].
pub trait Watch: Send {
    /// Steps the model under the force that acted since the last samples; does nothing before the first ones.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the step cannot be solved. The estimate is then unchanged.
    fn predict(&mut self, control: Control) -> Result<Option<Report<f32>>, ReplicaError>;

    /// Takes the samples of a step, rad or m, `None` for a missing one.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the estimate would not be finite. The estimate is then unchanged.
    fn correct(&mut self, measured: &[Option<f32>]) -> Result<(), ReplicaError>;

    /// Writes the estimates of q and v, and returns whether there is an estimate: it exists once every coordinate was measured.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if the inertia is singular.
    fn estimate(&self, q: &mut [f32], v: &mut [f32]) -> Result<bool, ReplicaError>;

    /// Writes the estimated offsets of the encoders, reading minus true value, rad or m.
    ///
    /// # Errors
    /// [`ReplicaError::Length`].
    fn zeros(&self, to: &mut [f32]) -> Result<(), ReplicaError>;

    /// Whether the estimate is good enough to act on.
    fn trusted(&self) -> bool;
}

/// Creates the observer of a system; `angle` says which encoders lose whole turns.
pub(crate) fn watch<'c, const N: usize>(
    system: &'c SystemOf<'c, N>,
    (step, newton): (Step, Newton<f32>),
    angle: &[bool],
    tuning: Tuning<f32>,
) -> Result<Box<dyn Watch + 'c>, ReplicaError> {
    let integrator = Integrator::new(step.order, step.h, newton);
    Ok(Box::new(Watching { system, observer: Observer::new(integrator, copied("angle", angle)?, tuning) }))
}

/// An observer beside its system.
struct Watching<'c, const N: usize> {
    system: &'c SystemOf<'c, N>,
    observer: Observer<f32, N>,
}

impl<const N: usize> Watch for Watching<'_, N> {
    fn predict(&mut self, control: Control) -> Result<Option<Report<f32>>, ReplicaError> {
        Ok(self.observer.predict(self.system, &control.sized()?)?)
    }

    fn correct(&mut self, measured: &[Option<f32>]) -> Result<(), ReplicaError> {
        Ok(self.observer.correct(self.system, &copied("the reading", measured)?)?)
    }

    fn estimate(&self, q: &mut [f32], v: &mut [f32]) -> Result<bool, ReplicaError> {
        let Some(state) = self.observer.estimate(self.system)? else { return Ok(false) };
        write("q", &state.q, q)?;
        write("v", &state.v, v)?;
        Ok(true)
    }

    fn zeros(&self, to: &mut [f32]) -> Result<(), ReplicaError> {
        write("the zeros", &self.observer.zeros(), to)
    }

    fn trusted(&self) -> bool {
        self.observer.trusted()
    }
}
