//! Estimates of base parameters and joint numbers from the samples alone, with their standard errors.
//!
//! A prior draws every number towards the description by an amount that depends on the truth, so the coverage of an
//! interval around such a fit is unknown. The estimates here are therefore those of least squares without a prior and
//! without the constraint of physical consistency. They are estimates of the combinations on which torques depend at
//! all ([`BaseParameters`]) and of the joints' numbers.
//!
//! The residuals of filtered samples are correlated over the filter's memory, and over longer times because of effects
//! that the model lacks; the residuals of different joints share the noise of the accelerations. The covariance is
//! therefore estimated by the jackknife over blocks of time, (L − 1)/L Σ_l δ_l δ_lᵀ, where δ_l = (H − H_l)⁻¹ g_l is the
//! change of the estimate if block l is left out. H = JᵀJ, and H_l and g_l = J_lᵀr_l are the parts of block l. If the
//! model is right, 95 % of the true values lie within [`student`]`(L − 1)` standard errors.
//!
//! Source: Künsch, "The jackknife and the bootstrap for general stationary observations", 1989.

use super::friction::{JOINT, JointNumber, JointNumbers};
use super::problem::{Problem, Squares, Torques};
use super::{DETERMINED, Learned, Start, minimum};
use crate::torque::linear::BaseParameters;
use crate::training::{Directions, NormalEquations, Shown, normal_equations_of, student};
use leastaction_models::tree::INERTIAL;
use nalgebra::DMatrix;

/// Number of blocks of time, each left out in turn.
const BLOCKS: usize = 32;
/// Relative threshold for the derivatives of the torques with respect to a number. If they are below this fraction of
/// the largest derivative, they are rounding errors, and torques do not depend on the number.
const ROUNDING: f64 = 1e-10;

/// An estimate from the samples alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Least-squares value; meaningless if the samples do not determine the number.
    pub value: f64,
    /// Standard error, or the reason why there is none.
    pub shown: Shown,
    /// Index in [`Alone::estimates`] of the estimate with the strongest error correlation, and this correlation.
    pub strongest: Option<(usize, f64)>,
}

/// Everything that the samples alone show.
#[derive(Clone, Debug)]
pub struct Alone {
    /// Base parameters of the learned parameters.
    pub base: BaseParameters,
    /// Joint numbers, whose estimates follow those of the base parameters: the joint, and which of its numbers.
    pub joints: Vec<(usize, JointNumber)>,
    /// Estimates of the base parameters, then of the joint numbers.
    pub estimates: Vec<Estimate>,
    /// Number of directions in the space of these numbers that the samples do not show.
    pub hidden: usize,
    /// Number of blocks of time, whose residuals are taken as independent.
    pub blocks: usize,
}

impl Alone {
    /// Half-width of the 95 % confidence interval, in standard errors.
    #[must_use]
    pub fn interval(&self) -> f64 {
        student(self.blocks.saturating_sub(1))
    }

    /// Values that an arm has for the estimated numbers, from the parameters of bodies and rotors, in the order of
    /// [`leastaction_models::tree::Tree::parameters`], and the joints.
    #[must_use]
    pub fn of_model(&self, parameters: &[f64], joints: &[JointNumbers]) -> Vec<f64> {
        let own = self.joints.iter().map(|(joint, number)| joints[*joint].array()[*number as usize]);
        self.base.values(parameters).into_iter().chain(own).collect()
    }
}

/// Torques as functions of the base parameters β. These include the rotors, so the rotors of the joints are 0.
struct OfBase<'a> {
    problem: &'a Problem<'a>,
    /// Columns of β among all parameters.
    columns: &'a [usize],
    /// Contribution of the known parameters to the torque of the bodies, row by row.
    known: Vec<f64>,
}

impl OfBase<'_> {
    /// The regressor of one row with respect to β.
    fn regressor(&self, row: usize) -> impl Iterator<Item = f64> {
        let (i, _, a, _) = self.problem.row(row);
        let own = &self.problem.regressors[row];
        let of = move |column: &usize| match own.get(*column) {
            Some(x) => *x,
            None if *column == own.len() + i => a,
            None => 0.0,
        };
        self.columns.iter().map(of)
    }

    /// The torque that these parameters give.
    fn taken(&self, parameters: &[f64], row: usize) -> f64 {
        self.regressor(row).zip(parameters).map(|(own, x)| own * x).sum()
    }
}

impl Torques for OfBase<'_> {
    type At = Vec<f64>;

    fn problem(&self) -> &Problem<'_> {
        self.problem
    }

    fn count(&self) -> usize {
        self.columns.len()
    }

    fn of_joint(&self, joint: usize) -> Vec<usize> {
        let (carried, bodies) = (&self.problem.carried[joint], self.problem.body_numbers());
        let is_read = |column: usize| {
            if column < bodies { carried.contains(&(column / INERTIAL)) } else { column == bodies + joint }
        };
        (0..self.columns.len()).filter(|k| is_read(self.columns[*k])).collect()
    }

    fn at(&self, numbers: &[f64], _: bool) -> Self::At {
        numbers.to_vec()
    }

    fn torque(&self, at: &Self::At, row: usize) -> f64 {
        self.known[row] + self.taken(at, row)
    }

    fn slopes(&self, _: &Self::At, row: usize, slopes: &mut [f64]) {
        slopes.iter_mut().zip(self.regressor(row)).for_each(|(slope, own)| *slope = own);
    }
}

