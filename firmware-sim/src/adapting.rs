use crate::control::{Controller, Target};
use crate::firmware::{Firmware, Outcome};
use crate::mechanism::InUse;
use crate::processor::Processor;
use core::convert::Infallible;
use leastaction_core::adapt::{Adapter, Agreement, Blocks, Patch, Reading, Tunable, Tuning, Unfit};
use leastaction_core::linear::add_scaled;

/// A [`Firmware`] that runs in place, over a model whose numbers an [`Adapter`] keeps near the machine: observer and controller run over the
/// numbers in use, which never jump.
///
/// The adapter takes the encoders' readings, without the observer: [`Blocks`]. It takes nothing while the observer's estimate is not trusted, at
/// ticks before which the firmware did not run or at which a reading was missing, and while it is frozen; the numbers in use then stay.
#[derive(Clone, Debug)]
pub struct Adapting<'t, S, C, const N: usize, const P: usize, const T: usize> {
    /// The model.
    pub model: S,
    /// Whether the numbers stay what they are.
    pub frozen: bool,
    firmware: Firmware<C, N>,
    blocks: Blocks<f32, N>,
    tuning: &'t Tuning<f32, N, P>,
    adapter: Adapter<f32, N, P, T>,
    agreement: Option<Agreement<f32>>,
}

impl<'t, S: Tunable<N>, C, const N: usize, const P: usize, const T: usize> Adapting<'t, S, C, N, P, T> {
    /// Creates a firmware, which was begun over the model, with an adapter that has seen nothing, whose ticks are `blocks`.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(
        model: S,
        firmware: Firmware<C, N>,
        (blocks, tuning): (Blocks<f32, N>, &'t Tuning<f32, N, P>),
    ) -> Result<Self, Unfit> {
        let adapter = Adapter::new(tuning)?;
        Ok(Self { model, frozen: false, firmware, blocks, tuning, adapter, agreement: None })
    }

    /// The adapter.
    pub const fn adapter(&self) -> &Adapter<f32, N, P, T> {
        &self.adapter
    }

    /// The agreement of the window that ended with the last tick, if one did.
    pub const fn agreement(&self) -> Option<Agreement<f32>> {
        self.agreement
    }

    /// The distances in use, to be saved for the model with this [fingerprint](leastaction_core::model::fingerprint).
    pub fn patch(&self, model: u32) -> Patch<P> {
        self.adapter.patch(self.tuning, model)
    }

    /// Begins anew with an adapter that has seen nothing and begins at the distances of a patch, if there is one, within the limits. The numbers in
    /// use become the adapter's at once.
    ///
    /// # Errors
    /// [`Unfit`], as for [`new`](Self::new), which then had refused the tuning.
    pub fn reset(&mut self, patch: Option<&Patch<P>>) -> Result<(), Unfit> {
        self.adapter = Adapter::new(self.tuning)?;
        patch.into_iter().for_each(|patch| self.adapter.begin_with(self.tuning, patch));
        self.model.set(&self.tuning.numbers, self.adapter.applied());
        Ok(())
    }

    /// Learns from a tick that has run; `before` is the force at the end of the step before it.
    #[inline(never)]
    fn learn(&mut self, elapsed: u32, measured: &[Option<f32>; N], before: &[f32; N]) {
        let reading = (elapsed == 1 && !self.frozen).then(|| self.reading(measured, before)).flatten();
        let Self { model, frozen, firmware, blocks, tuning, adapter, .. } = self;
        let command = |force: &[f32; N]| firmware.drive().command(force);
        self.agreement = adapter.follow(tuning, model, blocks, reading.as_ref(), *frozen, command);
    }

    /// Reading of a tick, if the estimate is trusted and no reading is missing.
    fn reading(&self, measured: &[Option<f32>; N], before: &[f32; N]) -> Option<Reading<f32, N>> {
        let q = self.firmware.read(measured)?;
        let force = add_scaled(before, 1.0, &self.firmware.force().start).map(|both| 0.5 * both);
        Some(Reading { q, force })
    }
}

impl<S, C, const N: usize, const P: usize, const T: usize> Processor<N> for Adapting<'_, S, C, N, P, T>
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
        let outcome = {
            let model = InUse { used: self.model.in_use(), of_file: self.model.of_file() };
            self.firmware.run(&model, elapsed, measured, target)
        };
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
