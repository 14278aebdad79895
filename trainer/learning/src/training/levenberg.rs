//! Levenberg–Marquardt: damped Gauss–Newton on the normal equations.
//!
//! Source: Nocedal and Wright, "Numerical Optimization", section 10.3; the damping follows Nielsen, "Damping parameter in Marquardt's
//! method", 1999. Steps are taken in the unbounded numbers θ of [`Bounds`](super::Bounds).

use super::limits::{Limited, fall};
use super::{NormalEquations, Objective};
use crate::matrix::cholesky;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// Limit of the damping: beyond it no direction lowers the loss in double precision.
const MU_LIMIT: f64 = 1e12;
/// Lower bound of a diagonal entry of JᵀJ that scales the damping, relative to the largest entry, if the parameters
/// have different units.
const TINY: f64 = 1e-12;
/// Smallest damping, relative to the mean diagonal of JᵀJ.
const MU_FLOOR: f64 = 1e-15;

/// The state of an optimisation, sufficient to continue it bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Levenberg {
    /// The best weights so far.
    pub weights: Vec<f64>,
    /// Loss of these weights.
    pub loss: f64,
    /// Damping μ, relative to the mean diagonal of JᵀJ.
    mu: f64,
    /// Factor by which the next rejected step raises μ.
    raise: f64,
    /// Strength λ of the penalty λ|θ|² that is added to the loss.
    decay: f64,
}

/// Result of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The loss fell.
    Lower,
    /// No step lowers the loss any more.
    Converged,
    /// The loss cannot be evaluated at the current weights.
    Stuck,
}

impl Levenberg {
    /// Starts at these weights; weights outside their range or at its end are moved a little inside.
    pub fn new(objective: &dyn Objective, weights: Vec<f64>) -> Self {
        let weights = objective.enter(objective.bounds().within(weights));
        let loss = objective.loss(&weights);
        Self { weights, loss, mu: 1e-2, raise: 2.0, decay: 0.0 }
    }

    /// Sets the initial damping relative to the diagonal of JᵀJ (10⁻² by default). A smaller value suits a nearly
    /// linear problem.
    #[must_use]
    pub fn with_damping(self, mu: f64) -> Self {
        Self { mu, ..self }
    }

    /// Adds a penalty λ|θ|² on the weights, in the units of the loss, for noisy data or few samples.
    #[must_use]
    pub fn with_decay(self, decay: f64) -> Self {
        Self { decay, ..self }
    }

    /// Does `iterations` iterations, but stops at the first that does not lower the loss. `watch` is called after each
    /// with its number, from 1.
    #[must_use]
    pub fn run(
        mut self,
        objective: &dyn Objective,
        iterations: usize,
        mut watch: impl FnMut(usize, &Self),
    ) -> Self {
        for iteration in 1..=iterations {
            if self.iterate(objective) != Progress::Lower {
                break;
            }
            watch(iteration, &self);
        }
        self
    }

    /// Runs as [`Levenberg::run`] and returns the weights with the lowest held-back loss by `judge`, among those of the
    /// start and of all iterations. Of equal losses the last counts, also if `judge` cannot evaluate any of them.
    #[must_use]
    pub fn best(
        self,
        objective: &dyn Objective,
        judge: &dyn Objective,
        iterations: usize,
        mut watch: impl FnMut(usize, &Self),
    ) -> Vec<f64> {
        let mut best = (judge.held_back_loss(&self.weights), self.weights.clone());
        let _last = self.run(objective, iterations, |iteration, state| {
            let loss = judge.held_back_loss(&state.weights);
            if loss <= best.0 {
                best = (loss, state.weights.clone());
            }
            watch(iteration, state);
        });
        best.1
    }

    /// The objective: the loss plus the penalty.
    fn cost(&self, objective: &dyn Objective, loss: f64, weights: &[f64]) -> f64 {
        loss + self.decay * weights.iter().take(objective.weights()).map(|w| w * w).sum::<f64>()
    }

