use crate::error::{SetupError, require};
use crate::observer::whole_and_rest;
use crate::wire::array;
use leastaction_core::forces::{self, Rise};
use leastaction_core::linear::add_scaled;
use leastaction_core::model::{ActuatorBytes, ModelError};
use serde::{Deserialize, Serialize};

pub use leastaction_core::observer::MAX_DELAY;

/// Conversion between the commands u and the forces τ = g u + o of all coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive<const N: usize> {
    /// Gain g, not 0: N or N m per unit of command.
    #[serde(with = "array")]
    pub gain: [f32; N],
    /// Offset o, N or N m.
    #[serde(with = "array")]
    pub offset: [f32; N],
}

impl<const N: usize> Drive<N> {
    /// Ideal drive: the command is the force.
    pub const fn ideal() -> Self {
        Self { gain: [1.0; N], offset: [0.0; N] }
    }

    /// Force τ = g u + o.
    pub fn force(&self, u: &[f32; N]) -> [f32; N] {
        self.late(0.0).output(u)
    }

    /// Command u = (τ − o)/g.
    pub fn command(&self, tau: &[f32; N]) -> [f32; N] {
        self.late(0.0).command(tau)
    }

    /// Actuator with a delay, as a fraction of a tick in \[0, 1\].
    pub(crate) fn late(&self, delay: f32) -> forces::Actuator<f32, N> {
        forces::Actuator { gain: self.gain, offset: self.offset, delay }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for gain in self.gain {
            require("actuator gain", gain, gain.is_finite() && gain != 0.0, "finite and not 0")?;
        }
        for offset in self.offset {
            require("actuator offset", offset, offset.is_finite(), "finite")?;
        }
        Ok(())
    }
}

/// The actuators of all coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActuatorConfig<const N: usize> {
    /// Largest command, ≥ 0; 0 if a coordinate is not actuated.
    #[serde(with = "array")]
    pub limit: [f32; N],
    /// Conversion between command and force.
    pub drive: Drive<N>,
    /// Delay from a command to its effect, in ticks, whole or not, at most [`MAX_DELAY`]. The part beyond whole ticks
    /// counts from the time when a tick is due; a command that comes later than the end of that part still acts at
    /// once.
    pub delay: f32,
    /// Time constant T of the lag behind the delay, T ẏ = u(t − d) − y, in ticks, at most [`MAX_DELAY`]; the force is that of the command y.
    pub lag: f32,
}

impl<const N: usize> ActuatorConfig<N> {
    /// Creates actuators with the given limits; forces are the commands, one tick late.
    pub const fn new(limit: [f32; N]) -> Self {
        Self { limit, drive: Drive::ideal(), delay: 1.0, lag: 0.0 }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        for limit in self.limit {
            require("actuator limit", limit, limit.is_finite() && limit >= 0.0, "finite and not negative")?;
        }
        self.drive.validate()?;
        require_ticks("actuator delay", self.delay)?;
        require_ticks("actuator lag", self.lag)
    }

    /// Clamps `u` to the limits.
    pub fn saturate(&self, u: &[f32; N]) -> [f32; N] {
        core::array::from_fn(|i| u[i].max(-self.limit[i]).min(self.limit[i]))
    }
}

/// Checks a time that a command is late by, in ticks.
pub(crate) fn require_ticks(what: &'static str, ticks: f32) -> Result<(), SetupError> {
    require(what, ticks, (0.0..=f32::from(MAX_DELAY)).contains(&ticks), "from 0 to 8 ticks")
}

/// Gain, offset, delay and lag of the drives in a model's file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedActuator<const N: usize> {
    /// Gain and offset.
    pub drive: Drive<N>,
    /// Delay, in ticks.
    pub delay: f32,
    /// Time constant of the lag, in ticks.
    pub lag: f32,
}

impl<const N: usize> LearnedActuator<N> {
    /// Reads them for ticks of h seconds.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for another number of coordinates; [`ModelError::OutOfRange`] for a delay of more than 65,535 ticks.
    pub fn new(file: &ActuatorBytes, h: f32) -> Result<Self, ModelError> {
        let forces::Actuator { gain, offset, .. } =
            if file.lag() > 0.0 { file.at_step_with_lag(h)?.1 } else { file.at_step(h)?.1 };
        Ok(Self { drive: Drive { gain, offset }, delay: file.delay() / h, lag: file.lag() / h })
    }
}

/// Delay line of commands: each comes out a number of ticks after it went in.
pub type DelayLine<const N: usize> = leastaction_core::observer::DelayLine<f32, N>;

/// Actuators with a delay line, saturation and a lag; without a lag they hold the force between ticks.
#[derive(Clone, Debug)]
pub struct Actuator<const N: usize> {
    config: ActuatorConfig<N>,
    line: DelayLine<N>,
    /// The command that has arrived, within the limits.
    arrived: [f32; N],
    /// The lagging command y.
    y: [f32; N],
}

impl<const N: usize> Actuator<N> {
    /// Creates actuators without a command.
    pub fn new(config: ActuatorConfig<N>) -> Self {
        let line = DelayLine::new(whole_and_rest(config.delay).0);
        Self { config, line, arrived: [0.0; N], y: [0.0; N] }
    }

    /// The force acting now, N or N m.
    pub fn force(&self) -> [f32; N] {
        self.config.drive.force(&self.y)
    }

    /// Lets a part of a tick pass, and returns the mean force over it.
    pub fn pass(&mut self, part: f32) -> [f32; N] {
        if self.config.lag <= 0.0 || part <= 0.0 {
            return self.force();
        }
        let [end, area, ..] = Rise::new(self.config.lag, part).integrals;
        let away: [f32; N] = core::array::from_fn(|i| self.arrived[i] - self.y[i]);
        let mean = add_scaled(&self.y, area / part, &away);
        self.y = add_scaled(&self.y, end, &away);
        self.config.drive.force(&mean)
    }

    /// Fraction of a tick after which a command that is due in the tick takes effect.
    pub fn rest(&self) -> f32 {
        whole_and_rest(self.config.delay).1
    }

    /// Begins a tick: takes a command, if there is one, and applies the command that is due; returns the force that acts from then on.
    pub fn advance(&mut self, command: Option<[f32; N]>) -> [f32; N] {
        self.arrived = self.config.saturate(&self.line.advance(command));
        if self.config.lag <= 0.0 {
            self.y = self.arrived;
        }
        self.force()
    }
}
