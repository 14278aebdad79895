//! What samples say by themselves of base parameters and joints, and how well.
//!
//! A prior draws every number towards the description, by an amount that depends on the truth: an interval around such a fit covers nothing
//! that could be named. So the numbers here are those of least squares without a prior and without the bounds of bodies, in the combinations that
//! torques depend on at all ([`BaseParameters`]) and in the joints' numbers, and the errors are those of these estimates.
//!
//! The residuals of filtered samples hang together over the filter's memory, and what a model lacks makes them alike for longer; those of all
//! joints share the noise of the accelerations. So the covariance is that of the jackknife over blocks of time,
//! (L − 1)/L Σ_l δ_l δ_lᵀ with δ_l = (H − H_l)⁻¹ g_l, by how much the numbers move where block l is left out; H = JᵀJ, H_l and g_l = J_lᵀr_l are
//! the parts of a block. 95 of 100 truths lie within [`student`]`(L − 1)` standard errors, if the model is right.
//!
//! Source: Künsch, "The jackknife and the bootstrap for general stationary observations", 1989.

use super::friction::{JOINT, JointNumber, JointNumbers};
use super::levenberg;
use super::problem::{BLOCK, Equations, LeastSquares, Problem, dot};
use super::{DETERMINED, Learned, Start};
use crate::torque::linear::BaseParameters;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};
use leastaction_models::tree::INERTIAL;
use std::ops::Range;

/// Blocks of time that are left out in turn.
const BLOCKS: usize = 32;
/// A number is free where directions that are not shown have this part of it.
const FREE: f64 = 1e-4;

/// Where the slope of the torques in a number is less than this part of the largest, it is rounding: torques do not depend on the number.
const ROUNDING: f64 = 1e-10;

/// How well samples show a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shown {
    /// Its standard error.
    Within(f64),
    /// It may move with others without any residual.
    Together,
    /// It ended where its range ends.
    AtBound,
}

/// A number by the samples alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// By least squares; it means nothing where the number is not shown.
    pub value: f64,
    /// How well it is known.
    pub shown: Shown,
    /// The estimate, of [`Alone::estimates`], that its error hangs together with most, and their correlation.
    pub strongest: Option<(usize, f64)>,
}

/// All that samples say by themselves.
#[derive(Clone, Debug)]
pub struct Alone {
    /// The base parameters among the numbers that are learned.
    pub base: BaseParameters,
    /// Which numbers of which joints follow them.
    pub joints: Vec<(usize, JointNumber)>,
    /// Of the base parameters, then of the joints' numbers.
    pub estimates: Vec<Estimate>,
    /// Directions in the space of these numbers that the samples do not show.
    pub hidden: usize,
    /// Blocks of time whose residuals were taken to be independent.
    pub blocks: usize,
}

/// The 97.5th percentile of Student's distribution with so many degrees of freedom, by the expansion of Fisher and Cornish (within 0.3% from
/// four on): by how many standard errors a number is off at most in 95 of 100 cases.
#[must_use]
pub fn student(free: usize) -> f64 {
    /// The 97.5th percentile of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    let (z, free) = (NORMAL, free.max(1) as f64);
    let powers = [z.powi(3) + z, 5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z];
    let third = 3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z;
    z + powers[0] / (4.0 * free) + powers[1] / (96.0 * free.powi(2)) + third / (384.0 * free.powi(3))
}

impl Alone {
    /// By how many standard errors a number is off at most in 95 of 100 cases.
    #[must_use]
    pub fn interval(&self) -> f64 {
        student(self.blocks.saturating_sub(1))
    }

    /// What an arm has for each of the estimated numbers: bodies and rotors by their parameters, as [`leastaction_models::tree::Tree::parameters`], and joints.
    #[must_use]
    pub fn of_model(&self, parameters: &[f64], joints: &[JointNumbers]) -> Vec<f64> {
        let own = self.joints.iter().map(|(joint, number)| joints[*joint].array()[*number as usize]);
        self.base.values(parameters).into_iter().chain(own).collect()
    }
}

/// Torques in base parameters β and the joints' numbers, of which the rotors are among β.
struct Torques<'a> {
    problem: &'a Problem<'a>,
    /// Columns of β among all parameters.
    columns: &'a [usize],
    /// What the known parameters add to the torque of the bodies, row by row.
    known: Vec<f64>,
}

