//! Processors in whose memory a bit may flip.

use crate::control::{Command, Controller, Target};
use crate::{Firmware, Mechanism, Mode, Outcome, Processor};
use core::convert::Infallible;
use leastaction_core::guard::{Agreed, Disagreed, Sweep, Voted};
use leastaction_core::model::ModelError;

/// Input of a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input<const N: usize> {
    /// Ticks since the last run.
    pub elapsed: u32,
    /// Readings of the encoders, rad or m.
    pub measured: [Option<f32>; N],
    /// Target of the command.
    pub target: Target<N>,
}

/// Three copies of a [`Firmware`], each over a copy of its model, of which two compute every tick, and the third one if they differ: [`Voted`].
///
/// If no two agree, it commands no force until it is made anew, in [`Mode::Safe`].
#[derive(Clone, Debug)]
pub struct Voting<M, C, const N: usize> {
    copies: Voted<M, Firmware<C, N>>,
    last: Outcome<N>,
    outvoted: u32,
    lost: bool,
}

impl<M, C, const N: usize> Voting<M, C, N>
where
    M: Mechanism<N> + Clone,
    C: Controller<N> + Clone + PartialEq,
{
    /// Creates three copies of a model and of the firmware that was begun over it.
    pub fn new(model: M, firmware: Firmware<C, N>) -> Self {
        let last = *firmware.last();
        Self { copies: Voted::new(model, firmware), last, outvoted: 0, lost: false }
    }

    /// Number of ticks in which a copy was outvoted, and repaired.
    pub const fn outvoted(&self) -> u32 {
        self.outvoted
    }

    /// Whether no two copies agreed.
    pub const fn lost(&self) -> bool {
        self.lost
    }

    /// Runs a tick on an input that was read three times; [`Processor::run`] makes three copies of one.
    pub fn run_on(&mut self, inputs: &[Input<N>; 3]) -> Outcome<N> {
        self.tick(inputs, |model, firmware, Input { elapsed, measured, target }| {
            firmware.run(model, *elapsed, measured, target)
        })
    }

    fn tick<I>(
        &mut self,
        inputs: &[I; 3],
        work: impl FnMut(&M, &mut Firmware<C, N>, &I) -> Outcome<N>,
    ) -> Outcome<N> {
        let agreed = if self.lost { Err(Disagreed) } else { self.copies.run(inputs, work) };
        self.last = match agreed {
            Ok(Agreed { outcome, outvoted }) => {
                self.outvoted = self.outvoted.saturating_add(outvoted.into());
                outcome
            }
            Err(Disagreed) => {
                self.lost = true;
                stopped(&self.last)
            }
        };
        self.last
    }
}

/// The outcome that commands no force.
fn stopped<const N: usize>(last: &Outcome<N>) -> Outcome<N> {
    Outcome { command: Command { u: [0.0; N], mode: Mode::Safe }, errors: 1, ..*last }
}

impl<M, C, const N: usize> Processor<N> for Voting<M, C, N>
where
    M: Mechanism<N> + Clone,
    C: Controller<N> + Clone + PartialEq,
{
    type Error = Infallible;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Infallible> {
        Ok(self.run_on(&[Input { elapsed, measured: *measured, target: *target }; 3]))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Infallible> {
        let input = (elapsed, *measured, u);
        Ok(self.tick(&[input; 3], |model, firmware, (elapsed, measured, u)| {
            firmware.replay(model, *elapsed, measured, *u)
        }))
    }

    fn last(&self) -> &Outcome<N> {
        &self.last
    }
}

/// A processor that compares a file in flash with its checksum, a slice at the beginning of every tick: [`Sweep`].
///
/// From the tick on in which the file is found damaged, it commands no force, in [`Mode::Safe`].
#[derive(Clone, Debug)]
pub struct Swept<'f, P, const N: usize> {
    processor: P,
    file: &'f [u8],
    /// Bytes of a tick.
    bytes: usize,
    sweep: Sweep,
    last: Outcome<N>,
    damage: Option<ModelError>,
}

impl<'f, P: Processor<N>, const N: usize> Swept<'f, P, N> {
    /// Creates a processor that sweeps over the file of its model, or of its plan, so that damage is found within `ticks` ticks: rounds take at most
    /// half as many.
    pub fn new(processor: P, file: &'f [u8], ticks: u32) -> Self {
        let bytes = Sweep::slice(file.len(), ticks as usize / 2);
        let last = *processor.last();
        Self { processor, file, bytes, sweep: Sweep::new(), last, damage: None }
    }

    /// The processor.
    pub const fn processor(&self) -> &P {
        &self.processor
    }

    /// The damage that was found in the file.
    pub const fn damage(&self) -> Option<ModelError> {
        self.damage
    }

    /// Sweeps, and runs a tick of the processor, unless the file is damaged.
    ///
    /// # Errors
    /// Errors of `run`.
    pub fn tick(
        &mut self,
        run: impl FnOnce(&mut P) -> Result<Outcome<N>, P::Error>,
    ) -> Result<Outcome<N>, P::Error> {
        if self.damage.is_none() {
            self.damage = self.sweep.advance(self.file, self.bytes).err();
        }
        self.last = if self.damage.is_some() { stopped(&self.last) } else { run(&mut self.processor)? };
        Ok(self.last)
    }
}

impl<P: Processor<N>, const N: usize> Processor<N> for Swept<'_, P, N> {
    type Error = P::Error;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, P::Error> {
        self.tick(|processor| processor.run(elapsed, measured, target))
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, P::Error> {
        self.tick(|processor| processor.replay(elapsed, measured, u))
    }

    fn last(&self) -> &Outcome<N> {
        &self.last
    }
}
