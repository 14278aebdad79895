//! Rollouts in LGNN's measures: the rollout error ‖q̂ − q‖/(‖q̂‖ + ‖q‖) and the energy violation |Ê − E|/(|Ê| + |E|), each as geometric
//! mean over starts and times (LGNN, section 4). Ê and E are the exact energies of the predicted and of the exact state.

use super::prediction::Truth;
use leastaction_ground_truth::ExactMotion;
use leastaction_models::parallel;

/// Lower bound of errors in a geometric mean; smaller errors are rounding.
const LEAST: f64 = 1e-17;

/// Quantities compared by the rollout error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// Positions (LGNN).
    Positions,
    /// Positions and velocities (CHNN).
    States,
}

/// Errors of rollouts from many starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Rollouts {
    /// Geometric mean over starts of the rollout error at each comparison, except at the start.
    pub rollout_error: Vec<f64>,
    /// Geometric mean over starts of the energy violation at each comparison, except at the start.
    pub energy_violation: Vec<f64>,
    /// Number of rollouts that could not be followed to the end; their errors count as 1 from there on.
    pub failed: usize,
}

impl Rollouts {
    /// Rolls out accelerations v̇(q, v) from the starts of the truth, each step integrated to `tolerance` and projected onto the rods of
    /// the exact motion.
    pub fn new(
        truth: &Truth,
        motion: &dyn ExactMotion,
        compared: Compared,
        tolerance: f64,
        acceleration: impl Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync,
    ) -> Self {
        let one = |k: usize| {
            let (states, failed) = truth.predicted(k, tolerance, motion, &acceleration);
            (errors(motion, compared, &states, truth.states(k)), failed)
        };
        Self::of(truth, parallel::map(truth.starts().len(), &one))
    }

    /// Errors of other exact motions, treated as rollouts of these: the growth of a disturbance of the start.
    pub fn between(truth: &Truth, other: &Truth, motion: &dyn ExactMotion, compared: Compared) -> Self {
        let one = |k: usize| (errors(motion, compared, other.states(k), truth.states(k)), false);
        Self::of(truth, (0..truth.starts().len()).map(one).collect())
    }

    /// Aggregates the errors of all starts; the flag says whether a start failed.
    fn of(truth: &Truth, all: Vec<(Vec<[f64; 2]>, bool)>) -> Self {
        let failed = all.iter().filter(|(_, failed)| *failed).count();
        let mean = |pick: fn(&[f64; 2]) -> f64| -> Vec<f64> {
            let at = |k: usize| geometric_mean(all.iter().map(|(errors, _)| pick(&errors[k])));
            (1..truth.horizon().samples).map(at).collect()
        };
        Self { rollout_error: mean(|e| e[0]), energy_violation: mean(|e| e[1]), failed }
    }

    /// Geometric means over starts and times of the rollout error and the energy violation.
    pub fn means(&self) -> [f64; 2] {
        [&self.rollout_error, &self.energy_violation].map(|errors| geometric_mean(errors.iter().copied()))
    }

    /// Rollout error at the end.
    pub fn last(&self) -> f64 {
        self.rollout_error.last().copied().unwrap_or(f64::NAN)
    }
}

/// Rollout error and energy violation of every comparison.
fn errors(motion: &dyn ExactMotion, compared: Compared, predicted: &[f64], exact: &[f64]) -> Vec<[f64; 2]> {
    let n = motion.coordinates();
    let width = if compared == Compared::Positions { n } else { 2 * n };
    let energy = |state: &[f64]| motion.energy(&state[..n], &state[n..]);
    let pairs = predicted.chunks_exact(2 * n).zip(exact.chunks_exact(2 * n));
    let error = |(predicted, exact): (&[f64], &[f64])| {
        let difference: Vec<f64> = predicted.iter().zip(exact).take(width).map(|(p, e)| p - e).collect();
        let positions = relative(norm(&difference), norm(&predicted[..width]), norm(&exact[..width]));
        let (ours, truth) = (energy(predicted), energy(exact));
        [positions, relative((ours - truth).abs(), ours.abs(), truth.abs())]
    };
    pairs.map(error).collect()
}

/// Relative difference, between 0 and 1; 1 if it is not finite.
fn relative(difference: f64, a: f64, b: f64) -> f64 {
    let relative = difference / (a + b);
    if relative.is_finite() { relative } else { 1.0 }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Geometric mean of numbers ≥ 0; numbers below 1e-17 count as 1e-17; NaN if there are none.
pub fn geometric_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0usize), |(sum, count), x| (sum + x.max(LEAST).ln(), count + 1));
    (sum / count as f64).exp()
}
