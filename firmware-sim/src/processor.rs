use crate::Mechanism;
use crate::control::{Controller, Target};
use crate::firmware::{Firmware, Outcome};
use core::convert::Infallible;

/// Execution of the firmware's part of a tick: [`Firmware`] [in place](InPlace), or a processor at the other end of a link.
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

/// A [`Firmware`] that runs in place, over one model.
#[derive(Debug)]
pub struct InPlace<'m, M, C, const N: usize> {
    /// The model, for which the firmware was begun.
    pub model: &'m M,
    /// The firmware.
    pub firmware: Firmware<C, N>,
}

impl<M: Mechanism<N>, C: Controller<N>, const N: usize> Processor<N> for InPlace<'_, M, C, N> {
    type Error = Infallible;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Infallible> {
        Ok(self.firmware.run(self.model, elapsed, measured, target))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Infallible> {
        Ok(self.firmware.replay(self.model, elapsed, measured, u))
    }

    fn last(&self) -> &Outcome<N> {
        self.firmware.last()
    }
}
