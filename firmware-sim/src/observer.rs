//! How the firmware's [`Observer`] is set up.

pub use leastaction_core::discrete::Order;
pub use leastaction_core::observer::{Integrator, Observer, Tuning, ZerosPrior};

use crate::Mechanism;
use crate::devices::{Drive, MAX_DELAY};
use crate::error::{Range, SetupError, require};
use crate::wire::{NewtonWire, OrderWire};
use leastaction_core::discrete::Newton;
use leastaction_core::model::TrainedStep;
use leastaction_core::observer::Commands;
use serde::{Deserialize, Serialize};

/// How the observer steps the model and how much it believes it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObserverConfig {
    /// Order of the discrete Euler–Lagrange step; a model learned through steps names its own.
    #[serde(with = "OrderWire")]
    pub order: Order,
    /// What becomes of an order or a tick that the model was not trained for.
    pub other_step: OtherStep,
    /// Bounds of Newton's method.
    #[serde(with = "NewtonWire")]
    pub newton: Newton<f32>,
    /// Most samples in memory, at least 1: more smooth the noise more and follow a wrong model longer.
    pub memory: u8,
    /// Ticks from a command to its effect, or any part of one, as far as the firmware knows; at most [`MAX_DELAY`].
    pub delay: f32,
    /// Samples of one encoder missing in a row, or ticks slept through, after which the estimate is not trusted any more.
    pub patience: u8,
    /// Which zeros of the encoders it learns; none where there is nothing.
    pub zeros: Option<LearnZeros>,
}

/// Zeros of encoders that are learned from their innovations, all of them alike; see [`leastaction_core::observer`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnZeros {
    /// How far off they may be, standard deviation, rad or m, > 0.
    pub deviation: f32,
    /// Standard deviation of an innovation, rad or m, > 0: larger learns more slowly.
    pub innovation: f32,
}

/// The observer of a mechanism's model.
pub type ObserverOf<'a, M, const N: usize> =
    Observer<'a, f32, <M as Mechanism<N>>::Lagrangian, <M as Mechanism<N>>::Forces, N>;

/// What becomes of an order or a tick that a model was not trained for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OtherStep {
    /// It is an error: the model is less accurate with it.
    #[default]
    Refused,
    /// It is what the caller asked for, who should say so aloud where [`ObserverConfig::require_step`] would refuse it.
    Accepted,
}

/// Newton's default bounds in f32, [`Newton::default`], but at most 8 updates, which bounds a tick; the largest accepted
/// residual is √ε = 2^−11.5.
const NEWTON: Newton<f32> = Newton { max_iterations: 8, stop: 2.0 * f32::EPSILON, accept: 3.452_669_8e-4 };

impl Default for ObserverConfig {
    /// [`ObserverConfig::new`].
    fn default() -> Self {
        Self::new()
    }
}

/// Relative difference of two steps that are the same but for rounding.
const SAME_STEP: f32 = 1e-6;

impl ObserverConfig {
    /// Order 2, of no other step than the model's, at most 8 updates of Newton's method a step, a memory of 5 samples, one tick of delay, a patience
    /// of 25 samples, all zeros known.
    pub const fn new() -> Self {
        Self {
            order: Order::Two,
            other_step: OtherStep::Refused,
            newton: NEWTON,
            memory: 5,
            delay: 1.0,
            patience: 25,
            zeros: None,
        }
    }

    /// Whether steps of this order and of `tick` seconds are those that a model was trained for; every step is where a model
    /// names none.
    ///
    /// # Errors
    /// The tick or the order that differs, with the model's own.
    pub fn require_step(&self, tick: f32, trained: Option<TrainedStep>) -> Result<(), SetupError> {
        let Some(TrainedStep { order, h, .. }) = trained else { return Ok(()) };
        let other = |what, value, own| {
            let range = Range::Only(own, "which the model was trained for");
            SetupError::OutOfRange { what, value, range }
        };
        if (tick - h).abs() > SAME_STEP * h {
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
        let sensible = (0.0..=f32::from(MAX_DELAY)).contains(&self.delay);
        require("observer delay", self.delay, sensible, "from 0 to 8 ticks")?;
        let LearnZeros { deviation, innovation } =
            self.zeros.unwrap_or(LearnZeros { deviation: 1.0, innovation: 1.0 });
        for (what, x) in [("deviation of the zeros", deviation), ("deviation of an innovation", innovation)] {
            require(what, x, x.is_finite() && x > 0.0, "finite and positive")?;
        }
        Ok(())
    }

    /// The observer of a model by ticks of h seconds; `angle` says which encoders forget whole turns.
    pub fn observer<'a, M: Mechanism<N>, const N: usize>(
        &self,
        model: &'a M,
        h: f32,
        angle: [bool; N],
    ) -> ObserverOf<'a, M, N> {
        let zeros =
            self.zeros.map(|LearnZeros { deviation, innovation }| ZerosPrior { deviation, innovation });
        let tuning = Tuning { memory: self.memory, patience: self.patience, zeros };
        Observer::new(model.system(), Integrator::new(self.order, h, self.newton), angle, tuning)
    }

    /// The commands on their way, by the drive and the delay that the firmware knows.
    pub(crate) fn commands<const N: usize>(&self, drive: &Drive<N>) -> Commands<f32, N> {
        let (whole, rest) = whole_and_rest(self.delay);
        Commands::new(whole, drive.late(rest))
    }
}

/// The whole ticks of a delay, which is not negative, and the rest of it.
pub(crate) fn whole_and_rest(delay: f32) -> (u8, f32) {
    let whole = delay as u8;
    (whole, delay - f32::from(whole))
}
