//! Conversion of commands to the force over a step.

use crate::discrete::StepError;
use crate::forces::{Actuator, Control, ControlKind};
use crate::model::{ModelError, Section, Sections};
use crate::scalar::all_finite;
use core::marker::PhantomData;

/// Kind of control, as a type: [`Held`] or [`Linear`].
pub trait Kind: Copy {
    /// The corresponding kind in a model file.
    const KIND: ControlKind;
    /// Number of earlier commands that a step needs if commands are not delayed.
    const PAST: usize;

    /// The force over a step; `ago(k)` is the command that was given k steps before this one.
    fn force<'u, A: Actuation<N>, const N: usize>(
        actuation: &A,
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> Control<f32, N>;
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
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> Control<f32, N> {
        actuation.held(ago(1), ago(0))
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
        ago: impl Fn(usize) -> &'u [f32; N],
    ) -> Control<f32, N> {
        actuation.linear(ago(2), ago(1), ago(0))
    }
}

/// Actuator between commands and forces, as a type: none ([`Direct`]), or the one of the file ([`Actuated`]).
pub trait Actuation<const N: usize>: Sized {
    /// Loads the actuator of a file for steps of h > 0 seconds.
    ///
    /// # Errors
    /// [`ModelError::Actuator`] if the file does not have the actuation that this type represents; the errors of
    /// [`Sections::actuator`] and of [`ActuatorBytes::at_step`](crate::model::ActuatorBytes::at_step).
    fn load(sections: &Sections, h: f32) -> Result<Self, ModelError>;

    /// Number of whole steps by which a command is late.
    fn whole(&self) -> usize;

    /// Whether a command is late by a further fraction of a step.
    fn has_rest(&self) -> bool;

    /// The force of a command as if it had no delay, N or N m.
    fn output(&self, u: &[f32; N]) -> [f32; N];

    /// [`Actuator::held`].
    fn held(&self, before: &[f32; N], u: &[f32; N]) -> Control<f32, N>;

    /// [`Actuator::linear`].
    fn linear(&self, before: &[f32; N], start: &[f32; N], end: &[f32; N]) -> Control<f32, N>;
}

/// No actuator: the command is the force, N or N m, at once.
#[derive(Clone, Copy, Debug)]
pub struct Direct;

impl<const N: usize> Actuation<N> for Direct {
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
    fn held(&self, _: &[f32; N], u: &[f32; N]) -> Control<f32, N> {
        Control::held(*u)
    }

    #[inline(always)]
    fn linear(&self, _: &[f32; N], start: &[f32; N], end: &[f32; N]) -> Control<f32, N> {
        Control { start: *start, end: *end }
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

    fn held(&self, before: &[f32; N], u: &[f32; N]) -> Control<f32, N> {
        self.actuator.held(before, u)
    }

    fn linear(&self, before: &[f32; N], start: &[f32; N], end: &[f32; N]) -> Control<f32, N> {
        self.actuator.linear(before, start, end)
    }
}

/// Converter of commands to forces: the kind of control `K`, the actuation `A`, and the last `PAST` commands in N coordinates.
///
/// A new drive is at rest: all earlier commands were 0. Held commands of an ideal drive take no memory and no time.
#[derive(Clone, Copy, Debug)]
pub struct Drive<K, A, const N: usize, const PAST: usize> {
    actuation: A,
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
        Ok(Self { actuation, past: [[0.0; N]; PAST], kind: PhantomData })
    }

    /// The force over the step of command `u`.
    #[inline(always)]
    pub fn force(&self, u: &[f32; N]) -> Control<f32, N> {
        let whole = self.actuation.whole();
        K::force(&self.actuation, |steps| self.ago(whole + steps, u))
    }

    /// The command `steps` steps ago; `u` is the present one. If the memory does not reach that far, any command may
    /// be returned, because its weight is 0.
    #[inline(always)]
    fn ago<'u>(&'u self, steps: usize, u: &'u [f32; N]) -> &'u [f32; N] {
        steps.checked_sub(1).and_then(|k| self.past.get(k)).unwrap_or(u)
    }

    /// Checks that the force of a command that would stay in memory is finite.
    #[inline(always)]
    pub(super) fn check(&self, u: &[f32; N]) -> Result<(), StepError<f32>> {
        if PAST == 0 || all_finite(&self.actuation.output(u)) { Ok(()) } else { Err(StepError::NotFinite) }
    }

    /// Advances by one step; `u` becomes the newest past command.
    #[inline(always)]
    pub(super) fn advance(&mut self, u: [f32; N]) {
        let mut newer = u;
        for command in &mut self.past {
            newer = core::mem::replace(command, newer);
        }
    }
}
