//! Conversion of commands to the force over a step.

use crate::discrete::StepError;
use crate::forces::{Actuator, Control, ControlKind, Lag};
use crate::model::{ModelError, Section, Sections};
use crate::scalar::all_finite;
use core::marker::PhantomData;

/// Kind of control, as a type: [`Held`] or [`Linear`].
pub trait Kind: Copy {
    /// The corresponding kind in a model file.
    const KIND: ControlKind;
    /// Number of earlier commands that a step needs if commands are not delayed.
    const PAST: usize;

    /// The force over a step that begins with the lagging command `y`, and that command at its end; `ago(k)` is the command that was given
    /// k steps before this one.
    fn force<'u, A: Actuation<N>, const N: usize>(
        actuation: &A,
        y: &A::Lagging,
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> (Control<f32, N>, A::Lagging);
}

/// Held control: a step's command acts from the start of the step to its end.
#[derive(Clone, Copy, Debug)]
pub struct Held;

impl Kind for Held {
    const KIND: ControlKind = ControlKind::Held;
    const PAST: usize = 0;

    #[inline(always)]
    fn force<'u, A: Actuation<N>, const N: usize>(
        actuation: &A,
        y: &A::Lagging,
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> (Control<f32, N>, A::Lagging) {
        actuation.held(y, ago(1), ago(0))
    }
}

/// Linear control: a step's command is the sample at its end, reached linearly from the previous step's command.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl Kind for Linear {
    const KIND: ControlKind = ControlKind::Linear;
    const PAST: usize = 1;

    #[inline(always)]
    fn force<'u, A: Actuation<N>, const N: usize>(
        actuation: &A,
        y: &A::Lagging,
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> (Control<f32, N>, A::Lagging) {
        actuation.linear(y, [ago(2), ago(1), ago(0)])
    }
}

/// Lagging command y that a drive keeps between steps: none, or one number for every coordinate.
pub trait Kept: Copy {
    /// y of a drive at rest, whose earlier commands were all 0.
    const REST: Self;

    /// Whether all numbers are finite.
    fn is_finite(&self) -> bool;
}

impl Kept for () {
    const REST: Self = ();

    #[inline(always)]
    fn is_finite(&self) -> bool {
        true
    }
}

impl<const N: usize> Kept for [f32; N] {
    const REST: Self = [0.0; N];

    fn is_finite(&self) -> bool {
        all_finite(self)
    }
}

/// Actuator between commands and forces, as a type: none ([`Direct`]), or the one of the file ([`Actuated`], [`Lagged`]).
pub trait Actuation<const N: usize>: Sized {
    /// Lagging command between steps.
    type Lagging: Kept;

    /// Loads the actuator of a file for steps of h > 0 seconds.
    ///
    /// # Errors
    /// [`ModelError::Actuator`] and [`ModelError::Lag`] if the file does not have the actuation that this type represents; the errors of
    /// [`Sections::actuator`] and of [`ActuatorBytes::at_step`](crate::model::ActuatorBytes::at_step).
    fn load(sections: &Sections, h: f32) -> Result<Self, ModelError>;

    /// Number of whole steps by which a command is late.
    fn whole(&self) -> usize;

    /// Whether a command is late by a further fraction of a step.
    fn has_rest(&self) -> bool;

    /// The force of a command as if it had no delay, N or N m.
    fn output(&self, u: &[f32; N]) -> [f32; N];

    /// [`Actuator::held`] or [`Lag::held`], from the lagging command y on; also y at the end of the step.
    fn held(&self, y: &Self::Lagging, before: &[f32; N], u: &[f32; N]) -> (Control<f32, N>, Self::Lagging);

    /// [`Actuator::linear`] or [`Lag::linear`] for the commands before, at the start and at the end of the step, from the lagging
    /// command y on; also y at the end of the step.
    fn linear(&self, y: &Self::Lagging, commands: [&[f32; N]; 3]) -> (Control<f32, N>, Self::Lagging);
}

/// No actuator: the command is the force, N or N m, at once.
#[derive(Clone, Copy, Debug)]
pub struct Direct;

impl<const N: usize> Actuation<N> for Direct {
    type Lagging = ();

    fn load(sections: &Sections, _: f32) -> Result<Self, ModelError> {
        let found = sections.get(Section::Actuator).is_some();
        if found { Err(ModelError::Actuator { found }) } else { Ok(Self) }
    }

    #[inline(always)]
    fn whole(&self) -> usize {
        0
    }

    #[inline(always)]
    fn has_rest(&self) -> bool {
        false
    }

    #[inline(always)]
    fn output(&self, u: &[f32; N]) -> [f32; N] {
        *u
    }

    #[inline(always)]
    fn held(&self, (): &(), _: &[f32; N], u: &[f32; N]) -> (Control<f32, N>, ()) {
        (Control::held(*u), ())
    }

    #[inline(always)]
    fn linear(&self, (): &(), [_, start, end]: [&[f32; N]; 3]) -> (Control<f32, N>, ()) {
        (Control { start: *start, end: *end }, ())
    }
}

/// An actuator with gain, offset and delay, τ(t) = g u(t − d) + o; d is `whole` steps plus the fraction of a step in `actuator`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuated<const N: usize> {
    /// Number of whole steps by which a command is late.
    pub whole: u16,
    /// Gain, offset and the remaining delay, a fraction of a step.
    pub actuator: Actuator<f32, N>,
}

impl<const N: usize> Actuation<N> for Actuated<N> {
    type Lagging = ();

    fn load(sections: &Sections, h: f32) -> Result<Self, ModelError> {
        let actuator = sections.actuator()?.ok_or(ModelError::Actuator { found: false })?;
        let (whole, actuator) = actuator.at_step(h)?;
        Ok(Self { whole, actuator })
    }

