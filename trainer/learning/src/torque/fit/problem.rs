//! The least-squares problem of a fit: torque residuals and their derivatives with respect to the numbers of bodies, then of joints.

use super::friction::{JOINT, JointNumbers};
use super::{Bodies, Learned};
use crate::torque::Samples;
use crate::training::{ChunkRows, Failed, NormalEquations, Residuals};
use leastaction_models::tree::{Body, INERTIAL, LogCholesky, Tree};
use std::ops::Range;

/// Map from the learned numbers of a body to its inertial numbers.
#[derive(Clone, Debug)]
pub(super) enum Chart {
    /// Log-Cholesky numbers around the prior.
    Consistent(LogCholesky),
    /// The ten inertial numbers minus the prior's, each in a unit of its own.
    Free([f64; INERTIAL]),
}

/// A fit to these samples.
pub(super) struct Problem<'a> {
    pub samples: &'a Samples,
    /// Regressor Y of the bodies, \[samples · n\]\[10 bodies\], row by row.
    pub regressors: Vec<Vec<f64>>,
    pub charts: Vec<Chart>,
    /// Scale of the torque residuals, by coordinate.
    pub scales: Vec<f64>,
}

/// Torques of the bodies, row by row, as functions of some numbers.
pub(super) trait Torques: Sync {
    /// Values that all rows share, evaluated once for given numbers.
    type At;
    /// The samples.
    fn problem(&self) -> &Problem<'_>;
    /// Number of variables.
    fn count(&self) -> usize;
    /// Evaluates the shared values, either for torques only or also for their derivatives.
    fn at(&self, numbers: &[f64], with_derivatives: bool) -> Self::At;
    /// The torque of a row.
    fn torque(&self, at: &Self::At, row: usize) -> f64;
    /// Writes the derivatives of the torque of a row into `slopes`, which is 0 before.
    fn slopes(&self, at: &Self::At, row: usize, slopes: &mut [f64]);
}

/// The objective Σ ((τ̂ − τ)/s)² + λ Σ θ². θ are the numbers of the bodies; the numbers of the joints follow them.
pub(super) struct Squares<'a, T> {
    pub torques: &'a T,
    /// Strength λ of the prior.
    pub prior: f64,
    pub limits: &'a [[f64; 2]],
}

/// Relative decrease of the sum of squares below which another iteration is not worthwhile.
const WORTH: f64 = 1e-7;

/// Regressor Y of the bodies at all samples.
pub(super) fn regressors(tree: &Tree, samples: &Samples) -> Vec<Vec<f64>> {
    let bodies = INERTIAL * tree.bodies().len();
    let states = samples.q.iter().zip(samples.v.iter().zip(samples.a.iter()));
    let rows = states.flat_map(|(q, (v, a))| tree.regressor(q, v, a));
    rows.map(|mut row| {
        row.truncate(bodies);
        row
    })
    .collect()
}

/// Charts around a tree's own bodies; the error is the name of the first learned body that is not physically
/// consistent. A known one may be a point, or have no mass.
pub(super) fn charts(tree: &Tree, learned: &Learned) -> Result<Vec<Chart>, String> {
    let of = |(k, body): (usize, &Body)| match learned.bodies {
        Bodies::Consistent if !learned.known.contains(&k) => {
            LogCholesky::around(&body.inertia).map(Chart::Consistent).ok_or(body.name.clone())
        }
        _ => Ok(Chart::Free(body.inertia.0)),
    };
    tree.bodies().iter().enumerate().map(of).collect()
}

impl Chart {
    fn numbers(&self, theta: &[f64; INERTIAL]) -> [f64; INERTIAL] {
        match self {
            Self::Consistent(chart) => chart.inertia(theta).0,
            Self::Free(prior) => std::array::from_fn(|k| prior[k] + theta[k]),
        }
    }

    fn slopes(&self, theta: &[f64; INERTIAL]) -> [[f64; INERTIAL]; INERTIAL] {
        match self {
            Self::Consistent(chart) => chart.slopes(theta),
            Self::Free(_) => std::array::from_fn(|k| std::array::from_fn(|j| f64::from(u8::from(j == k)))),
        }
    }
}

