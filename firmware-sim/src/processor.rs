use crate::Mechanism;
use crate::control::Controller;
use crate::firmware::{Firmware, Outcome};
use core::convert::Infallible;

/// What runs the firmware's part of a tick: [`Firmware`] in place, or a processor at the other end of a link.
pub trait Processor<const N: usize> {
    /// Why a tick did not run; a [`Firmware`] in place always does.
    type Error;

    /// Runs at time t (s), `elapsed` ticks after the last run, on the samples that arrived.
    ///
    /// # Errors
    /// Where there is no outcome; a run ends there.
    fn run(&mut self, t: f32, elapsed: u32, measured: &[Option<f32>; N]) -> Result<Outcome<N>, Self::Error>;
    /// Runs on the samples and the command of a log, which takes the place of the controller's.
    ///
    /// # Errors
    /// As [`Processor::run`].
    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Self::Error>;
    /// The last outcome.
    fn last(&self) -> &Outcome<N>;
    /// Where the mechanism should be at time t, s.
    fn reference(&self, t: f32) -> [f32; N];
}

impl<M: Mechanism<N>, C: Controller<M, N>, const N: usize> Processor<N> for Firmware<'_, M, C, N> {
    type Error = Infallible;

    fn run(&mut self, t: f32, elapsed: u32, measured: &[Option<f32>; N]) -> Result<Outcome<N>, Infallible> {
        Ok(self.run(t, elapsed, measured))
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

    fn reference(&self, t: f32) -> [f32; N] {
        self.reference(t)
    }
}