/// Estimates from the samples alone; see [`super::alone`].
pub(super) fn alone(start: &Start, learned: &Learned) -> Alone {
    let Start { tree, problem, x, bounds, linear } = start;
    let bodies = problem.body_numbers();
    let is_learned = |column: &usize| match column.checked_sub(bodies) {
        Some(_) => learned.rotors,
        None => bounds[*column][0] < bounds[*column][1] && !learned.known.contains(&(column / INERTIAL)),
    };
    let (chosen, known): (Vec<usize>, Vec<usize>) = (0..tree.parameter_count()).partition(is_learned);
    let base = BaseParameters::among(tree, &chosen);
    let torques = OfBase { problem, columns: &base.independent, known: of_known(start, &known) };
    let mut y = base.values(linear);
    y.extend(&x[bodies..]);
    let all = f64::INFINITY;
    let mut ranges = vec![[-all, all]; base.count()];
    ranges.extend(&bounds[bodies..]);
    for rotor in (0..problem.n()).map(|joint| base.count() + JOINT * joint) {
        (y[rotor], ranges[rotor]) = (0.0, [0.0; 2]);
    }
    let squares = Squares { torques: &torques, prior: 0.0, limits: &ranges };
    let y = minimum(&squares, y);
    let is_fixed = |k: &usize| ranges[*k][0] == ranges[*k][1];
    let numbers: Vec<usize> = (0..y.len()).filter(|k| !is_fixed(k)).collect();
    let is_at_bound = |k: &usize| y[*k] <= ranges[*k][0] || y[*k] >= ranges[*k][1];
    let inner: Vec<usize> = numbers.iter().copied().filter(|k| !is_at_bound(k)).collect();
    let samples = problem.samples.count();
    let size = samples.div_ceil(BLOCKS).max(1);
    let blocks = (0..samples).step_by(size).map(|first| first..(first + size).min(samples));
    let parts: Vec<NormalEquations> =
        blocks.filter_map(|block| normal_equations_of(&squares, &y, block)).collect();
    let spread = Spread::of(&parts, &inner);
    let place = |k: usize| numbers.iter().position(|number| *number == k);
    let estimate = |k: &usize| {
        let Some(own) = inner.iter().position(|inner| inner == k) else {
            return Estimate { value: y[*k], shown: Shown::AtBound, strongest: None };
        };
        let strongest = spread
            .directions
            .strongest(&spread.covariance, own, |_| true)
            .and_then(|(other, part)| Some((place(inner[other])?, part)));
        Estimate { value: y[*k], shown: spread.shown(own), strongest }
    };
    let joint = |k: &usize| {
        let k = k.checked_sub(base.count())?;
        Some((k / JOINT, JointNumber::ALL[k % JOINT]))
    };
    let joints = numbers.iter().filter_map(joint).collect();
    let estimates = numbers.iter().map(estimate).collect();
    Alone { joints, estimates, hidden: spread.directions.hidden(), blocks: parts.len(), base }
}

/// Contribution of the known parameters to the torque of the bodies, row by row.
fn of_known(start: &Start, known: &[usize]) -> Vec<f64> {
    let torques = OfBase { problem: &start.problem, columns: known, known: Vec::new() };
    let parameters = start.tree.parameters();
    let numbers: Vec<f64> = known.iter().map(|k| parameters[*k]).collect();
    (0..start.problem.regressors.len()).map(|row| torques.taken(&numbers, row)).collect()
}

/// Covariance of numbers in scaled units: each number divided by the root of its diagonal entry in H.
struct Spread {
    /// Scales 1/√H_ii; 0 for a number on which torques do not depend, except by rounding.
    sizes: Vec<f64>,
    directions: Directions,
    /// Covariance within the shown directions.
    covariance: DMatrix<f64>,
}

impl Spread {
    fn of(parts: &[NormalEquations], numbers: &[usize]) -> Self {
        let p = numbers.len();
        let entry = |of: &NormalEquations, i: usize, j: usize| of.entry(numbers[i], numbers[j]);
        let sum = |i: usize, j: usize| parts.iter().map(|of| entry(of, i, j)).sum::<f64>();
        let squares: Vec<f64> = (0..p).map(|i| sum(i, i)).collect();
        let rounding = ROUNDING * ROUNDING * squares.iter().copied().fold(0.0, f64::max);
        let size = |x: f64| if x > rounding { x.sqrt().recip() } else { 0.0 };
        let sizes: Vec<f64> = squares.into_iter().map(size).collect();
        let scaled = DMatrix::from_fn(p, p, |i, j| sizes[i] * sizes[j] * sum(i, j));
        let directions = Directions::of(&scaled, |largest| DETERMINED * DETERMINED * largest);
        let whole = directions.inverse(&scaled).unwrap_or_else(|| DMatrix::zeros(p, p));
        let mut covariance = DMatrix::zeros(p, p);
        for part in parts {
            let rest =
                DMatrix::from_fn(p, p, |i, j| scaled[(i, j)] - sizes[i] * sizes[j] * entry(part, i, j));
            let gradient = DMatrix::from_fn(p, 1, |i, _| sizes[i] * part.gradient[numbers[i]]);
            let moved = directions.moved(&rest, &gradient, &whole);
            covariance += &moved * moved.transpose();
        }
        let count = parts.len() as f64;
        covariance *= (count - 1.0) / count;
        Self { sizes, directions, covariance }
    }

    fn shown(&self, i: usize) -> Shown {
        if !self.directions.shows(i) || self.sizes[i] == 0.0 {
            return Shown::Together;
        }
        Shown::Within(self.sizes[i] * self.covariance[(i, i)].sqrt())
    }
}
