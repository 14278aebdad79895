//! How well the logs of a loss over windows show what was learned from them.
//!
//! The covariance of the learned numbers is (L − 1)/L · Σ_l δ_l δ_lᵀ with δ_l = (H − H_l)⁻¹ g_l, by how much they move where log l is
//! left out (the jackknife): what is missing in the model makes residuals of one log alike, those of different logs not. H is the matrix
//! of the normal equations with ρ″/2 in place of ρ′/2x (their ratio, averaged over residuals, is one number) and with the priors, H_l
//! and g_l are its part and the gradient over the windows of log l. Start states are eliminated in all of them. H⁻¹ in place of
//! (H − H_l)⁻¹ would make errors too small where a few logs show most. L is the number of logs; fewer than [`FEWEST_LOGS`] are cut into
//! parts that count as logs, more than [`MOST_LOGS`] are joined.
//!
//! A zero offset belongs to a single log, without which nothing shows it: in place of that log's part σ² times the inverse of its block of
//! H is added, σ² the mean square of the residuals, as if these were independent, those of one sample in several windows too: what the
//! free start states leave of a zero has one sign in the middle of a window and the other at its ends, so that such residuals do not add up.
//!
//! Correlations are those of H⁻¹, which few logs do not disturb.

use super::loss::WindowLoss;
use super::rollout::curvatures;
use crate::training::{
    Directions, LEAST, MARGIN, NormalEquations, Objective, Range, Residuals, normal_equations_of, student,
};
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};
use leastaction_models::parallel;
use std::ops;

/// Logs that are enough to be told apart.
const FEWEST_LOGS: usize = 5;
/// Parts of which fewer logs are cut.
const PARTS: usize = 32;
/// Logs that are left out one by one, at most.
const MOST_LOGS: usize = 64;
/// Numbers at most: the eigenvalues of a matrix of this size take seconds.
const MOST_NUMBERS: usize = 800;
/// Windows whose residuals are looked at, at most.
const WINDOWS: usize = 4096;
/// A number that a log has more than this part of is shown by it alone.
const OWN: f64 = 0.99;
/// Eigenvalues of the scaled matrix below this are rounding errors of 0.
const RANK: f64 = 1e-9;

pub use crate::training::Shown;

/// A learned number.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedNumber {
    /// Its position among the numbers that windows share.
    pub position: usize,
    /// As it was learned, in its unit.
    pub value: f64,
    /// How well it is known.
    pub shown: Shown,
    /// The position of the number that it is most correlated with, and their correlation.
    pub strongest: Option<(usize, f64)>,
}

/// How well all learned numbers are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Certainty {
    /// In the order of their positions.
    pub numbers: Vec<LearnedNumber>,
    /// Directions in their space that the logs do not show.
    pub hidden: usize,
    /// Logs, or parts of logs, that were taken to be independent.
    pub clusters: usize,
    /// Whether they are whole logs.
    pub whole_logs: bool,
}

impl Certainty {
    /// By how many standard errors a number is off at most in 95 of 100 cases, by Student's distribution with one degree of freedom less
    /// than there are clusters.
    pub fn interval(&self) -> f64 {
        student(self.clusters.saturating_sub(1))
    }
}

/// That of numbers that a loss was minimised to, all of them as the optimiser has them; `ranges` are those of the learned numbers by
/// their positions. `None` where there are none or more than a matrix is made of, or the loss cannot be evaluated.
pub fn certainty(loss: &WindowLoss, weights: &[f64], ranges: &[(usize, Range)]) -> Option<Certainty> {
    let learned = loss.learned();
    let is_at_bound = |position: &usize| {
        ranges.iter().any(|(of, range)| of == position && ends(*range, weights[*position]))
    };
    let positions: Vec<usize> = learned.iter().copied().filter(|position| !is_at_bound(position)).collect();
    if positions.is_empty() || positions.len() > MOST_NUMBERS {
        return None;
    }
    let clusters = Clusters::of(loss);
    let spread = parallel::within(|| Spread::of(loss, weights, &positions, &clusters))?;
    let number = |position: usize| {
        let k = positions.iter().position(|of| *of == position);
        LearnedNumber {
            position,
            value: weights[position],
            shown: k.map_or(Shown::AtBound, |k| spread.shown(k)),
            strongest: k
                .and_then(|k| spread.directions.strongest(&spread.inverse, k))
                .map(|(k, part)| (positions[k], part)),
        }
    };
    Some(Certainty {
        numbers: learned.iter().map(|position| number(*position)).collect(),
        hidden: spread.directions.hidden(),
        clusters: clusters.parts.len(),
        whole_logs: clusters.whole_logs,
    })
}