impl Problem<'_> {
    pub fn n(&self) -> usize {
        self.scales.len()
    }

    /// Number of variables θ of all bodies.
    pub fn body_numbers(&self) -> usize {
        INERTIAL * self.charts.len()
    }

    /// The inertial numbers of all bodies.
    pub fn inertial(&self, thetas: &[f64]) -> Vec<f64> {
        let (thetas, _) = thetas.as_chunks();
        self.charts.iter().zip(thetas).flat_map(|(chart, theta)| chart.numbers(theta)).collect()
    }

    /// Data of one row: coordinate, v, a, logged torque.
    pub fn row(&self, row: usize) -> (usize, f64, f64, f64) {
        let of = |rows: &leastaction_data::Rows| rows.as_flat()[row];
        (row % self.n(), of(&self.samples.v), of(&self.samples.a), of(&self.samples.tau))
    }
}

/// Joints from their numbers, which are stored joint by joint.
pub(super) fn joints(numbers: &[f64]) -> Vec<JointNumbers> {
    let (joints, _) = numbers.as_chunks();
    joints.iter().map(|numbers| JointNumbers::of_array(*numbers)).collect()
}

/// Torques as functions of the charts' numbers.
impl Torques for Problem<'_> {
    type At = (Vec<f64>, Vec<[[f64; INERTIAL]; INERTIAL]>);

    fn problem(&self) -> &Problem<'_> {
        self
    }

    fn count(&self) -> usize {
        self.body_numbers()
    }

    fn at(&self, numbers: &[f64], with_derivatives: bool) -> Self::At {
        let thetas = if with_derivatives { numbers.as_chunks().0 } else { &[] };
        let charts = self.charts.iter().zip(thetas);
        (self.inertial(numbers), charts.map(|(chart, theta)| chart.slopes(theta)).collect())
    }

    fn torque(&self, (inertial, _): &Self::At, row: usize) -> f64 {
        dot(&self.regressors[row], inertial)
    }

    fn slopes(&self, (_, slopes): &Self::At, row: usize, into: &mut [f64]) {
        let bodies = self.regressors[row].as_chunks::<INERTIAL>().0.iter().zip(slopes);
        for ((row, slopes), into) in bodies.zip(into.as_chunks_mut::<INERTIAL>().0) {
            if row.iter().any(|x| *x != 0.0) {
                *into = slopes.map(|slope| dot(row, &slope));
            }
        }
    }
}

impl<T: Torques> Residuals for Squares<'_, T> {
    fn parameters(&self) -> usize {
        self.limits.len()
    }

    fn samples(&self) -> usize {
        self.torques.problem().samples.count()
    }

    fn components(&self) -> usize {
        self.torques.problem().n()
    }

    fn squares(&self, x: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let (problem, (bodies, own)) = (self.torques.problem(), x.split_at(self.torques.count()));
        let (at, joints, n) = (self.torques.at(bodies, false), joints(own), problem.n());
        let residual = |row: usize| {
            let (i, v, a, tau) = problem.row(row);
            (joints[i].torque(self.torques.torque(&at, row), v, a) - tau) / problem.scales[i]
        };
        let sum: f64 = (n * samples.start..n * samples.end).map(residual).map(|r| r * r).sum();
        let prior = if samples.start == 0 { self.prior * dot(bodies, bodies) } else { 0.0 };
        Ok(sum + prior)
    }

    fn linearise(&self, x: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let (problem, (bodies, own)) = (self.torques.problem(), x.split_at(self.torques.count()));
        let (at, joints, n) = (self.torques.at(bodies, true), joints(own), problem.n());
        rows.reset(n * samples.len(), x.len());
        let mut slopes = vec![0.0; x.len()];
        for (k, row) in (n * samples.start..n * samples.end).enumerate() {
            let (i, v, a, tau) = problem.row(row);
            let (place, scale) = (i * samples.len() + k / n, problem.scales[i]);
            let (predicted, gain, own) = joints[i].slopes(self.torques.torque(&at, row), v, a);
            slopes.fill(0.0);
            let (of_bodies, of_joints) = slopes.split_at_mut(bodies.len());
            self.torques.slopes(&at, row, of_bodies);
            of_bodies.iter_mut().for_each(|slope| *slope *= gain);
            of_joints[JOINT * i..JOINT * (i + 1)].copy_from_slice(&own);
            rows.residual[place] = (predicted - tau) / scale;
            let columns = slopes.iter().enumerate();
            columns.for_each(|(j, slope)| rows.column(j, place..place + 1)[0] = slope / scale);
        }
        Ok(())
    }

    fn add_penalty(&self, x: &[f64], sum: &mut NormalEquations) {
        (0..self.torques.count()).for_each(|k| sum.add_penalty(k, self.prior, x[k]));
    }

    fn is_of_many_units(&self) -> bool {
        true
    }

    fn tolerance(&self) -> f64 {
        WORTH
    }

    fn limits(&self) -> &[[f64; 2]] {
        self.limits
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
