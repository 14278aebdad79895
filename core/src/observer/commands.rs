use crate::forces::{Actuator, Control};
use crate::scalar::Real;
use heapless::Deque;

/// Longest delay of a command, in steps.
pub const MAX_DELAY: u8 = 8;

/// Delay line of commands: what goes in comes out a whole number of steps later.
#[derive(Clone, Debug)]
pub struct DelayLine<R, const N: usize> {
    pending: Deque<[R; N], { MAX_DELAY as usize + 1 }>,
    last: [R; N],
}

impl<R: Real, const N: usize> DelayLine<R, N> {
    /// Creates a line at rest with the given delay in steps (at most [`MAX_DELAY`]).
    pub fn new(delay: u8) -> Self {
        let rest = [R::zero(); N];
        let mut pending = Deque::new();
        debug_assert!(delay <= MAX_DELAY, "configurations of a longer delay are refused");
        for _ in 0..delay.min(MAX_DELAY) {
            let kept = pending.push_back(rest);
            debug_assert!(kept.is_ok(), "the queue holds MAX_DELAY + 1");
        }
        Self { pending, last: rest }
    }

    /// Takes this step's command, or the last one again if there is none, and returns the command that acts in this step.
    pub fn advance(&mut self, command: Option<[R; N]>) -> [R; N] {
        self.last = command.unwrap_or(self.last);
        let kept = self.pending.push_back(self.last);
        debug_assert!(kept.is_ok(), "the one free place is filled here and freed on the next line");
        self.pending.pop_front().unwrap_or(self.last)
    }

    /// Assumes that all earlier commands were equal to this one.
    pub fn take_past(&mut self, command: [R; N]) {
        self.last = command;
        self.pending.iter_mut().for_each(|pending| *pending = command);
    }

    /// The commands of the coming steps that are already decided, soonest first: one per step of delay.
    pub fn decided(&self) -> impl Iterator<Item = &[R; N]> {
        self.pending.iter()
    }
}

/// The observer's copy of the actuators. It turns commands into the force over each step, with a delay that need not
/// be a whole number of steps.
///
/// A delay of d steps is ⌊d⌋ steps in a [`DelayLine`] and the remaining fraction in an [`Actuator`], whose force over a step has the
/// impulse of the two commands that act in it.
#[derive(Clone, Debug)]
pub struct Commands<R, const N: usize> {
    line: DelayLine<R, N>,
    actuator: Actuator<R, N>,
    /// The command that acted last.
    before: [R; N],
}

impl<R: Real, const N: usize> Commands<R, N> {
    /// Creates actuators at rest; commands are late by `whole` steps (at most [`MAX_DELAY`]) plus the delay of `actuator`.
    pub fn new(whole: u8, actuator: Actuator<R, N>) -> Self {
        Self { line: DelayLine::new(whole), actuator, before: [R::zero(); N] }
    }

    /// Assumes that all earlier commands were equal to this one, as when a log begins in the middle of a motion.
    pub fn take_past(&mut self, command: [R; N]) {
        self.line.take_past(command);
        self.before = command;
    }

    /// Begins a step: takes its command, or the last one again if there is none, and returns the force over the step.
    pub fn advance(&mut self, command: Option<[R; N]>) -> Control<R, N> {
        let now = self.line.advance(command);
        let before = core::mem::replace(&mut self.before, now);
        self.force(&before, &now)
    }

    /// The forces over the coming steps that are already decided, soonest first.
    pub fn decided(&self) -> impl Iterator<Item = Control<R, N>> {
        let mut before = self.before;
        self.line.decided().map(move |now| self.force(&core::mem::replace(&mut before, *now), now))
    }

    /// The fraction of a step that passes after the decided steps until the next command acts, and the force until
    /// then.
    pub fn rest(&self) -> (R, [R; N]) {
        let last = self.line.decided().last().unwrap_or(&self.before);
        (self.actuator.delay, self.actuator.output(last))
    }

    fn force(&self, before: &[R; N], now: &[R; N]) -> Control<R, N> {
        if self.actuator.delay > R::zero() {
            return self.actuator.held(before, now);
        }
        Control::held(self.actuator.output(now))
    }
}
