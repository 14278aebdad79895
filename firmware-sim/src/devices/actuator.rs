use crate::error::{SetupError, require};
use crate::observer::whole_and_rest;
use crate::wire::array;
use serde::{Deserialize, Serialize};

pub use leastaction_core::observer::MAX_DELAY;

/// The actuators of all coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActuatorConfig<const N: usize> {
    /// Largest force, N or N m, ≥ 0; 0 where a coordinate is not actuated.
    #[serde(with = "array")]
    pub limit: [f32; N],
    /// Ticks from a command to its effect, or any part of one, at most [`MAX_DELAY`]. The rest beyond whole ticks counts from when a
    /// tick is due: a command that comes later still acts at once.
    pub delay: f32,
}

impl<const N: usize> ActuatorConfig<N> {
    /// Actuators of these limits, one tick late.
    pub const fn new(limit: [f32; N]) -> Self {
        Self { limit, delay: 1.0 }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for limit in self.limit {
            require("actuator limit", limit, limit.is_finite() && limit >= 0.0, "finite and not negative")?;
        }
        let sensible = (0.0..=f32::from(MAX_DELAY)).contains(&self.delay);
        require("actuator delay", self.delay, sensible, "from 0 to 8 ticks")
    }

    /// `u` within the limits.
    pub fn saturate(&self, u: &[f32; N]) -> [f32; N] {
        core::array::from_fn(|i| u[i].max(-self.limit[i]).min(self.limit[i]))
    }
}

/// Commands on their way: what goes in comes out so many ticks later.
pub type DelayLine<const N: usize> = leastaction_core::observer::DelayLine<f32, N>;

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
        Self { config, line: DelayLine::new(whole_and_rest(config.delay).0), force: [0.0; N] }
    }

    /// The force acting now, N or N m.
    pub fn force(&self) -> [f32; N] {
        self.force
    }

    /// The part of a tick after which a command that is due in it takes effect.
    pub fn rest(&self) -> f32 {
        whole_and_rest(self.config.delay).1
    }

    /// Begins a tick: takes a command, if there is one, and applies the one that is due.
    pub fn advance(&mut self, command: Option<[f32; N]>) -> [f32; N] {
        self.force = self.config.saturate(&self.line.advance(command));
        self.force
    }
}
