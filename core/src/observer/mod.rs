//! Observer: estimates the state of a mechanism (positions, velocities, and the encoders' zeros) with the model, from
//! nothing but the readings of its encoders.
//!
//! Between samples the estimate moves by the model's discrete Euler–Lagrange step under the force of the actuators, whose delay
//! [`Commands`] mirrors. A sample y corrects the estimate by its innovation
//!
//! e = y − ẑ − q̂   (the short way round, for an angle),   q̂ ← q̂ + αe,   v̂ ← v̂ + βe/h.
//!
//! The gains are those of the growing-memory filter over n samples, α = 2(2n + 1)/((n + 1)(n + 2)) and β = 6/((n + 1)(n + 2)), the
//! least-squares fit to the samples so far; n stops growing at the configured memory. If more samples in a row are missing than the memory
//! holds, n shrinks by one per missing sample, so that after a long gap the encoder is believed more than the model. No velocity is ever
//! measured.
//!
//! # Zeros
//!
//! If an encoder is off by z, the model computes gravity at a wrong position, which pushes all innovations one way.
//! If zeros are to be learned, ẑ is the minimiser of Σ e² so far. It is found recursively from the derivative of the
//! estimate, S = ∂(q̂, v̂)/∂ẑ, which is stepped and corrected along with the estimate: with D = Q_v, K = L_qq + Q_q
//! and ψ = −∂e_i/∂ẑ = 1_i + ∂q̂_i/∂ẑ,
//!
//! S_v ← S_v + h(M − hD)⁻¹(K S_q + D S_v),   S_q ← S_q + h S_v;   then at a sample   S_q,i ← S_q,i − αψ,   S_v,i ← S_v,i − βψ/h;
//!
//! δ = Pψ e/(σ² + ψᵀPψ),   ẑ ← ẑ + δ,   P ← P − Pψψᵀ P/(σ² + ψᵀPψ),   (q̂, v̂) ← (q̂, v̂) + Sδ,
//!
//! from P = σ_z² 1, with e limited to three of its standard deviations. The step of S leaves out the terms in
//! products of velocities, although e contains them. A zero on which nothing depends, such as that of a cart on a
//! level track, has ψ = 0 and stays 0. If the model's forces are off, the zeros take up what they can of the error.
//!
//! Sources: E. Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 1.2.10; L. Ljung and T. Söderström, "Theory and Practice
//! of Recursive Identification", 1983, chapter 3.

mod commands;
mod integrator;
mod zeros;

pub use commands::{Commands, DelayLine, MAX_DELAY};
pub use integrator::Integrator;
pub use zeros::ZerosPrior;

use crate::continuous::ContinuousState;
use crate::discrete::{Control, Report, State, StepError};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::scalar::Real;
use zeros::Zeros;

/// Tuning of an observer: how far it trusts the model, and what it learns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning<R> {
    /// Maximum number of samples in memory, at least 1: a longer memory smooths the noise more and follows a wrong model longer.
    pub memory: u8,
    /// Number of samples of one encoder missing in a row, or of steps slept through, after which the estimate is no longer trusted.
    pub patience: u8,
    /// Prior knowledge of the encoders' zeros; `None`: they are 0.
    pub zeros: Option<ZerosPrior<R>>,
}

/// Part of an error below which the estimate counts as settled.
const SETTLED: f64 = 0.01;

impl<R: Real> Tuning<R> {
    /// Settling time: number of steps, each with a sample of every encoder, after which 1% or less is left of any error of the estimate, in
    /// position or, times the step, in velocity. The memory is full; gravity and the like, which change the error meanwhile, are left out.
    pub fn settling(&self) -> u32 {
        let (alpha, beta) = gains::<R>(self.memory.max(1));
        // Errors oscillate as they fall, by a factor of about 1 - 2/n in a step.
        let steps = 16 * (u32::from(self.memory) + 1);
        let (mut errors, mut settled) = ([[R::one(), R::zero()], [R::zero(), R::one()]], 0);
        for step in 1..=steps {
            errors = errors.map(|[q, v]| [(R::one() - alpha) * (q + v), v - beta * (q + v)]);
            if errors.as_flattened().iter().any(|error| error.abs() > R::constant(SETTLED)) {
                settled = step;
            }
        }
        settled + 1
    }
}

/// Number of samples that make a velocity known: two for a difference, and one to average its noise.
const VELOCITY_SAMPLES: u8 = 3;