    #[inline(always)]
    fn whole(&self) -> usize {
        self.whole.into()
    }

    #[inline(always)]
    fn has_rest(&self) -> bool {
        self.actuator.delay > 0.0
    }

    fn output(&self, u: &[f32; N]) -> [f32; N] {
        self.actuator.output(u)
    }

    #[inline(always)]
    fn held(&self, (): &(), before: &[f32; N], u: &[f32; N]) -> (Control<f32, N>, ()) {
        (self.actuator.held(before, u), ())
    }

    #[inline(always)]
    fn linear(&self, (): &(), [before, start, end]: [&[f32; N]; 3]) -> (Control<f32, N>, ()) {
        (self.actuator.linear(before, start, end), ())
    }
}

/// An actuator with gain, offset, delay and lag, T ẏ = u(t − d) − y and τ = g y + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lagged<const N: usize> {
    /// Gain, offset and delay.
    pub actuated: Actuated<N>,
    /// Lag behind the remaining delay of `actuated`.
    pub lag: Lag<f32>,
}

impl<const N: usize> Actuation<N> for Lagged<N> {
    type Lagging = [f32; N];

    fn load(sections: &Sections, h: f32) -> Result<Self, ModelError> {
        let actuator = sections.actuator()?.ok_or(ModelError::Actuator { found: false })?;
        let (whole, actuator, lag) = actuator.at_step_with_lag(h)?;
        Ok(Self { actuated: Actuated { whole, actuator }, lag })
    }

    #[inline(always)]
    fn whole(&self) -> usize {
        self.actuated.whole.into()
    }

    #[inline(always)]
    fn has_rest(&self) -> bool {
        self.lag.delay > 0.0
    }

    fn output(&self, u: &[f32; N]) -> [f32; N] {
        self.actuated.actuator.output(u)
    }

    fn held(&self, y: &[f32; N], before: &[f32; N], u: &[f32; N]) -> (Control<f32, N>, [f32; N]) {
        self.actuated.actuator.lagging(|i| self.lag.held(y[i], before[i], u[i]))
    }

    fn linear(&self, y: &[f32; N], commands: [&[f32; N]; 3]) -> (Control<f32, N>, [f32; N]) {
        self.actuated.actuator.lagging(|i| self.lag.linear(y[i], commands.map(|u| u[i])))
    }
}

/// Converter of commands to forces: the kind of control `K`, the actuation `A`, and the last `PAST` commands in N coordinates.
///
/// A new drive is at rest: all earlier commands were 0, and so is the lagging command y of a drive with a lag. Held
/// commands of an ideal drive take no memory and no time.
#[derive(Clone, Copy, Debug)]
pub struct Drive<K, A: Actuation<N>, const N: usize, const PAST: usize> {
    actuation: A,
    /// Lagging command at the end of the last step.
    y: A::Lagging,
    /// Past commands, newest first.
    past: [[f32; N]; PAST],
    kind: PhantomData<K>,
}

impl<K: Kind, A: Actuation<N>, const N: usize, const PAST: usize> Drive<K, A, N, PAST> {
    /// Creates a drive at rest.
    ///
    /// # Errors
    /// [`ModelError::Shape`] if the kind of control and the delay need more than `PAST` commands.
    pub fn new(actuation: A) -> Result<Self, ModelError> {
        let found = K::PAST + actuation.whole() + usize::from(actuation.has_rest());
        if found > PAST {
            return Err(ModelError::Shape { what: "past commands of the actuator", found, compiled: PAST });
        }
        Ok(Self { actuation, y: Kept::REST, past: [[0.0; N]; PAST], kind: PhantomData })
    }

    /// The force over the step of command `u`.
    #[inline(always)]
    pub fn force(&self, u: &[f32; N]) -> Control<f32, N> {
        self.acting(u).0
    }

    /// The force over the step of command `u`, and the lagging command at its end.
    #[inline(always)]
    fn acting(&self, u: &[f32; N]) -> (Control<f32, N>, A::Lagging) {
        let whole = self.actuation.whole();
        K::force(&self.actuation, &self.y, |steps| self.ago(whole + steps, u))
    }

    /// The command `steps` steps ago; `u` is the present one. If the memory does not reach that far, any command may
    /// be returned, because its weight is 0.
    #[inline(always)]
    fn ago<'u>(&'u self, steps: usize, u: &'u [f32; N]) -> &'u [f32; N] {
        steps.checked_sub(1).and_then(|k| self.past.get(k)).unwrap_or(u)
    }

    /// The force over the step of command `u`, and the drive after it, whose newest past command is `u`; both are refused if a number that
    /// would stay in memory is not finite.
    #[inline(always)]
    pub(super) fn advanced(&self, u: &[f32; N]) -> Result<Advanced<A::Lagging, N>, StepError<f32>> {
        let (force, y) = self.acting(u);
        let finite = y.is_finite() && (PAST == 0 || all_finite(&self.actuation.output(u)));
        if finite { Ok((force, After(y))) } else { Err(StepError::NotFinite) }
    }

    /// Advances by one step; `u` becomes the newest past command.
    #[inline(always)]
    pub(super) fn advance(&mut self, u: [f32; N], After(y): After<A::Lagging>) {
        self.y = y;
        let mut newer = u;
        for command in &mut self.past {
            newer = core::mem::replace(command, newer);
        }
    }
}

/// The force over a step, and what the drive keeps after it.
pub(super) type Advanced<Y, const N: usize> = (Control<f32, N>, After<Y>);

/// Lagging command at the end of a step that a drive may take.
#[derive(Clone, Copy)]
pub(super) struct After<Y>(Y);
