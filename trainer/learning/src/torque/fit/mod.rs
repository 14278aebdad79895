//! Fits of bodies, rotors and friction to torques, near a prior.
//!
//! The objective is Σ ((τ̂ − τ)/s_i)² + λ Σ |θ|². Here s_i is a robust scale of coordinate i's residuals after linear
//! least squares, and θ are the [log-Cholesky parameters](leastaction_models::tree::LogCholesky) of every body relative
//! to the same body of the tree. The tree is the prior: whatever the log does not determine stays there.

mod alone;
mod friction;
mod learned;
mod problem;

pub use crate::training::{Shown, student};
pub use alone::{Alone, Estimate};
pub use friction::{JOINT, JointNumber, JointNumbers, SOFTNESS};
pub use learned::{Bodies, Learned};

use crate::matrix::singular;
use crate::torque::Samples;
use crate::torque::linear::{Design, Terms};
use crate::training::{Levenberg, normal_equations_of};
use leastaction_models::tree::{INERTIAL, Tree};
use nalgebra::DMatrix;
use problem::{Problem, Squares, Torques, carried, charts, joints, regressors};
use std::panic::resume_unwind;
use thiserror::Error;

/// An arm that predicts torques.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Bodies and rotors.
    pub tree: Tree,
    /// Numbers of every coordinate; the rotors equal those of the tree.
    pub joints: Vec<JointNumbers>,
}

/// Initial width, rad/s.
const FIRST_WIDTH: f64 = 0.05;
/// The reason why a fit is impossible.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FitError {
    /// A body of the tree cannot serve as a prior.
    #[error(
        "link {0}: its inertia is of no body that can be (the pseudo-inertia is not positive definite), so it cannot be a prior"
    )]
    Prior(String),
    /// The samples belong to another mechanism.
    #[error("samples of {found} coordinates, and an arm of {expected}")]
    Coordinates {
        /// Coordinates of the samples.
        found: usize,
        /// Coordinates of the tree.
        expected: usize,
    },
    /// There are too few samples, or numbers are not finite.
    #[error("the samples determine nothing: {0} of them")]
    Samples(usize),
}

/// A fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The arm.
    pub arm: Arm,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Number of parameters that the samples alone determine, without the prior: the number of singular values above
    /// 10⁻⁶ of the largest.
    pub rank: usize,
    /// Strength λ of the prior.
    pub prior: f64,
}

/// Relative threshold on the singular values of the weighted Jacobian (columns scaled) below which a direction is not determined.
const DETERMINED: f64 = 1e-6;

/// Fits an arm to samples; `tree` is the prior, `prior` its strength λ.
///
/// # Errors
/// [`FitError`].
pub fn fit(tree: &Tree, samples: &Samples, learned: &Learned, prior: f64) -> Result<Fitted, FitError> {
    let start = Start::new(tree, samples, learned)?;
    // The path starts at a strong prior: far from the minimum, a fit with a weak prior can end in a poor local minimum.
    let strengths: Vec<f64> = [1e4, 1e2, 1.0].into_iter().filter(|s| *s > prior).chain([prior]).collect();
    let path = start.path(&strengths);
    Ok(start.fitted(path.last().unwrap_or(&start.x), prior))
}

/// Fits an arm to samples with the prior strength that cross-validation chooses from `strengths`, which are in
/// descending order. `folds` gives the fold of each sample, in blocks of time because neighbouring samples are alike;
/// each fold is predicted by a fit to the other folds. The error is the mean over coordinates of the mean squared error
/// divided by the variance of τ. The strongest prior is chosen whose error exceeds the smallest error by at most one
/// standard error of the difference over the folds. Also returns all strengths with their errors.
///
/// # Errors
/// [`FitError`].
pub fn fit_by_folds(
    tree: &Tree,
    samples: &Samples,
    learned: &Learned,
    (strengths, folds): (&[f64], &[usize]),
) -> Result<(Fitted, Vec<(f64, f64)>), FitError> {
    let count = folds.iter().max().map_or(0, |last| last + 1);
    let variances = variances(samples);
    let of_fold = &|fold: usize| -> Result<Option<Vec<f64>>, FitError> {
        let [rest, held] = [false, true].map(|is_held| samples.selected(|k| (folds[k] == fold) == is_held));
        if held.count() == 0 || rest.count() == 0 {
            return Ok(None);
        }
        let start = Start::new(tree, &rest, learned)?;
        let judge =
            |x: &Vec<f64>| mean_nmse(&squared_errors(&start.arm(x).torques(&held), &held), &variances);
        Ok(Some(start.path(strengths).iter().map(judge).collect()))
    };
    // Errors by fold and strength; folds are independent of each other.
    let errors: Vec<Vec<f64>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..count).map(|fold| scope.spawn(move || of_fold(fold))).collect();
        let joined =
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        joined.filter_map(Result::transpose).collect::<Result<_, _>>()
    })?;
    let mean = |k: usize| errors.iter().map(|fold| fold[k]).sum::<f64>() / errors.len() as f64;
    let tried: Vec<(f64, f64)> =
        strengths.iter().enumerate().map(|(k, strength)| (*strength, mean(k))).collect();
    let least = (0..tried.len()).min_by(|a, b| tried[*a].1.total_cmp(&tried[*b].1)).unwrap_or(0);
    // The test uses differences from the smallest error, in which the variation common to all strengths cancels.
    let is_as_good = |k: usize| {
        let differences: Vec<f64> = errors.iter().map(|fold| fold[k] - fold[least]).collect();
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        let squares: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
        let folds = differences.len() as f64;
        mean <= (squares / (folds * (folds - 1.0).max(1.0))).sqrt()
    };
    let chosen = (0..least).find(|k| is_as_good(*k)).unwrap_or(least);
    let start = Start::new(tree, samples, learned)?;
    let path = start.path(&strengths[..(chosen + 1).min(strengths.len())]);
    let x = path.last().cloned().unwrap_or_else(|| start.x.clone());
    Ok((start.fitted(&x, strengths.get(chosen).copied().unwrap_or(0.0)), tried))
}

