use crate::control::{Controller, Target};
use crate::firmware::{Firmware, Outcome};
use crate::processor::Processor;
use core::convert::Infallible;
use leastaction_core::adapt::{Adapter, Agreement, Blocks, Reading, Tunable};
use leastaction_core::linear::add_scaled;

/// A [`Firmware`] that runs in place, over a model whose numbers an [`Adapter`] keeps near the machine: observer and controller run over the
/// numbers in use, which never jump.
///
/// The adapter takes the encoders' readings, without the observer: [`Blocks`]. It takes nothing while the observer's estimate is not trusted, at
/// ticks before which the firmware did not run or at which a reading was missing, and while it is frozen; the numbers in use then stay.
#[derive(Clone, Debug)]
pub struct Adapting<S, C, const N: usize, const P: usize, const T: usize> {
    /// The model.
    pub model: S,
    /// Whether the numbers stay what they are.
    pub frozen: bool,
    firmware: Firmware<C, N>,
    blocks: Blocks<f32, N>,
    adapter: Adapter<f32, N, P, T>,
    agreement: Option<Agreement<f32>>,
}

impl<S: Tunable<N>, C, const N: usize, const P: usize, const T: usize> Adapting<S, C, N, P, T> {
    /// Creates a firmware, which was begun over the model, with an adapter that has seen nothing, whose ticks are `blocks`.
    pub const fn new(
        model: S,
        firmware: Firmware<C, N>,
        blocks: Blocks<f32, N>,
        adapter: Adapter<f32, N, P, T>,
    ) -> Self {
        Self { model, frozen: false, firmware, blocks, adapter, agreement: None }
    }

    /// The adapter.
    pub const fn adapter(&self) -> &Adapter<f32, N, P, T> {
        &self.adapter
    }

    /// The agreement of the window that ended with the last tick, if one did.
    pub const fn agreement(&self) -> Option<Agreement<f32>> {
        self.agreement
    }

    /// Begins anew with an adapter, such as one that has seen nothing, or one that begins at saved distances. The numbers in use become the
    /// adapter's at once.
    pub fn reset(&mut self, adapter: Adapter<f32, N, P, T>) {
        self.adapter = adapter;
        self.model.set(self.adapter.numbers(), self.adapter.applied());
    }

    /// Learns from a tick that has run; `before` is the force at the end of the step before it.
    fn learn(&mut self, elapsed: u32, measured: &[Option<f32>; N], before: &[f32; N]) {
        self.agreement = None;
        let reading = (elapsed == 1 && !self.frozen).then(|| self.reading(measured, before)).flatten();
        let Some(block) = self.blocks.take(reading.as_ref()) else { return };
        match block {
            _ if self.frozen => return self.adapter.hold(),
            Some(moment) => self.agreement = self.adapter.take(self.model.of_file(), &moment),
            None => self.adapter.skip(),
        }
        self.model.set(self.adapter.numbers(), self.adapter.applied());
    }

    /// Reading of a tick, if the estimate is trusted and no reading is missing.
    fn reading(&self, measured: &[Option<f32>; N], before: &[f32; N]) -> Option<Reading<f32, N>> {
        let q = self.firmware.read(measured)?;
        let force = add_scaled(before, 1.0, &self.firmware.force().start).map(|both| 0.5 * both);
        Some(Reading { q, command: self.firmware.drive().command(&force), force })
    }
}

impl<S, C, const N: usize, const P: usize, const T: usize> Processor<N> for Adapting<S, C, N, P, T>
where
    S: Tunable<N>,
    C: Controller<N>,
{
    type Error = Infallible;

    fn run(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Result<Outcome<N>, Infallible> {
        let before = self.firmware.force().end;
        let outcome = self.firmware.run(&self.model.in_use(), elapsed, measured, target);
        self.learn(elapsed, measured, &before);
        Ok(outcome)
    }

    fn replay(
        &mut self,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Result<Outcome<N>, Infallible> {
        let before = self.firmware.force().end;
        let outcome = self.firmware.replay(&self.model.in_use(), elapsed, measured, u);
        self.learn(elapsed, measured, &before);
        Ok(outcome)
    }

    fn last(&self) -> &Outcome<N> {
        self.firmware.last()
    }
}
