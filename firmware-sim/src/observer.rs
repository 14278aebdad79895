//! Positions and velocities from encoder readings alone, by way of the model.
//!
//! Between samples the estimate moves by the model's discrete Euler–Lagrange step. A sample y corrects it by its
//! innovation e = y − q̂ (the short way round, for an angle): q̂ ← q̂ + αe, v̂ ← v̂ + βe/h. The gains are those of the
//! growing-memory filter over n samples, α = 2(2n + 1)/((n + 1)(n + 2)) and β = 6/((n + 1)(n + 2)), which is the
//! least-squares fit to the samples so far; n stops growing at the configured memory. When as many samples in a row are
//! missing, n shrinks by one with every further one, so that after a long gap the encoder is believed more than the model.
//! No velocity is ever measured.
//!
//! Source: E. Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 1.2.10.

mod integrator;

pub use integrator::Integrator;
pub use leastaction_core::discrete::Order;

use crate::Mechanism;
use crate::angle::wrap;
use crate::devices::MAX_DELAY;
use crate::error::{Range, SetupError, require};
use crate::wire::{NewtonWire, OrderWire};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::{Newton, Report, State, StepError};
use leastaction_core::model::TrainedStep;
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
    /// Ticks from a command to its effect, as far as the firmware knows; at most [`MAX_DELAY`].
    pub delay: u8,
    /// Samples of one encoder missing in a row, or ticks slept through, after which the estimate is not trusted any more.
    pub patience: u8,
}

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
    /// of 25 samples.
    pub const fn new() -> Self {
        Self {
            order: Order::Two,
            other_step: OtherStep::Refused,
            newton: NEWTON,
            memory: 5,
            delay: 1,
            patience: 25,
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
        require("observer delay", f32::from(self.delay), self.delay <= MAX_DELAY, "at most 8 ticks")
    }
}

/// Samples from which a velocity is known, two for a difference and one to average its noise.
const VELOCITY_SAMPLES: u8 = 3;

/// The growing-memory filter's (α, β) with n samples in memory.
fn gains(n: u8) -> (f32, f32) {
    let n = f32::from(n);
    let both = (n + 1.0) * (n + 2.0);
    let beta = if n > 0.0 { 6.0 / both } else { 0.0 };
    (2.0 * (2.0 * n + 1.0) / both, beta)
}

/// The state estimate of the firmware.
#[derive(Clone, Debug)]
pub struct Observer<'a, M, const N: usize> {
    model: &'a M,
    integrator: Integrator,
    angle: [bool; N],
    memory: u8,
    patience: u8,
    trusted: bool,
    /// Samples in memory, coordinate by coordinate.
    samples: [u8; N],
    /// Samples missing in a row, coordinate by coordinate.
    missing: [u8; N],
    /// First readings, until every coordinate has one.
    first: [Option<f32>; N],
    state: Option<State<f32, N>>,
}

impl<'a, M: Mechanism<N>, const N: usize> Observer<'a, M, N> {
    /// An observer that steps `model` by ticks of h seconds; `angle` says which encoders forget whole turns.
    pub fn new(model: &'a M, h: f32, angle: [bool; N], config: &ObserverConfig) -> Self {
        debug_assert!(config.memory >= 1, "a memory of at least 1 sample");
        Self {
            model,
            integrator: Integrator::new(config.order, h, config.newton),
            angle,
            memory: config.memory.max(1),
            patience: config.patience,
            trusted: false,
            samples: [0; N],
            missing: [0; N],
            first: [None; N],
            state: None,
        }
    }

    /// The discrete state, once every coordinate was measured.
    pub fn state(&self) -> Option<&State<f32, N>> {
        self.state.as_ref()
    }

    /// Whether the estimate is fit to act on: every encoder has given three samples (as many as its memory holds, if that is
    /// fewer), and none has been silent for longer than the configured patience since.
    pub fn trusted(&self) -> bool {
        self.trusted
    }

    /// Forgets everything if the firmware slept for more ticks than the configured patience, and starts anew.
    pub fn wake(&mut self, slept: u32) {
        if slept > u32::from(self.patience) {
            (self.state, self.trusted) = (None, false);
            (self.samples, self.missing, self.first) = ([0; N], [0; N], [None; N]);
        }
    }

    /// Steps the model by one tick under the force that acted. On error the estimate is what it was.
    pub fn predict(&mut self, u: &[f32; N]) -> Result<Option<Report<f32>>, StepError<f32>> {
        let Some(state) = &mut self.state else { return Ok(None) };
        self.integrator.step(self.model, state, u).map(Some)
    }

    /// Takes the samples of a tick, `None` where one is missing. On error the estimate is what it was.
    pub fn correct(&mut self, measured: &[Option<f32>; N]) -> Result<(), StepError<f32>> {
        match self.state {
            None => self.begin(measured)?,
            Some(state) => self.update(&state, measured)?,
        }
        for (i, sample) in measured.iter().enumerate() {
            self.remember(i, sample.is_some());
        }
        let enough = self.memory.min(VELOCITY_SAMPLES);
        let silent = self.missing.iter().any(|missing| *missing > self.patience);
        self.trusted = !silent && (self.trusted || self.samples.iter().all(|n| *n >= enough));
        Ok(())
    }

    /// Keeps count of the samples of coordinate i in memory and missing.
    fn remember(&mut self, i: usize, arrived: bool) {
        let (n, missing) = (&mut self.samples[i], &mut self.missing[i]);
        *missing = if arrived { 0 } else { missing.saturating_add(1) };
        if arrived {
            *n = n.saturating_add(1).min(self.memory);
        } else if *missing > self.memory {
            *n = n.saturating_sub(1);
        }
    }

    /// The estimate after further ticks under forces already decided.
    pub fn ahead<'u>(
        &self,
        forces: impl Iterator<Item = &'u [f32; N]>,
    ) -> Result<Option<ContinuousState<f32, N>>, StepError<f32>> {
        let Some(mut state) = self.state else { return Ok(None) };
        for u in forces {
            self.integrator.step(self.model, &mut state, u)?;
        }
        self.continuous(&state).map(Some)
    }

    /// Position and velocity of a discrete state.
    fn continuous(&self, state: &State<f32, N>) -> Result<ContinuousState<f32, N>, StepError<f32>> {
        let q = state.q();
        Ok(ContinuousState { q, v: self.model.velocity(&q, &state.p())? })
    }

    /// Starts at rest where every coordinate was first seen.
    fn begin(&mut self, measured: &[Option<f32>; N]) -> Result<(), StepError<f32>> {
        for (first, sample) in self.first.iter_mut().zip(measured) {
            *first = sample.or(*first);
        }
        let mut q = [0.0; N];
        for (q, first) in q.iter_mut().zip(self.first) {
            let Some(first) = first else { return Ok(()) };
            *q = first;
        }
        self.state = Some(self.model.state(q, [0.0; N])?);
        Ok(())
    }

    fn update(&mut self, state: &State<f32, N>, measured: &[Option<f32>; N]) -> Result<(), StepError<f32>> {
        if measured.iter().all(Option::is_none) {
            return Ok(());
        }
        let ContinuousState { mut q, mut v } = self.continuous(state)?;
        for i in 0..N {
            if let Some(y) = measured[i] {
                let (alpha, beta) = gains(self.samples[i]);
                let innovation = if self.angle[i] { wrap(y - q[i]) } else { y - q[i] };
                q[i] += alpha * innovation;
                v[i] += beta * innovation / self.integrator.h();
            }
        }
        self.state = Some(self.model.state(q, v)?);
        Ok(())
    }
}