    /// Does one iteration: computes the normal equations once, then tries steps with growing damping until one lowers
    /// the loss.
    pub fn iterate(&mut self, objective: &dyn Objective) -> Progress {
        if objective.settle(&mut self.weights) {
            self.loss = objective.loss(&self.weights);
        }
        let Some(mut equations) = objective.normal_equations(&self.weights) else { return Progress::Stuck };
        equations.add_decay(self.decay, &self.weights[..objective.weights()]);
        let theta = objective.bounds().free(&self.weights);
        equations.bring_to_free(objective.bounds(), &theta);
        let scales = self.damping(objective, &equations);
        let before = self.cost(objective, self.loss, &self.weights);
        while self.mu < MU_LIMIT {
            if self.try_step(objective, &theta, (&equations, &scales)) {
                let falls = before - self.cost(objective, self.loss, &self.weights);
                let falls = falls > objective.tolerance() * before;
                return if falls { Progress::Lower } else { Progress::Converged };
            }
            self.mu *= self.raise;
            self.raise *= 2.0;
        }
        Progress::Converged
    }

    /// Scale of the damping μ for every number: the mean diagonal of JᵀJ or, if the numbers have different units, each
    /// number's own diagonal entry (Marquardt), bounded from below.
    fn damping(&self, objective: &dyn Objective, equations: &NormalEquations) -> Vec<f64> {
        let diagonal = (0..equations.gradient.len()).map(|i| equations.gram[(i, i)]);
        if objective.is_of_many_units() {
            let floor = TINY * diagonal.clone().fold(f64::MIN_POSITIVE, f64::max);
            return diagonal.map(|own| own.max(floor)).collect();
        }
        vec![mean_diagonal(equations); equations.gradient.len()]
    }

    fn try_step(
        &mut self,
        objective: &dyn Objective,
        theta: &[f64],
        (equations, scales): (&NormalEquations, &[f64]),
    ) -> bool {
        let damping: Vec<f64> = scales.iter().map(|scale| self.mu * scale).collect();
        let limits = objective.limits();
        let step = match limits {
            [] => damped_step(equations, &damping),
            limits => Limited { numbers: theta, limits }.step(equations, &damping),
        };
        let Some(step) = step else { return false };
        let mut trial = theta.to_vec();
        trial.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
        let mut trial = objective.bounds().weights(&trial);
        objective.project(&mut trial);
        let loss = objective.completed_loss(&mut trial);
        let decrease = self.cost(objective, self.loss, &self.weights) - self.cost(objective, loss, &trial);
        // The decrease is NaN if the trial cannot be evaluated.
        if decrease.is_nan() || decrease <= 0.0 {
            return false;
        }
        let predicted = match limits {
            [] => predicted_decrease(equations, &step, &damping),
            _ => fall(equations, &step),
        };
        let gain = decrease / predicted;
        self.mu = (self.mu * (1.0 - (2.0 * gain - 1.0).powi(3)).max(0.1)).max(MU_FLOOR);
        self.raise = 2.0;
        (self.weights, self.loss) = (trial, loss);
        true
    }
}

fn mean_diagonal(equations: &NormalEquations) -> f64 {
    let p = equations.gradient.len();
    (0..p).map(|i| equations.gram[(i, i)]).sum::<f64>() / p as f64
}

/// The step −(JᵀJ + D)⁻¹Jᵀr, D diagonal; `None` if the matrix is not positive definite in double precision.
fn damped_step(equations: &NormalEquations, damping: &[f64]) -> Option<Vec<f64>> {
    let mut matrix = equations.gram.clone();
    for (i, damping) in damping.iter().enumerate() {
        matrix[(i, i)] += damping;
    }
    let mut step = -DVector::from_column_slice(&equations.gradient);
    cholesky(matrix)?.solve_mut(&mut step);
    Some(step.data.into())
}

/// Decrease of the mean square that the linear model predicts: ½δ·(Dδ − Jᵀr)·2/rows.
fn predicted_decrease(equations: &NormalEquations, step: &[f64], damping: &[f64]) -> f64 {
    let of = step.iter().zip(&equations.gradient).zip(damping);
    let sum: f64 = of.map(|((s, g), d)| s * (d * s - g)).sum();
    sum / equations.rows as f64
}