/// Gains (α, β) of the growing-memory filter with n samples in memory.
fn gains<R: Real>(n: u8) -> (R, R) {
    let (one, two) = (R::one(), R::constant(2.0));
    let n = R::constant(f64::from(n));
    let both = (n + one) * (n + two);
    let beta = if n > R::zero() { R::constant(6.0) / both } else { R::zero() };
    (two * (two * n + one) / both, beta)
}

/// The estimate of a mechanism's state. It holds no model: every call that needs the system takes it, so its numbers may change between calls.
///
/// T is taken as ½vᵀM(q)v; for any other kinetic energy, v is not M⁻¹p. Every call takes a bounded time; nothing is allocated.
#[derive(Clone, Debug, PartialEq)]
pub struct Observer<R, const N: usize> {
    integrator: Integrator<R>,
    angle: [bool; N],
    tuning: Tuning<R>,
    trusted: bool,
    /// Number of samples in memory, by coordinate.
    samples: [u8; N],
    /// Number of samples missing in a row, by coordinate.
    missing: [u8; N],
    /// First readings, until every coordinate has one.
    first: [Option<R>; N],
    state: Option<State<R, N>>,
    zeros: Zeros<R, N>,
}

impl<R: Real, const N: usize> Observer<R, N> {
    /// Creates an observer that steps its systems by an integrator; `angle` marks the encoders that forget whole turns. A memory of 0 is taken
    /// as 1.
    pub fn new(integrator: Integrator<R>, angle: [bool; N], tuning: Tuning<R>) -> Self {
        Self {
            integrator,
            angle,
            tuning: Tuning { memory: tuning.memory.max(1), ..tuning },
            trusted: false,
            samples: [0; N],
            missing: [0; N],
            first: [None; N],
            state: None,
            zeros: Zeros::new(tuning.zeros),
        }
    }

    /// The discrete state, once every coordinate was measured.
    pub fn state(&self) -> Option<&State<R, N>> {
        self.state.as_ref()
    }

    /// Zeros ẑ, by which the encoders read too much, rad or m.
    pub fn zeros(&self) -> [R; N] {
        self.zeros.estimate()
    }

    /// Standard deviations of the zeros, provided that the innovations are noise; rad or m.
    pub fn zeros_deviation(&self) -> [R; N] {
        self.zeros.deviation()
    }

    /// Flags of the encoders that forget whole turns.
    pub const fn angle(&self) -> &[bool; N] {
        &self.angle
    }

    /// Whether the estimate is fit to act on: every encoder has given three samples (or as many as its memory holds, if fewer), and none
    /// has since been silent for longer than the configured patience.
    pub fn trusted(&self) -> bool {
        self.trusted
    }

    /// Forgets the state, but not the zeros, and starts again if the observer slept for more steps than the
    /// configured patience.
    pub fn wake(&mut self, slept: u32) {
        if slept > u32::from(self.tuning.patience) {
            (self.state, self.trusted) = (None, false);
            (self.samples, self.missing, self.first) = ([0; N], [0; N], [None; N]);
        }
    }

    /// Steps the system under the force that acted.
    ///
    /// # Errors
    /// The errors of the step; the estimate is then unchanged.
    pub fn predict<L: Lagrangian<R, N>, F: Forces<R, N>>(
        &mut self,
        system: &System<L, F>,
        u: &Control<R, N>,
    ) -> Result<Option<Report<R>>, StepError<R>> {
        let Some(mut state) = self.state else { return Ok(None) };
        let report = self.integrator.step(system, &mut state, u)?;
        if self.tuning.zeros.is_some() {
            let ContinuousState { q, v } = continuous(&system.lagrangian, &state)?;
            self.zeros = self.zeros.stepped(system, (&q, &v, &u.end), self.integrator.h())?;
        }
        self.state = Some(state);
        Ok(Some(report))
    }

    /// Takes the samples of a step, rad or m; `None` for a missing one.
    ///
    /// # Errors
    /// An error if the estimate would not be finite, or the mass matrix is singular; the estimate is then unchanged.
    pub fn correct<L: Lagrangian<R, N>, F>(
        &mut self,
        system: &System<L, F>,
        measured: &[Option<R>; N],
    ) -> Result<(), StepError<R>> {
        match self.state {
            None => self.begin(&system.lagrangian, measured)?,
            Some(state) => self.update(&system.lagrangian, &state, measured)?,
        }
        for (i, sample) in measured.iter().enumerate() {
            self.remember(i, sample.is_some());
        }
        let enough = self.tuning.memory.min(VELOCITY_SAMPLES);
        let silent = self.missing.iter().any(|missing| *missing > self.tuning.patience);
        self.trusted = !silent && (self.trusted || self.samples.iter().all(|n| *n >= enough));
        Ok(())
    }

