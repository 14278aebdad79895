use crate::Mechanism;
use crate::control::{Controller, Target};
use crate::firmware::{Firmware, Outcome};
use core::convert::Infallible;

/// Execution of the firmware's part of a tick: [`Firmware`] in place, or a processor at the other end of a link.
pub trait Processor<const N: usize> {
    /// Reason why a tick did not run; a [`Firmware`] in place always runs.
    type Error;

    /// Runs `elapsed` ticks after the last run, on the samples that arrived, towards a target.
    ///
    /// # Errors
    /// An error if there is no outcome; the run ends there.
    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Self::Error>;
    /// Runs on the samples and the command of a log; the logged command replaces the controller's.
    ///
    /// # Errors
    /// See [`Processor::run`].
    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Self::Error>;
    /// The last outcome.
    fn last(&self) -> &Outcome<N>;
}

impl<M: Mechanism<N>, C: Controller<M, N>, const N: usize> Processor<N> for Firmware<'_, M, C, N> {
    type Error = Infallible;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Infallible> {
        Ok(self.run(elapsed, measured, target))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Infallible> {
        Ok(self.replay(elapsed, measured, u))
    }

    fn last(&self) -> &Outcome<N> {
        self.last()
    }
}
