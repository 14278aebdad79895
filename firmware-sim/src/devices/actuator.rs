use crate::error::{SetupError, require};
use crate::wire::array;
use heapless::Deque;
use serde::{Deserialize, Serialize};

/// Longest delay of a command, ticks.
pub const MAX_DELAY: u8 = 8;

/// The actuators of all coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActuatorConfig<const N: usize> {
    /// Largest force, N or N m, ≥ 0; 0 where a coordinate is not actuated.
    #[serde(with = "array")]
    pub limit: [f32; N],
    /// Ticks from a command to its effect, at most [`MAX_DELAY`].
    pub delay: u8,
}

impl<const N: usize> ActuatorConfig<N> {
    /// Actuators of these limits, one tick late.
    pub const fn new(limit: [f32; N]) -> Self {
        Self { limit, delay: 1 }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for limit in self.limit {
            require("actuator limit", limit, limit.is_finite() && limit >= 0.0, "finite and not negative")?;
        }
        require("actuator delay", f32::from(self.delay), self.delay <= MAX_DELAY, "at most 8 ticks")
    }

    /// `u` within the limits.
    pub fn saturate(&self, u: &[f32; N]) -> [f32; N] {
        core::array::from_fn(|i| u[i].max(-self.limit[i]).min(self.limit[i]))
    }
}

/// Commands on their way: what goes in comes out `delay` ticks later. The actuator has one, and the observer mirrors it.
#[derive(Clone, Debug)]
pub struct DelayLine<const N: usize> {
    pending: Deque<[f32; N], { MAX_DELAY as usize + 1 }>,
    last: [f32; N],
}

impl<const N: usize> DelayLine<N> {
    /// A line of the given delay in ticks (at most [`MAX_DELAY`]), at rest.
    pub fn new(delay: u8) -> Self {
        let rest = [0.0; N];
        let mut pending = Deque::new();
        debug_assert!(delay <= MAX_DELAY, "configurations of a longer delay are refused");
        for _ in 0..delay.min(MAX_DELAY) {
            let kept = pending.push_back(rest);
            debug_assert!(kept.is_ok(), "the queue holds MAX_DELAY + 1");
        }
        Self { pending, last: rest }
    }

    /// Takes this tick's command, or the last one again where there is none, and gives the force of this tick.
    pub fn advance(&mut self, command: Option<[f32; N]>) -> [f32; N] {
        self.last = command.unwrap_or(self.last);
        let kept = self.pending.push_back(self.last);
        debug_assert!(kept.is_ok(), "the one free place is filled here and freed on the next line");
        self.pending.pop_front().unwrap_or(self.last)
    }

    /// The forces of the coming ticks that are already decided, soonest first: one for every tick of delay.
    pub fn decided(&self) -> impl Iterator<Item = &[f32; N]> {
        self.pending.iter()
    }
}

/// Actuators with a delay line and saturation; between ticks they hold the force.
#[derive(Clone, Debug)]
pub struct Actuator<const N: usize> {
    config: ActuatorConfig<N>,
    line: DelayLine<N>,
    force: [f32; N],
}

impl<const N: usize> Actuator<N> {
    /// Actuators at rest.
    pub fn new(config: ActuatorConfig<N>) -> Self {
        Self { config, line: DelayLine::new(config.delay), force: [0.0; N] }
    }

    /// The force acting now, N or N m.
    pub fn force(&self) -> [f32; N] {
        self.force
    }

    /// Begins a tick: takes a command, if there is one, and applies the one that is due.
    pub fn advance(&mut self, command: Option<[f32; N]>) -> [f32; N] {
        self.force = self.config.saturate(&self.line.advance(command));
        self.force
    }
}