impl Torques<'_> {
    fn joints(&self, x: &[f64]) -> Vec<JointNumbers> {
        let (joints, _) = x[self.columns.len()..].as_chunks();
        joints.iter().map(|numbers| JointNumbers::of_array(*numbers)).collect()
    }

    /// The regressor of one row in β.
    fn regressor(&self, row: usize) -> Vec<f64> {
        let (i, _, a, _) = self.problem.row(row);
        let own = &self.problem.regressors[row];
        let of = |column: &usize| match own.get(*column) {
            Some(x) => *x,
            None if *column == own.len() + i => a,
            None => 0.0,
        };
        self.columns.iter().map(of).collect()
    }

    /// Normal equations of some rows.
    fn equations_of(&self, x: &[f64], rows: Range<usize>) -> Equations {
        let (count, joints, mut all) = (self.columns.len(), self.joints(x), Equations::zero(x.len()));
        let end = rows.end;
        for first in rows.step_by(BLOCK) {
            let rows = first..(first + BLOCK).min(end);
            let mut jacobian = Mat::zeros(rows.len(), x.len());
            let mut residuals = Vec::with_capacity(rows.len());
            for (at, k) in rows.enumerate() {
                let (i, v, _, tau) = self.problem.row(k);
                let (row, scale) = (self.regressor(k), self.problem.scales[i]);
                let (predicted, gain, own) = joints[i].slopes(self.known[k] + dot(&row, x), v, 0.0);
                row.iter().enumerate().for_each(|(j, y)| jacobian[(at, j)] = gain * y / scale);
                let joint = count + JOINT * i;
                own.iter().enumerate().for_each(|(j, slope)| jacobian[(at, joint + j)] = slope / scale);
                residuals.push((predicted - tau) / scale);
            }
            all.add(&jacobian, &residuals);
        }
        all
    }
}

impl LeastSquares for Torques<'_> {
    fn squares(&self, x: &[f64]) -> f64 {
        let joints = self.joints(x);
        let torque = |k: usize| {
            let (i, v, ..) = self.problem.row(k);
            joints[i].torque(self.known[k] + dot(&self.regressor(k), x), v, 0.0)
        };
        self.problem.squares_of(&(0..self.known.len()).map(torque).collect::<Vec<_>>())
    }

    fn equations(&self, x: &[f64]) -> Equations {
        self.equations_of(x, 0..self.known.len())
    }
}

/// See [`super::alone`].
pub(super) fn alone(start: &Start, learned: &Learned) -> Alone {
    let Start { tree, problem, x, bounds, linear } = start;
    let bodies = problem.body_numbers();
    let is_learned = |column: &usize| match column.checked_sub(bodies) {
        Some(_) => learned.rotors,
        None => bounds[*column][0] < bounds[*column][1] && !learned.known.contains(&(column / INERTIAL)),
    };
    let (chosen, known): (Vec<usize>, Vec<usize>) = (0..tree.parameter_count()).partition(is_learned);
    let base = BaseParameters::among(tree, &chosen);
    let torques = Torques { problem, columns: &base.independent, known: of_known(start, &known) };
    let mut y = base.values(linear);
    y.extend(&x[bodies..]);
    let all = f64::INFINITY;
    let mut ranges = vec![[-all, all]; base.count()];
    ranges.extend(&bounds[bodies..]);
    for rotor in (0..problem.n()).map(|joint| base.count() + JOINT * joint) {
        (y[rotor], ranges[rotor]) = (0.0, [0.0; 2]);
    }
    let y = levenberg::minimise(&torques, y, &ranges);
    let is_fixed = |k: &usize| ranges[*k][0] == ranges[*k][1];
    let numbers: Vec<usize> = (0..y.len()).filter(|k| !is_fixed(k)).collect();
    let is_at_bound = |k: &usize| y[*k] <= ranges[*k][0] || y[*k] >= ranges[*k][1];
    let inner: Vec<usize> = numbers.iter().copied().filter(|k| !is_at_bound(k)).collect();
    let samples = problem.samples.count();
    let size = samples.div_ceil(BLOCKS).max(1) * problem.n();
    let rows = torques.known.len();
    let parts =
        (0..rows).step_by(size).map(|first| torques.equations_of(&y, first..(first + size).min(rows)));
    let parts: Vec<Equations> = parts.collect();
    let spread = Spread::of(&parts, &inner);
    let place = |k: usize| numbers.iter().position(|number| *number == k);
    let estimate = |k: &usize| {
        let Some(own) = inner.iter().position(|inner| inner == k) else {
            return Estimate { value: y[*k], shown: Shown::AtBound, strongest: None };
        };
        let strongest = spread.strongest(own).and_then(|(other, part)| Some((place(inner[other])?, part)));
        Estimate { value: y[*k], shown: spread.shown(own), strongest }
    };
    let joint = |k: &usize| {
        let k = k.checked_sub(base.count())?;
        Some((k / JOINT, JointNumber::ALL[k % JOINT]))
    };
    let joints = numbers.iter().filter_map(joint).collect();
    let estimates = numbers.iter().map(estimate).collect();
    Alone { joints, estimates, hidden: spread.hidden, blocks: parts.len(), base }
}

