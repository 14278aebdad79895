//! Standard errors of the numbers that were learned with a loss over windows.
//!  The covariance of the learned numbers is estimated by a jackknife over logs, because defects of the model
//! correlate residuals within a log but not between logs: (L − 1)/L · Σ_l δ_l δ_lᵀ, where δ_l = (H − H_l)⁻¹ g_l is
//! the change of the numbers if log l is left out. H is the Hessian of the loss with its priors: the matrix of the
//! normal equations, whose rows have the weights ρ′(x)/(2x), times one factor, Σ ρ″/2 over Σ ρ′/(2x), plus the
//! priors. H_l and g_l are the part of H and the gradient over the windows of log l. Start states are eliminated from
//! all of them. With H⁻¹ in place of (H − H_l)⁻¹ the errors would be too small if a few logs carry most of the
//! information. L is the number of logs; fewer than [`FEWEST_LOGS`] are cut into parts that count as logs, more than
//! [`MOST_LOGS`] are merged.
//!  A zero offset belongs to a single log and is not determined without that log. In place of that log's term, σ²
//! times the inverse of the offset's block of H is added, where σ² is the mean square of the residuals. This treats
//! residuals as independent, even those of one sample in several windows. That is justified because the part of a
//! zero offset that the free start states cannot absorb has one sign in the middle of a window and the other sign at
//! its ends, so such residuals do not add up.
//!
//! Correlations are taken from H⁻¹, which is robust even with few logs.
//!
//! A number that changes along a combination that the logs leave free has no standard error, however small its residuals
//! make it look: along the combination it takes any value.

use super::loss::WindowLoss;
use super::rollout::curvatures;
use crate::matrix::cholesky;
use crate::training::{
    Combination, Directions, FreeDirections, LEAST, MARGIN, NormalEquations, Objective, RANK, Range,
    Residuals, normal_equations_of, size, student, with_unit_diagonal,
};
use leastaction_models::parallel;
use nalgebra::DMatrix;
use std::ops;

/// Number of logs that suffices for a jackknife in which whole logs are left out.
const FEWEST_LOGS: usize = 5;
/// Number of parts that a smaller number of logs is cut into.
const PARTS: usize = 32;
/// Largest number of groups that are left out one by one; a larger number of logs is merged into groups.
const MOST_LOGS: usize = 64;
/// Largest number of learned numbers: the eigenvalues of a matrix of this size take seconds.
const MOST_NUMBERS: usize = 800;
/// Largest number of windows whose residuals are evaluated.
const WINDOWS: usize = 4096;
/// Share of a number's information in a single log above which the number counts as belonging to that log.
const OWN: f64 = 0.99;

pub use crate::training::Shown;

/// A learned number.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedNumber {
    /// Position among the numbers that windows share.
    pub position: usize,
    /// Learned value, in its unit.
    pub value: f64,
    /// Standard error, or the reason why there is none.
    pub shown: Shown,
    /// Position of the number with the strongest correlation, and this correlation.
    pub strongest: Option<(usize, f64)>,
}

/// Precision of all learned numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Certainty {
    /// Learned numbers in the order of their positions.
    pub numbers: Vec<LearnedNumber>,
    /// Number of directions in the space of these numbers that the logs do not determine.
    pub hidden: usize,
    /// Combinations of numbers that the logs leave free, by position, with relative changes; empty if they are not known.
    pub combinations: Vec<Combination>,
    /// Number of logs, or parts of logs, taken as independent.
    pub clusters: usize,
    /// Whether these clusters are whole logs.
    pub whole_logs: bool,
}

impl Certainty {
    /// Half-width of the 95% confidence interval in standard errors, by Student's t distribution with `clusters` − 1 degrees of freedom.
    pub fn interval(&self) -> f64 {
        student(self.clusters.saturating_sub(1))
    }
}

