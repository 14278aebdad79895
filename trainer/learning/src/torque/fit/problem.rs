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
    /// Bodies that every joint carries, on which its torque depends.
    pub carried: Vec<Vec<usize>>,
}

/// Torques of the bodies, row by row, as functions of some numbers.
pub(super) trait Torques: Sync {
    /// Values that all rows share, evaluated once for given numbers.
    type At;
    /// The samples.
    fn problem(&self) -> &Problem<'_>;
    /// Number of variables.
    fn count(&self) -> usize;
    /// Variables on which the torque of a joint depends, in ascending order.
    fn of_joint(&self, joint: usize) -> Vec<usize>;
    /// Evaluates the shared values, either for torques only or also for their derivatives.
    fn at(&self, numbers: &[f64], with_derivatives: bool) -> Self::At;
    /// The torque of a row.
    fn torque(&self, at: &Self::At, row: usize) -> f64;
    /// Writes the derivatives of the torque of a row with respect to the variables on which it depends.
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

/// Bodies that every joint carries: those whose numbers appear in its rows of the regressor.
pub(super) fn carried(regressors: &[Vec<f64>], n: usize) -> Vec<Vec<usize>> {
    let bodies = regressors.first().map_or(0, |row| row.len() / INERTIAL);
    let is_read = |row: &[f64], body: usize| row[INERTIAL * body..][..INERTIAL].iter().any(|x| *x != 0.0);
    let by =
        |joint: usize, body: usize| regressors.iter().skip(joint).step_by(n).any(|row| is_read(row, body));
    (0..n).map(|joint| (0..bodies).filter(|body| by(joint, *body)).collect()).collect()
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

    fn of_joint(&self, joint: usize) -> Vec<usize> {
        self.carried[joint].iter().flat_map(|body| INERTIAL * body..INERTIAL * (body + 1)).collect()
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
        let (regressor, into) =
            (self.regressors[row].as_chunks::<INERTIAL>().0, into.as_chunks_mut::<INERTIAL>().0);
        for body in &self.carried[row % self.n()] {
            into[*body] = slopes[*body].map(|slope| dot(&regressor[*body], &slope));
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

    /// The rows of one joint after the other: most numbers belong to bodies that a joint does not carry, and to other joints.
    fn linearise(
        &self,
        x: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let (problem, (bodies, own)) = (self.torques.problem(), x.split_at(self.torques.count()));
        let (at, joints, n) = (self.torques.at(bodies, true), joints(own), problem.n());
        let mut slopes = vec![0.0; bodies.len()];
        for (i, joint) in joints.iter().enumerate() {
            let (of_bodies, first) = (self.torques.of_joint(i), bodies.len() + JOINT * i);
            rows.reset_to(samples.len(), of_bodies.iter().copied().chain(first..first + JOINT));
            for (place, k) in samples.clone().enumerate() {
                let (_, v, a, tau) = problem.row(n * k + i);
                let (predicted, gain, own) = joint.slopes(self.torques.torque(&at, n * k + i), v, a);
                self.torques.slopes(&at, n * k + i, &mut slopes);
                rows.residual[place] = (predicted - tau) / problem.scales[i];
                let of_bodies = of_bodies.iter().map(|body| gain * slopes[*body]);
                for (column, slope) in of_bodies.chain(own).enumerate() {
                    rows.column(column, place..place + 1)[0] = slope / problem.scales[i];
                }
            }
            add(rows);
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
