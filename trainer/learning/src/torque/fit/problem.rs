//! The least-squares problem of a fit: residuals of torques and their derivatives, in numbers without bounds on the bodies.

use super::Bodies;
use super::friction::{JOINT, JointNumbers};
use crate::torque::Samples;
use faer::Mat;
use leastaction_models::tree::{INERTIAL, LogCholesky, Tree};

/// How the numbers of a body come from what is learned.
#[derive(Clone, Debug)]
pub(super) enum Chart {
    /// Log-Cholesky numbers around the prior.
    Consistent(LogCholesky),
    /// The ten numbers themselves, less the prior's, each over a unit of its own.
    Free([f64; INERTIAL]),
}

/// A fit of these samples.
pub(super) struct Problem<'a> {
    pub samples: &'a Samples,
    /// Y of the bodies, \[samples · n\]\[10 bodies\], row by row.
    pub regressors: Vec<Vec<f64>>,
    pub charts: Vec<Chart>,
    /// Of a torque's residual, by coordinate.
    pub scales: Vec<f64>,
}

/// JᵀJ and Jᵀr.
pub(super) struct Equations {
    pub gram: Mat<f64>,
    pub gradient: Vec<f64>,
}

/// Rows of J at a time.
pub(super) const BLOCK: usize = 1024;

/// Y of the bodies at all samples.
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

/// Charts around a tree's own bodies; the first body that cannot be, by name.
pub(super) fn charts(tree: &Tree, bodies: Bodies) -> Result<Vec<Chart>, String> {
    let of = |body: &leastaction_models::tree::Body| match bodies {
        Bodies::Consistent => {
            LogCholesky::around(&body.inertia).map(Chart::Consistent).ok_or(body.name.clone())
        }
        Bodies::Free | Bodies::Known => Ok(Chart::Free(body.inertia.0)),
    };
    tree.bodies().iter().map(of).collect()
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

    /// Numbers θ of all bodies.
    pub fn body_numbers(&self) -> usize {
        INERTIAL * self.charts.len()
    }

    /// The inertial numbers of all bodies.
    pub fn inertial(&self, x: &[f64]) -> Vec<f64> {
        let (thetas, _) = x[..self.body_numbers()].as_chunks();
        self.charts.iter().zip(thetas).flat_map(|(chart, theta)| chart.numbers(theta)).collect()
    }

    /// The numbers of the joints.
    pub fn joints(&self, x: &[f64]) -> Vec<JointNumbers> {
        let (joints, _) = x[self.body_numbers()..].as_chunks();
        joints.iter().map(|numbers| JointNumbers::of_array(*numbers)).collect()
    }

    /// What drives one row: coordinate, v, a, logged torque.
    pub fn row(&self, row: usize) -> (usize, f64, f64, f64) {
        let of = |rows: &leastaction_data::Rows| rows.as_flat()[row];
        (row % self.n(), of(&self.samples.v), of(&self.samples.a), of(&self.samples.tau))
    }

    /// Predicted torques, row by row.
    pub fn predict(&self, x: &[f64]) -> Vec<f64> {
        let (inertial, joints) = (self.inertial(x), self.joints(x));
        let predict = |(k, row): (usize, &Vec<f64>)| {
            let (i, v, a, _) = self.row(k);
            joints[i].torque(dot(row, &inertial), v, a)
        };
        self.regressors.iter().enumerate().map(predict).collect()
    }

    /// The sum of squares that is minimised, with a prior of this strength λ.
    pub fn squares(&self, x: &[f64], prior: f64) -> f64 {
        self.squares_of(&self.predict(x))
            + prior * x[..self.body_numbers()].iter().map(|x| x * x).sum::<f64>()
    }

    /// The sum of squares of the residuals of these torques.
    pub fn squares_of(&self, predicted: &[f64]) -> f64 {
        let residual =
            |(k, predicted): (usize, &f64)| (predicted - self.row(k).3) / self.scales[k % self.n()];
        predicted.iter().enumerate().map(residual).map(|r| r * r).sum()
    }

    /// Normal equations at x with a prior of this strength λ.
    pub fn equations(&self, x: &[f64], prior: f64) -> Equations {
        let p = x.len();
        let mut all = Equations::zero(p);
        let (inertial, joints) = (self.inertial(x), self.joints(x));
        let (thetas, _) = x[..self.body_numbers()].as_chunks();
        let slopes: Vec<_> =
            self.charts.iter().zip(thetas).map(|(chart, theta)| chart.slopes(theta)).collect();
        for first in (0..self.regressors.len()).step_by(BLOCK) {
            let rows = first..(first + BLOCK).min(self.regressors.len());
            let mut jacobian = Mat::zeros(rows.len(), p);
            let mut residuals = Vec::with_capacity(rows.len());
            for (at, k) in rows.enumerate() {
                let (i, v, a, tau) = self.row(k);
                let (predicted, gain, own) = joints[i].slopes(dot(&self.regressors[k], &inertial), v, a);
                let (gain, scale) = (gain / self.scales[i], self.scales[i]);
                for (body, (row, slopes)) in
                    self.regressors[k].as_chunks::<INERTIAL>().0.iter().zip(&slopes).enumerate()
                {
                    if row.iter().all(|x| *x == 0.0) {
                        continue;
                    }
                    for (number, slope) in slopes.iter().enumerate() {
                        jacobian[(at, INERTIAL * body + number)] = gain * dot(row, slope);
                    }
                }
                let joint = self.body_numbers() + JOINT * i;
                own.iter()
                    .enumerate()
                    .for_each(|(number, slope)| jacobian[(at, joint + number)] = slope / scale);
                residuals.push((predicted - tau) / scale);
            }
            all.add(&jacobian, &residuals);
        }
        for (k, x) in x[..self.body_numbers()].iter().enumerate() {
            all.gram[(k, k)] += prior;
            all.gradient[k] += prior * x;
        }
        all
    }
}

/// Sums of squares with their normal equations.
pub(super) trait LeastSquares {
    /// What is minimised.
    fn squares(&self, x: &[f64]) -> f64;
    /// Its normal equations.
    fn equations(&self, x: &[f64]) -> Equations;
}

/// A problem with a prior of this strength λ.
pub(super) struct Near<'a, 'b>(pub &'a Problem<'b>, pub f64);

impl LeastSquares for Near<'_, '_> {
    fn squares(&self, x: &[f64]) -> f64 {
        self.0.squares(x, self.1)
    }

    fn equations(&self, x: &[f64]) -> Equations {
        self.0.equations(x, self.1)
    }
}

impl Equations {
    /// Of so many numbers, without rows.
    pub fn zero(p: usize) -> Self {
        Self { gram: Mat::zeros(p, p), gradient: vec![0.0; p] }
    }

    pub fn add(&mut self, jacobian: &Mat<f64>, residuals: &[f64]) {
        self.gram += jacobian.transpose() * jacobian;
        for (j, sum) in self.gradient.iter_mut().enumerate() {
            *sum += dot(jacobian.col_as_slice(j), residuals);
        }
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
