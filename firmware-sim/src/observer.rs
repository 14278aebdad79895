//! Configuration of the firmware's [`Observer`].

pub use leastaction_core::discrete::Order;
pub use leastaction_core::observer::{Integrator, Observer, Tuning, ZerosPrior};

use crate::devices::{Drive, require_ticks};
use crate::error::{Range, SetupError, require};
use crate::wire::{NewtonWire, OrderWire};
use leastaction_core::discrete::Newton;
use leastaction_core::model::TrainedStep;
use leastaction_core::observer::Commands;
use serde::{Deserialize, Serialize};

/// Configuration of the observer: how it steps the model, and how far it trusts it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObserverConfig {
    /// Order of the discrete Euler–Lagrange step; a model learned through steps names its own.
    #[serde(with = "OrderWire")]
    pub order: Order,
    /// Treatment of an order or a tick that the model was not trained for.
    pub other_step: OtherStep,
    /// Bounds of Newton's method.
    #[serde(with = "NewtonWire")]
    pub newton: Newton<f32>,
    /// Maximum number of samples in memory, at least 1: a longer memory smooths the noise more and follows a wrong model longer.
    pub memory: u8,
    /// Delay from a command to its effect that the firmware assumes, in ticks, whole or not; at most [`MAX_DELAY`](crate::devices::MAX_DELAY).
    pub delay: f32,
    /// Time constant of the drives' lag behind the delay that the firmware assumes, in ticks, at most [`MAX_DELAY`](crate::devices::MAX_DELAY).
    pub lag: f32,
    /// Number of samples of one encoder missing in a row, or of ticks slept through, after which the estimate is no longer trusted.
    pub patience: u8,
    /// Learning of the encoders' zeros; `None` if no zeros are learned.
    pub zeros: Option<LearnZeros>,
}

/// Learning of the encoders' zeros from their innovations, with equal settings for all encoders; see [`leastaction_core::observer`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnZeros {
    /// Standard deviation of the zeros, rad or m, > 0.
    pub deviation: f32,
    /// Standard deviation of an innovation, rad or m, > 0; with a larger one, the zeros are learned more slowly.
    pub innovation: f32,
}

/// Treatment of an order or a tick that a model was not trained for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OtherStep {
    /// Refuse it with an error: the model is less accurate with it.
    #[default]
    Refused,
    /// Accept it. The caller should report it if [`ObserverConfig::require_step`] would refuse it.
    Accepted,
}

/// Newton's default bounds in f32, [`Newton::default`], but with at most 8 updates, which bounds the time of a tick; the largest accepted
/// residual is √ε = 2^−11.5.
const NEWTON: Newton<f32> = Newton { max_iterations: 8, stop: 2.0 * f32::EPSILON, accept: 3.452_669_8e-4 };

impl Default for ObserverConfig {
    /// Returns [`ObserverConfig::new`].
    fn default() -> Self {
        Self::new()
    }
}

/// Relative difference up to which two steps count as equal, for rounding.
const SAME_STEP: f32 = 1e-6;

/// Whether two steps are equal, except for rounding.
pub(crate) fn same_step(h: f32, expected: f32) -> bool {
    (h - expected).abs() <= SAME_STEP * expected
}

impl ObserverConfig {
    /// Creates the defaults: order 2, no step other than the model's, at most 8 updates of Newton's method per step, a memory of 5 samples,
    /// one tick of delay, a patience of 25 samples, all zeros known.
    pub const fn new() -> Self {
        Self {
            order: Order::Two,
            other_step: OtherStep::Refused,
            newton: NEWTON,
            memory: 5,
            delay: 1.0,
            lag: 0.0,
            patience: 25,
            zeros: None,
        }
    }

    /// Checks that the order and steps of `tick` seconds are those of training; a model that names no step accepts any.
    ///
    /// # Errors
    /// The tick or the order that differs, with the model's own.
    pub fn require_step(&self, tick: f32, trained: Option<TrainedStep>) -> Result<(), SetupError> {
        let Some(TrainedStep { order, h, .. }) = trained else { return Ok(()) };
        let other = |what, value, own| {
            let range = Range::Only(own, "which the model was trained for");
            SetupError::OutOfRange { what, value, range }
        };
        if !same_step(tick, h) {
            return Err(other("tick", tick, h));
        }
        if self.order != order {
            return Err(other("order of the step", self.order.number().into(), order.number().into()));
        }
        Ok(())
    }

    /// [`ObserverConfig::require_step`], unless other steps are accepted.
    pub(crate) fn check_step(&self, tick: f32, trained: Option<TrainedStep>) -> Result<(), SetupError> {
        match self.other_step {
            OtherStep::Refused => self.require_step(tick, trained),
            OtherStep::Accepted => Ok(()),
        }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("observer memory", f32::from(self.memory), self.memory >= 1, "at least 1 sample")?;
        require_ticks("observer delay", self.delay)?;
        require_ticks("observer lag", self.lag)?;
        let LearnZeros { deviation, innovation } =
            self.zeros.unwrap_or(LearnZeros { deviation: 1.0, innovation: 1.0 });
        for (what, x) in [("deviation of the zeros", deviation), ("deviation of an innovation", innovation)] {
            require(what, x, x.is_finite() && x > 0.0, "finite and positive")?;
        }
        Ok(())
    }

    /// Creates the integrator that steps the model, for ticks of h seconds.
    pub const fn integrator(&self, h: f32) -> Integrator<f32> {
        Integrator::new(self.order, h, self.newton)
    }

    /// Creates the observer for ticks of h seconds; `angle` marks the encoders that forget whole turns.
    pub fn observer<const N: usize>(&self, h: f32, angle: [bool; N]) -> Observer<f32, N> {
        Observer::new(self.integrator(h), angle, self.tuning())
    }

    fn tuning(&self) -> Tuning<f32> {
        let zeros =
            self.zeros.map(|LearnZeros { deviation, innovation }| ZerosPrior { deviation, innovation });
        Tuning { memory: self.memory, patience: self.patience, zeros }
    }

    /// Settling time of the estimate, in ticks: [`Tuning::settling`].
    pub fn settling(&self) -> u32 {
        self.tuning().settling()
    }

    /// Creates the line of delayed commands from the drive and the delay that the firmware knows.
    pub(crate) fn commands<const N: usize>(&self, drive: &Drive<N>) -> Commands<f32, N> {
        let (whole, rest) = whole_and_rest(self.delay);
        Commands::new(whole, drive.late(rest)).with_lag(self.lag)
    }

    /// Ticks by which a command is late: its delay, and the time constant of the lag behind it.
    pub fn lateness(&self) -> f32 {
        self.delay + self.lag
    }
}

/// Splits a non-negative delay into whole ticks and the rest.
pub(crate) fn whole_and_rest(delay: f32) -> (u8, f32) {
    let whole = delay as u8;
    (whole, delay - f32::from(whole))
}
