use crate::expected::{first, first_mut};
use crate::forces::{Actuator, Control, Lag};
use crate::scalar::Real;

/// Longest delay of a command, in steps.
pub const MAX_DELAY: u8 = 8;

/// Delay line of commands: what goes in comes out a whole number of steps later.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayLine<R, const N: usize> {
    /// Commands that are decided, soonest first: one per step of delay, then zeros.
    pending: [[R; N]; MAX_DELAY as usize],
    delay: u8,
    last: [R; N],
}

impl<R: Real, const N: usize> DelayLine<R, N> {
    /// Creates a line at rest with the given delay in steps (at most [`MAX_DELAY`]).
    pub fn new(delay: u8) -> Self {
        debug_assert!(delay <= MAX_DELAY, "configurations of a longer delay are refused");
        let rest = [R::zero(); N];
        Self { pending: [rest; MAX_DELAY as usize], delay: delay.min(MAX_DELAY), last: rest }
    }

    /// Takes this step's command, or the last one again if there is none, and returns the command that acts in this step.
    pub fn advance(&mut self, command: Option<[R; N]>) -> [R; N] {
        self.last = command.unwrap_or(self.last);
        let mut passed = self.last;
        for pending in first_mut(&mut self.pending, self.delay.into()).iter_mut().rev() {
            core::mem::swap(pending, &mut passed);
        }
        passed
    }

    /// Assumes that all earlier commands were equal to this one.
    pub fn take_past(&mut self, command: [R; N]) {
        self.last = command;
        first_mut(&mut self.pending, self.delay.into()).fill(command);
    }

    /// The commands of the coming steps that are already decided, soonest first: one per step of delay.
    pub fn decided(&self) -> impl Iterator<Item = &[R; N]> {
        first(&self.pending, self.delay.into()).iter()
    }
}

/// The observer's copy of the actuators. It turns commands into the force over each step, with a delay that need not
/// be a whole number of steps, and with a lag.
///
/// A delay of d steps is ⌊d⌋ steps in a [`DelayLine`] and the remaining fraction in an [`Actuator`], whose force over a step has the
/// impulse of the two commands that act in it. A lag, T ẏ = u(t − d) − y, is that of [`Lag`].
#[derive(Clone, Debug, PartialEq)]
pub struct Commands<R, const N: usize> {
    line: DelayLine<R, N>,
    actuator: Actuator<R, N>,
    /// The command that acted last.
    before: [R; N],
    slow: Option<Slow<R>>,
    /// Lagging command at the end of the last step.
    y: [R; N],
}

/// A lag of the drives.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slow<R> {
    /// Over a whole step.
    step: Lag<R>,
    /// Over the part of a step until the next command acts.
    rest: Lag<R>,
    /// Number and length, in steps, of the equal parts of the time constant, each at most a step long; and the lag over one of them.
    parts: (u8, R, Lag<R>),
}

impl<R: Real> Slow<R> {
    /// A lag of `lag` > 0 steps behind a delay of a fraction of a step.
    fn new(lag: R, delay: R) -> Self {
        let (mut count, mut most) = (1, R::one());
        while most < lag && count < u8::MAX {
            (count, most) = (count + 1, most + R::one());
        }
        let part = lag / most;
        // Times within a part are counted in its length.
        let over = |length: R| Lag::new(lag / length, R::zero());
        let rest = if delay > R::zero() { over(delay) } else { over(R::one()) };
        Self { step: Lag::new(lag, delay), rest, parts: (count, part, over(part)) }
    }
}

impl<R: Real, const N: usize> Commands<R, N> {
    /// Creates actuators at rest; commands are late by `whole` steps (at most [`MAX_DELAY`]) plus the delay of `actuator`.
    pub fn new(whole: u8, actuator: Actuator<R, N>) -> Self {
        let rest = [R::zero(); N];
        Self { line: DelayLine::new(whole), actuator, before: rest, slow: None, y: rest }
    }

    /// Lets the drives lag with a time constant of `lag` ≥ 0 steps.
    #[must_use]
    pub fn with_lag(self, lag: R) -> Self {
        Self { slow: (lag > R::zero()).then(|| Slow::new(lag, self.actuator.delay)), ..self }
    }

    /// Assumes that all earlier commands were equal to this one, as when a log begins in the middle of a motion.
    pub fn take_past(&mut self, command: [R; N]) {
        self.line.take_past(command);
        (self.before, self.y) = (command, command);
    }

    /// Begins a step: takes its command, or the last one again if there is none, and returns the force over the step.
    pub fn advance(&mut self, command: Option<[R; N]>) -> Control<R, N> {
        let now = self.line.advance(command);
        let before = core::mem::replace(&mut self.before, now);
        let (force, y) = self.force(&self.y, &before, &now);
        self.y = y;
        force
    }

    /// Passes the forces to come before the next command has its effect to `step`, each with the part of a step that it lasts: over the steps that are
    /// already decided, over the rest of the delay and, if the drives lag, over the time constant, by which they answer late.
    ///
    /// # Errors
    /// The first error of `step`.
    pub fn to_come<E>(&self, mut step: impl FnMut(R, &Control<R, N>) -> Result<(), E>) -> Result<(), E> {
        let (mut y, mut before) = (self.y, self.before);
        for now in self.line.decided() {
            let (force, end) = self.force(&y, &before, now);
            step(R::one(), &force)?;
            (y, before) = (end, *now);
        }
        let delay = self.actuator.delay;
        let Some(Slow { rest, parts: (count, part, lag), .. }) = &self.slow else {
            return if delay > R::zero() {
                step(delay, &Control::held(self.actuator.output(&before)))
            } else {
                Ok(())
            };
        };
        if delay > R::zero() {
            let force;
            (force, y) = self.waiting(rest, &y, &before);
            step(delay, &force)?;
        }
        for _ in 0..*count {
            let force;
            (force, y) = self.waiting(lag, &y, &before);
            step(*part, &force)?;
        }
        Ok(())
    }

    /// The force over a part of a step in which the lagging command goes towards `u`, and that command at its end.
    fn waiting(&self, lag: &Lag<R>, y: &[R; N], u: &[R; N]) -> (Control<R, N>, [R; N]) {
        self.actuator.lagging(|i| lag.held(y[i], u[i], u[i]))
    }

    fn force(&self, y: &[R; N], before: &[R; N], now: &[R; N]) -> (Control<R, N>, [R; N]) {
        match &self.slow {
            Some(slow) => self.actuator.lagging(|i| slow.step.held(y[i], before[i], now[i])),
            None if self.actuator.delay > R::zero() => (self.actuator.held(before, now), *y),
            None => (Control::held(self.actuator.output(now)), *y),
        }
    }
}