/// What the known parameters add to the torque of the bodies, row by row.
fn of_known(start: &Start, known: &[usize]) -> Vec<f64> {
    let torques = Torques { problem: &start.problem, columns: known, known: Vec::new() };
    let parameters = start.tree.parameters();
    let numbers: Vec<f64> = known.iter().map(|k| parameters[*k]).collect();
    (0..start.problem.regressors.len()).map(|row| dot(&torques.regressor(row), &numbers)).collect()
}

/// Covariances of numbers, each divided by the root of its diagonal entry in H.
struct Spread {
    /// 1/√H_ii, 0 for a number that nothing depends on but by rounding.
    sizes: Vec<f64>,
    /// In the directions that are shown.
    covariance: Mat<f64>,
    /// How much of every number is in directions that are not shown.
    free: Vec<f64>,
    hidden: usize,
}

impl Spread {
    fn of(parts: &[Equations], numbers: &[usize]) -> Self {
        let p = numbers.len();
        let sum = |i: usize, j: usize| parts.iter().map(|of| of.gram[(numbers[i], numbers[j])]).sum::<f64>();
        let squares: Vec<f64> = (0..p).map(|i| sum(i, i)).collect();
        let rounding = ROUNDING * ROUNDING * squares.iter().copied().fold(0.0, f64::max);
        let size = |x: f64| if x > rounding { x.sqrt().recip() } else { 0.0 };
        let sizes: Vec<f64> = squares.into_iter().map(size).collect();
        let scaled = Mat::from_fn(p, p, |i, j| sizes[i] * sizes[j] * sum(i, j));
        let basis = shown_directions(&scaled);
        let free = (0..p).map(|i| 1.0 - basis.row(i).iter().map(|x| x * x).sum::<f64>()).collect();
        let inverse = |of: &Mat<f64>| {
            let within = basis.transpose() * of * &basis;
            within.llt(Side::Lower).ok().map(|factor| &basis * factor.inverse() * basis.transpose())
        };
        let whole = inverse(&scaled).unwrap_or_else(|| Mat::zeros(p, p));
        let mut covariance = Mat::zeros(p, p);
        for part in parts {
            let rest = Mat::from_fn(p, p, |i, j| {
                scaled[(i, j)] - sizes[i] * sizes[j] * part.gram[(numbers[i], numbers[j])]
            });
            let gradient = Mat::from_fn(p, 1, |i, _| sizes[i] * part.gradient[numbers[i]]);
            // Where one block alone shows something, the others say nothing of it without it.
            let moved = inverse(&rest).as_ref().unwrap_or(&whole) * gradient;
            covariance += &moved * moved.transpose();
        }
        let count = parts.len() as f64;
        covariance *= faer::Scale((count - 1.0) / count);
        Self { sizes, covariance, free, hidden: p - basis.ncols() }
    }

    fn shown(&self, i: usize) -> Shown {
        if self.free[i] > FREE || self.sizes[i] == 0.0 {
            return Shown::Together;
        }
        Shown::Within(self.sizes[i] * self.covariance[(i, i)].sqrt())
    }

    fn strongest(&self, i: usize) -> Option<(usize, f64)> {
        let correlation = |j: usize| {
            let both = self.covariance[(i, i)] * self.covariance[(j, j)];
            (j, self.covariance[(i, j)] / both.sqrt())
        };
        let others = (0..self.sizes.len()).filter(|j| *j != i && self.free[*j] <= FREE).map(correlation);
        let known = others.filter(|(_, part)| part.is_finite() && self.free[i] <= FREE);
        known.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

/// Directions whose singular values count, as columns.
fn shown_directions(scaled: &Mat<f64>) -> Mat<f64> {
    let p = scaled.nrows();
    let Ok(eigen) = scaled.self_adjoint_eigen(Side::Lower) else { return Mat::zeros(p, 0) };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let largest = values.iter().copied().fold(0.0, f64::max);
    let shown: Vec<usize> = (0..p).filter(|k| values[*k] > DETERMINED * DETERMINED * largest).collect();
    Mat::from_fn(p, shown.len(), |i, k| vectors[(i, shown[k])])
}