impl Arm {
    /// Predicted torques of all samples, \[samples\]\[n\], row by row.
    #[must_use]
    pub fn torques(&self, samples: &Samples) -> Vec<f64> {
        let mut bodies = self.tree.clone();
        bodies.rotors.fill(0.0);
        let states = samples.q.iter().zip(samples.v.iter().zip(samples.a.iter()));
        let of = |(q, (v, a)): (&[f64], (&[f64], &[f64]))| -> Vec<f64> {
            let forces = bodies.inverse_dynamics(q, v, a);
            let rows = forces.iter().zip(v.iter().zip(a)).zip(&self.joints);
            rows.map(|((force, (v, a)), joint)| joint.torque(*force, *v, *a)).collect()
        };
        states.flat_map(of).collect()
    }
}

/// Mean squared torque error of every coordinate.
#[must_use]
pub fn squared_errors(predicted: &[f64], samples: &Samples) -> Vec<f64> {
    let n = samples.tau.width();
    let mut sums = vec![0.0; n];
    let pairs = predicted.iter().zip(samples.tau.as_flat());
    pairs.enumerate().for_each(|(k, (a, b))| sums[k % n] += (a - b) * (a - b));
    sums.iter().map(|sum| sum / samples.count() as f64).collect()
}

/// Variance of every coordinate's logged torque.
#[must_use]
pub fn variances(samples: &Samples) -> Vec<f64> {
    let (n, count) = (samples.tau.width(), samples.count() as f64);
    let column = |i: usize| samples.tau.as_flat().iter().skip(i).step_by(n);
    let of = |i: usize| {
        let mean = column(i).sum::<f64>() / count;
        column(i).map(|x| (x - mean) * (x - mean)).sum::<f64>() / count
    };
    (0..n).map(of).collect()
}

/// Mean over coordinates of error divided by variance.
#[must_use]
pub fn mean_nmse(errors: &[f64], variances: &[f64]) -> f64 {
    errors.iter().zip(variances).map(|(e, v)| e / v).sum::<f64>() / errors.len() as f64
}

/// Estimates of the base parameters of the learned bodies and rotors, and of the joints' numbers, from the samples
/// alone, without the prior; `tree` supplies the known numbers.
///
/// # Errors
/// [`FitError`].
pub fn alone(tree: &Tree, samples: &Samples, learned: &Learned) -> Result<Alone, FitError> {
    let start = Start::new(tree, samples, learned)?;
    Ok(alone::alone(&start, learned))
}

/// Iteration limit.
const ITERATIONS: usize = 60;
/// Initial damping: torques are nearly linear in the numbers.
const DAMPING: f64 = 1e-3;

/// The minimiser, starting from x.
fn minimum<T: Torques>(squares: &Squares<T>, x: Vec<f64>) -> Vec<f64> {
    Levenberg::new(squares, x).with_damping(DAMPING).run(squares, ITERATIONS, |_, _| ()).weights
}

/// Common part of several fits to the same samples.
struct Start<'a> {
    tree: &'a Tree,
    problem: Problem<'a>,
    x: Vec<f64>,
    bounds: Vec<[f64; 2]>,
    /// Linear least-squares solution: the bodies, then the rotors.
    linear: Vec<f64>,
}