/// The precision of numbers that minimise a loss. `weights` are all parameters, as the optimiser has them; `ranges` are
/// the ranges of the learned numbers, with their positions. `None` if there are no learned numbers or too many for a
/// matrix, or if the loss cannot be evaluated.
pub fn certainty(loss: &WindowLoss, weights: &[f64], ranges: &[(usize, Range)]) -> Option<Certainty> {
    let learned = loss.learned();
    if learned.is_empty() || learned.len() > MOST_NUMBERS {
        return None;
    }
    let equations = Equations::of(loss, weights)?;
    let free = equations.free_directions(weights, &learned);
    let moves =
        |position: usize| learned.iter().position(|of| *of == position).is_some_and(|k| free.moves(k));
    let is_at_bound = |position: usize| {
        let ends = |(of, range): &(usize, Range)| *of == position && ends(*range, weights[position]);
        ranges.iter().any(ends) && !moves(position)
    };
    let positions: Vec<usize> = learned.iter().copied().filter(|position| !is_at_bound(*position)).collect();
    // Without a number at a bound the directions are those of all numbers.
    let known = (positions.len() == learned.len()).then(|| free.shown().clone());
    let clusters = Clusters::of(loss);
    let spread =
        parallel::within(|| Spread::of((loss, &equations), weights, (&positions, known), &clusters))?;
    let own = |k: usize| {
        let shown = if moves(positions[k]) { Shown::Together } else { spread.shown(k) };
        let strongest = spread.directions.strongest(&spread.inverse, k, |other| !moves(positions[other]));
        (shown, strongest.filter(|_| shown != Shown::Together))
    };
    let number = |position: usize| {
        let k = positions.iter().position(|of| *of == position);
        let (shown, strongest) = k.map_or((Shown::AtBound, None), own);
        let strongest = strongest.map(|(k, part)| (positions[k], part));
        LearnedNumber { position, value: weights[position], shown, strongest }
    };
    let named =
        |combination: Combination| combination.into_iter().map(|(k, part)| (learned[k], part)).collect();
    Some(Certainty {
        numbers: learned.iter().map(|position| number(*position)).collect(),
        hidden: free.count(),
        combinations: free.combinations().into_iter().map(named).collect(),
        clusters: clusters.parts.len(),
        whole_logs: clusters.whole_logs,
    })
}

/// The normal equations of all windows, and those of the priors alone.
struct Equations {
    all: NormalEquations,
    prior: NormalEquations,
}

impl Equations {
    fn of(loss: &WindowLoss, weights: &[f64]) -> Option<Self> {
        let all = loss.normal_equations(weights)?;
        let mut prior = NormalEquations::zero(all.gradient.len());
        loss.add_penalty(weights, &mut prior);
        Some(Self { all, prior })
    }

    /// Entry (i, j) of JᵀJ without priors, by position.
    fn data(&self, i: usize, j: usize) -> f64 {
        self.all.entry(i, j) - self.prior.entry(i, j)
    }

    /// JᵀJ without priors, for the numbers at these positions.
    fn gram(&self, positions: &[usize]) -> DMatrix<f64> {
        let p = positions.len();
        DMatrix::from_fn(p, p, |i, j| self.data(positions[i], positions[j]))
    }

    /// Directions that the windows leave free, for the numbers at these positions.
    fn free_directions(&self, weights: &[f64], positions: &[usize]) -> FreeDirections {
        let gram = self.gram(positions);
        let variance = self.all.squares / self.all.rows.max(1) as f64;
        let error = |k: usize| if gram[(k, k)] > 0.0 { (variance / gram[(k, k)]).sqrt() } else { 0.0 };
        let sizes: Vec<f64> =
            positions.iter().enumerate().map(|(k, of)| size(weights[*of], 0.0, error(k))).collect();
        FreeDirections::of(&gram, &sizes)
    }
}

/// Whether a number is at an end of its range.
fn ends(range: Range, w: f64) -> bool {
    match range {
        Range::Any => false,
        Range::Positive => w <= 10.0 * LEAST,
        Range::Between(least, most) => (w - least).min(most - w) <= 2.0 * MARGIN * (most - least),
    }
}

/// Groups of windows; residuals of different groups are taken as independent.
struct Clusters {
    parts: Vec<ops::Range<usize>>,
    whole_logs: bool,
}

impl Clusters {
    fn of(loss: &WindowLoss) -> Self {
        let logs = loss.windows_of_logs();
        if logs.len() >= FEWEST_LOGS {
            let joined = logs.chunks(logs.len().div_ceil(MOST_LOGS));
            let part = |logs: &[ops::Range<usize>]| Some(logs.first()?.start..logs.last()?.end);
            return Self { parts: joined.filter_map(part).collect(), whole_logs: true };
        }
        let windows = Residuals::samples(loss);
        let size = windows.div_ceil(PARTS).max(1);
        let part = |first: usize| first..(first + size).min(windows);
        Self { parts: (0..windows).step_by(size).map(part).collect(), whole_logs: false }
    }
}

/// Covariance of numbers in scaled units: each number divided by the root of its diagonal entry in JᵀJ.
struct Spread {
    /// Scales 1/√(JᵀJ)_ii.
    sizes: Vec<f64>,
    directions: Directions,
    /// H⁻¹ within the determined directions.
    inverse: DMatrix<f64>,
    variances: Vec<f64>,
}