    /// Counts the samples of coordinate i in memory and those missing.
    fn remember(&mut self, i: usize, arrived: bool) {
        let (n, missing) = (&mut self.samples[i], &mut self.missing[i]);
        *missing = if arrived { 0 } else { missing.saturating_add(1) };
        if arrived {
            *n = n.saturating_add(1).min(self.tuning.memory);
        } else if *missing > self.tuning.memory {
            *n = n.saturating_sub(1);
        }
    }

    /// The present estimate.
    ///
    /// # Errors
    /// An error if the mass matrix is singular.
    pub fn estimate<L: Lagrangian<R, N>, F>(
        &self,
        system: &System<L, F>,
    ) -> Result<Option<ContinuousState<R, N>>, StepError<R>> {
        self.state.map(|state| continuous(&system.lagrangian, &state)).transpose()
    }

    /// The estimate at the time when the next command takes effect: after all steps that `commands` has decided, the rest of the delay, and the
    /// time constant of a lag.
    ///
    /// # Errors
    /// The errors of the step.
    pub fn ahead<L: Lagrangian<R, N>, F: Forces<R, N>>(
        &self,
        system: &System<L, F>,
        commands: &Commands<R, N>,
    ) -> Result<Option<ContinuousState<R, N>>, StepError<R>> {
        let Some(mut state) = self.state else { return Ok(None) };
        commands.to_come(|part, u| {
            let part = self.integrator.with_step(part * self.integrator.h());
            part.step(system, &mut state, u).map(|_| ())
        })?;
        continuous(&system.lagrangian, &state).map(Some)
    }

    /// Starts at rest at the first reading of every coordinate.
    fn begin<L: Lagrangian<R, N>>(
        &mut self,
        lagrangian: &L,
        measured: &[Option<R>; N],
    ) -> Result<(), StepError<R>> {
        for (first, sample) in self.first.iter_mut().zip(measured) {
            *first = sample.or(*first);
        }
        let mut q = self.zeros();
        for (q, first) in q.iter_mut().zip(self.first) {
            let Some(first) = first else { return Ok(()) };
            *q = first - *q;
        }
        self.state = Some(State::new(lagrangian, q, [R::zero(); N])?);
        self.zeros.follow_readings();
        Ok(())
    }

    fn update<L: Lagrangian<R, N>>(
        &mut self,
        lagrangian: &L,
        state: &State<R, N>,
        measured: &[Option<R>; N],
    ) -> Result<(), StepError<R>> {
        if measured.iter().all(Option::is_none) {
            return Ok(());
        }
        let (mut estimate, mut zeros) = (continuous(lagrangian, state)?, self.zeros);
        for (i, sample) in measured.iter().enumerate() {
            if let Some(y) = sample {
                self.take(i, *y, &mut estimate, &mut zeros);
            }
        }
        zeros.check()?;
        self.state = Some(State::new(lagrangian, estimate.q, estimate.v)?);
        self.zeros = zeros;
        Ok(())
    }

    /// Corrects an estimate by one sample.
    fn take(&self, i: usize, y: R, estimate: &mut ContinuousState<R, N>, zeros: &mut Zeros<R, N>) {
        let (alpha, beta) = gains(self.samples[i]);
        let apart = y - zeros.estimate()[i] - estimate.q[i];
        let innovation = if self.angle[i] { apart.short_way() } else { apart };
        estimate.q[i] += alpha * innovation;
        estimate.v[i] += beta * innovation / self.integrator.h();
        if let Some(prior) = &self.tuning.zeros {
            let direction = zeros.corrected(i, alpha, beta / self.integrator.h());
            if self.trusted {
                zeros.learn(&direction, innovation, prior, estimate);
            }
        }
    }
}

/// Position and velocity of a discrete state.
fn continuous<R: Real, L: Lagrangian<R, N>, const N: usize>(
    lagrangian: &L,
    state: &State<R, N>,
) -> Result<ContinuousState<R, N>, StepError<R>> {
    Ok(ContinuousState { q: state.q(), v: state.velocity(lagrangian)? })
}
