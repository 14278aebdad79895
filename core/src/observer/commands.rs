use crate::forces::{Actuator, Control};
use crate::scalar::Real;
use heapless::Deque;

/// Longest delay of a command, steps.
pub const MAX_DELAY: u8 = 8;

/// Commands on their way: what goes in comes out a whole number of steps later.
#[derive(Clone, Debug)]
pub struct DelayLine<R, const N: usize> {
    pending: Deque<[R; N], { MAX_DELAY as usize + 1 }>,
    last: [R; N],
}

impl<R: Real, const N: usize> DelayLine<R, N> {
    /// A line of the given delay in steps (at most [`MAX_DELAY`]), at rest.
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

    /// Takes this step's command, or the last one again where there is none, and gives the one of this step.
    pub fn advance(&mut self, command: Option<[R; N]>) -> [R; N] {
        self.last = command.unwrap_or(self.last);
        let kept = self.pending.push_back(self.last);
        debug_assert!(kept.is_ok(), "the one free place is filled here and freed on the next line");
        self.pending.pop_front().unwrap_or(self.last)
    }

    /// Takes all commands so far to have been this one.
    pub fn take_past(&mut self, command: [R; N]) {
        self.last = command;
        self.pending.iter_mut().for_each(|pending| *pending = command);
    }

    /// The commands of the coming steps that are already decided, soonest first: one for every step of delay.
    pub fn decided(&self) -> impl Iterator<Item = &[R; N]> {
        self.pending.iter()
    }
}

/// The actuators as the observer mirrors them: from commands to the force over each step, delayed by any part of a step.
///
/// A delay of d steps is ⌊d⌋ steps in a [`DelayLine`] and the rest in an [`Actuator`], whose force over a step has the impulse of the two
/// commands that act in it.
#[derive(Clone, Debug)]
pub struct Commands<R, const N: usize> {
    line: DelayLine<R, N>,
    actuator: Actuator<R, N>,
    /// The command that acted last.
    before: [R; N],
}

impl<R: Real, const N: usize> Commands<R, N> {
    /// Actuators at rest whose commands are late by `whole` steps (at most [`MAX_DELAY`]) and the delay of `actuator`.
    pub fn new(whole: u8, actuator: Actuator<R, N>) -> Self {
        Self { line: DelayLine::new(whole), actuator, before: [R::zero(); N] }
    }

    /// Takes all commands so far to have been this one: a log begins in the middle of a motion.
    pub fn take_past(&mut self, command: [R; N]) {
        self.line.take_past(command);
        self.before = command;
    }

    /// Begins a step: takes its command, or the last one again where there is none, and gives the force over it.
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

    /// The part of a step by which the next command is late after the decided ones, and the force meanwhile.
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