impl Spread {
    fn of(
        (loss, equations): (&WindowLoss, &Equations),
        weights: &[f64],
        (positions, known): (&[usize], Option<Directions>),
        clusters: &Clusters,
    ) -> Option<Self> {
        let (p, Equations { all, prior }) = (positions.len(), equations);
        let data = |i: usize, j: usize| equations.data(positions[i], positions[j]);
        let of_prior = |i, j| entry(prior, positions, i, j);
        let (sizes, scaled) = with_unit_diagonal(&equations.gram(positions));
        let directions = known.unwrap_or_else(|| Directions::of(&scaled, |_| RANK));
        let ratio = curvature_ratio(loss, weights);
        let own = DMatrix::from_fn(p, p, |i, j| sizes[i] * sizes[j] * (ratio * data(i, j) + of_prior(i, j)));
        let inverse = directions.inverse(&own)?;
        let part = |of: &ops::Range<usize>| -> Option<(DMatrix<f64>, Vec<usize>)> {
            let log = normal_equations_of(loss, weights, of.clone())?;
            let rest = DMatrix::from_fn(p, p, |i, j| {
                own[(i, j)] - ratio * sizes[i] * sizes[j] * entry(&log, positions, i, j)
            });
            let gradient = DMatrix::from_fn(p, 1, |i, _| sizes[i] * log.gradient[positions[i]]);
            let mut moved = directions.moved(&rest, &gradient, &inverse);
            let owns = |i: &usize| entry(&log, positions, *i, *i) > OWN * data(*i, *i);
            let own: Vec<usize> = (0..p).filter(owns).collect();
            // Without its log, a number that belongs to that log stays at its prior.
            own.iter().for_each(|i| moved[(*i, 0)] = 0.0);
            Some((moved, own))
        };
        let moved: Vec<(DMatrix<f64>, Vec<usize>)> =
            clusters.parts.iter().map(part).collect::<Option<_>>()?;
        let mean_square = (all.squares / all.rows.saturating_sub(p).max(1) as f64).max(0.0);
        let alone = of_single_logs(loss, positions, &own, mean_square);
        let count = moved.len() as f64;
        let variance = |i: usize| {
            let squares: f64 = moved.iter().map(|(of, _)| of[(i, 0)].powi(2)).sum();
            let is_of_one = moved.iter().any(|(_, own)| own.contains(&i));
            (count - 1.0) / count * squares + if is_of_one { alone[i] } else { 0.0 }
        };
        let variances = (0..p).map(variance).collect();
        Some(Self { sizes, directions, inverse, variances })
    }

    fn shown(&self, i: usize) -> Shown {
        if !self.directions.shows(i) || self.sizes[i] == 0.0 {
            return Shown::Together;
        }
        Shown::Within(self.sizes[i] * self.variances[i].sqrt())
    }
}

/// Σρ″/2 divided by Σρ′/2x.
fn curvature_ratio(loss: &WindowLoss, weights: &[f64]) -> f64 {
    let residuals = loss.scaled_residuals(weights, WINDOWS);
    let sum = residuals.iter().flatten().fold([0.0; 2], |sum, x| {
        let own = curvatures(*x);
        [sum[0] + own[0], sum[1] + own[1]]
    });
    if sum[0] > 0.0 { sum[1] / sum[0] } else { 1.0 }
}

/// Entry (i, j) of JᵀJ for the numbers at these positions.
fn entry(equations: &NormalEquations, positions: &[usize], i: usize, j: usize) -> f64 {
    equations.entry(positions[i], positions[j])
}

/// Variances of numbers that belong to a single log, for fixed values of all other numbers; 0 for the rest.
fn of_single_logs(loss: &WindowLoss, positions: &[usize], own: &DMatrix<f64>, mean_square: f64) -> Vec<f64> {
    let (layout, mut variances) = (loss.layout(), vec![0.0; positions.len()]);
    for log in 0..layout.logs {
        let range = layout.zero(log, 0)..layout.zero(log + 1, 0);
        let places: Vec<usize> = (0..positions.len()).filter(|k| range.contains(&positions[*k])).collect();
        let block = DMatrix::from_fn(places.len(), places.len(), |i, j| own[(places[i], places[j])]);
        let Some(factor) = cholesky(block) else { continue };
        let inverse = factor.inverse();
        places.iter().enumerate().for_each(|(k, place)| variances[*place] = mean_square * inverse[(k, k)]);
    }
    variances
}
