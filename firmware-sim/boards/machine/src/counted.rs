use crate::{Control, ENCODERS, FULL, N};
use core::array::from_fn;
use core::convert::Infallible;
use leastaction_firmware_sim::control::{Command, Target};
use leastaction_firmware_sim::{Outcome, Processor};

/// The control loop as a processor of a simulated machine, whose readings become counts, and whose force is the duty's.
#[derive(Debug)]
pub struct Counted<P> {
    control: Control<P>,
    last: Outcome<N>,
}

impl<P> Counted<P> {
    /// Creates the processor.
    pub const fn new(control: Control<P>) -> Self {
        Self { control, last: Outcome::waiting() }
    }
}

impl<P: Processor<N, Error = Infallible>> Processor<N> for Counted<P> {
    type Error = Infallible;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        _: &Target<N>,
    ) -> Result<Outcome<N>, Infallible> {
        let counts = from_fn(|i| measured[i].map(|q| ENCODERS[i].counts(q)));
        let force = FULL * self.control.tick(elapsed, &counts);
        let u = from_fn(|i| if i == 0 { force } else { 0.0 });
        let outcome = *self.control.last();
        self.last = Outcome { command: Command { u, mode: outcome.command.mode }, ..outcome };
        Ok(self.last)
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Infallible> {
        self.control.processor.replay(elapsed, measured, u)
    }

    fn last(&self) -> &Outcome<N> {
        &self.last
    }
}