/// Whether a number is at an end of its range.
fn ends(range: Range, w: f64) -> bool {
    match range {
        Range::Any => false,
        Range::Positive => w <= 10.0 * LEAST,
        Range::Between(least, most) => (w - least).min(most - w) <= 2.0 * MARGIN * (most - least),
    }
}

/// Windows whose residuals are taken to be independent of those of others.
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

/// Covariances of numbers, each divided by the root of its diagonal entry in JᵀJ.
struct Spread {
    /// 1/√(JᵀJ)_ii.
    sizes: Vec<f64>,
    directions: Directions,
    /// H⁻¹ in the directions that are shown.
    inverse: Mat<f64>,
    variances: Vec<f64>,
}

impl Spread {
    fn of(loss: &WindowLoss, weights: &[f64], positions: &[usize], clusters: &Clusters) -> Option<Self> {
        let p = positions.len();
        let all = loss.normal_equations(weights)?;
        let mut prior = NormalEquations::zero(all.gradient.len());
        loss.add_penalty(weights, &mut prior);
        let of = |equations: &NormalEquations, i, j| entry(equations, positions, i, j);
        let data = |i, j| of(&all, i, j) - of(&prior, i, j);
        let size = |square: f64| if square > f64::MIN_POSITIVE { square.sqrt().recip() } else { 0.0 };
        let sizes: Vec<f64> = (0..p).map(|i| size(data(i, i))).collect();
        let scaled = Mat::from_fn(p, p, |i, j| sizes[i] * sizes[j] * data(i, j));
        let directions = Directions::of(&scaled, |_| RANK);
        let ratio = curvature_ratio(loss, weights);
        let own = Mat::from_fn(p, p, |i, j| sizes[i] * sizes[j] * (ratio * data(i, j) + of(&prior, i, j)));
        let inverse = directions.inverse(&own)?;
        let part = |of: &ops::Range<usize>| -> Option<(Mat<f64>, Vec<usize>)> {
            let log = normal_equations_of(loss, weights, of.clone())?;
            let rest = Mat::from_fn(p, p, |i, j| {
                own[(i, j)] - ratio * sizes[i] * sizes[j] * entry(&log, positions, i, j)
            });
            let gradient = Mat::from_fn(p, 1, |i, _| sizes[i] * log.gradient[positions[i]]);
            let mut moved = directions.moved(&rest, &gradient, &inverse);
            let owns = |i: &usize| entry(&log, positions, *i, *i) > OWN * data(*i, *i);
            let own: Vec<usize> = (0..p).filter(owns).collect();
            // Without its log a number is what is expected of it.
            own.iter().for_each(|i| moved[(*i, 0)] = 0.0);
            Some((moved, own))
        };
        let moved: Vec<(Mat<f64>, Vec<usize>)> = clusters.parts.iter().map(part).collect::<Option<_>>()?;
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

/// Σρ″/2 over Σρ′/2x.
fn curvature_ratio(loss: &WindowLoss, weights: &[f64]) -> f64 {
    let residuals = loss.scaled_residuals(weights, WINDOWS);
    let sum = residuals.iter().flatten().fold([0.0; 2], |sum, x| {
        let own = curvatures(*x);
        [sum[0] + own[0], sum[1] + own[1]]
    });
    if sum[0] > 0.0 { sum[1] / sum[0] } else { 1.0 }
}

/// Entry (i, j) of JᵀJ of the numbers at these positions.
fn entry(equations: &NormalEquations, positions: &[usize], i: usize, j: usize) -> f64 {
    equations.entry(positions[i], positions[j])
}

/// Variances of numbers that belong to one log alone, given the others; 0 of all others.
fn of_single_logs(loss: &WindowLoss, positions: &[usize], own: &Mat<f64>, mean_square: f64) -> Vec<f64> {
    let (layout, mut variances) = (loss.layout(), vec![0.0; positions.len()]);
    for log in 0..layout.logs {
        let range = layout.zero(log, 0)..layout.zero(log + 1, 0);
        let places: Vec<usize> = (0..positions.len()).filter(|k| range.contains(&positions[*k])).collect();
        let block = Mat::from_fn(places.len(), places.len(), |i, j| own[(places[i], places[j])]);
        let Ok(factor) = block.llt(Side::Lower) else { continue };
        let inverse = factor.inverse();
        places.iter().enumerate().for_each(|(k, place)| variances[*place] = mean_square * inverse[(k, k)]);
    }
    variances
}