impl<'a> Start<'a> {
    fn new(tree: &'a Tree, samples: &'a Samples, learned: &Learned) -> Result<Self, FitError> {
        let (n, found) = (tree.coordinates(), samples.q.width());
        if n != found {
            return Err(FitError::Coordinates { found, expected: n });
        }
        let width = FIRST_WIDTH.clamp(learned.width[0], learned.width[1]);
        let terms = Terms { rotors: learned.rotors, viscous: true, coulomb: Some(width), offsets: true };
        let design = Design::new(tree, samples, &terms);
        let solution = design.solve().ok_or(FitError::Samples(samples.count()))?;
        let scales = scales(&design.predict(&solution.numbers), samples);
        let charts = charts(tree, learned).map_err(FitError::Prior)?;
        let regressors = regressors(tree, samples);
        let carried = carried(&regressors, n);
        let problem = Problem { samples, regressors, charts, scales, carried };
        let bodies = problem.body_numbers();
        let numbers = &solution.numbers[bodies..];
        let at = |kind: usize, i: usize| numbers[kind * n + i];
        let shift = usize::from(learned.rotors);
        let joint = |i: usize| {
            let rotor = if learned.rotors { at(0, i).max(0.0) } else { 0.0 };
            let (viscous, coulomb) = (at(shift, i).max(0.0), at(shift + 1, i).max(0.0));
            let offset = at(shift + 2, i);
            JointNumbers { rotor, viscous, coulomb, width, offset, ..JointNumbers::default() }.array()
        };
        let x: Vec<f64> = vec![0.0; bodies].into_iter().chain((0..n).flat_map(joint)).collect();
        let body = if learned.bodies == Bodies::Known { 0.0 } else { f64::INFINITY };
        let of_body = |k: usize| if learned.known.contains(&(k / INERTIAL)) { 0.0 } else { body };
        let of_bodies = (0..bodies).map(|k| [-of_body(k), of_body(k)]);
        let bounds: Vec<[f64; 2]> =
            of_bodies.chain((0..n).flat_map(|joint| learned.ranges(joint, width))).collect();
        let rotors = if learned.rotors { &numbers[..n] } else { &tree.rotors[..] };
        let linear = [&solution.numbers[..bodies], rotors].concat();
        let x = x.iter().zip(&bounds).map(|(x, [least, most]): (&f64, &[f64; 2])| x.clamp(*least, *most));
        Ok(Self { tree, problem, x: x.collect(), bounds, linear })
    }

    /// The minimisers for these strengths of the prior, each started from the minimiser for the previous strength.
    fn path(&self, strengths: &[f64]) -> Vec<Vec<f64>> {
        let mut x = self.x.clone();
        let mut minimum = |prior: &f64| {
            x = minimum(&self.squares(*prior), x.clone());
            x.clone()
        };
        strengths.iter().map(&mut minimum).collect()
    }

    /// The objective for a prior of this strength.
    fn squares(&self, prior: f64) -> Squares<'_, Problem<'a>> {
        Squares { torques: &self.problem, prior, limits: &self.bounds }
    }

    fn fitted(&self, x: &[f64], prior: f64) -> Fitted {
        let parameters = self.bounds.iter().filter(|[least, most]| least < most).count();
        Fitted { arm: self.arm(x), parameters, rank: self.rank(x), prior }
    }

    fn arm(&self, x: &[f64]) -> Arm {
        let (bodies, own) = x.split_at(self.problem.body_numbers());
        let joints = joints(own);
        let rotors = joints.iter().map(|joint| joint.rotor);
        let parameters: Vec<f64> = self.problem.inertial(bodies).into_iter().chain(rotors).collect();
        Arm { tree: self.tree.with_parameters(&parameters), joints }
    }

    /// Rank of the Jacobian without the prior, over the learned numbers.
    fn rank(&self, x: &[f64]) -> usize {
        let samples = self.problem.samples.count();
        let Some(equations) = normal_equations_of(&self.squares(0.0), x, 0..samples) else { return 0 };
        let entry = |i: usize, j: usize| equations.entry(i, j);
        let is_learned = |k: &usize| self.bounds[*k][0] < self.bounds[*k][1] && entry(*k, *k) > 0.0;
        let learned: Vec<usize> = (0..x.len()).filter(is_learned).collect();
        let scaled = DMatrix::from_fn(learned.len(), learned.len(), |i, j| {
            let (i, j) = (learned[i], learned[j]);
            entry(i, j) / (entry(i, i) * entry(j, j)).sqrt()
        });
        let values = singular(&scaled).map_or(Vec::new(), |found| found.values);
        let largest = values.first().copied().unwrap_or(0.0);
        values.iter().filter(|value| **value > DETERMINED * DETERMINED * largest).count()
    }
}

/// Least scale of residuals, relative to the standard deviation of the torque: no torque is known better, not even that
/// of a simulation after filtering, and against an exact one the prior would count for nothing.
const EXACT: f64 = 1e-3;

/// Robust scale of every coordinate's residuals: 1.4826 times their median absolute value.
fn scales(predicted: &[f64], samples: &Samples) -> Vec<f64> {
    let (n, variances) = (samples.tau.width(), variances(samples));
    let of = |i: usize| {
        let column = predicted.iter().zip(samples.tau.as_flat()).skip(i).step_by(n);
        let mut sizes: Vec<f64> = column.map(|(a, b)| (a - b).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let least = (EXACT * variances[i].sqrt()).max(1e-9);
        (1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or(1.0)).max(least)
    };
    (0..n).map(of).collect()
}
