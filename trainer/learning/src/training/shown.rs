//! What samples show of numbers that were fitted to them: in which directions of their space, and how well.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

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

/// A number is free where directions that are not shown have this part of it.
const FREE: f64 = 1e-4;

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

/// Directions in the space of numbers, each over its size, that samples show.
pub(crate) struct Directions {
    /// As columns.
    basis: Mat<f64>,
    /// How much of every number is in the others.
    free: Vec<f64>,
}

impl Directions {
    /// Eigenvectors of the scaled matrix of the normal equations whose eigenvalues are above the least that counts beside the largest;
    /// none where it has no eigenvalues.
    pub fn of(scaled: &Mat<f64>, least: impl FnOnce(f64) -> f64) -> Self {
        let p = scaled.nrows();
        let Ok(eigen) = scaled.self_adjoint_eigen(Side::Lower) else {
            return Self { basis: Mat::zeros(p, 0), free: vec![1.0; p] };
        };
        let (values, vectors) = (eigen.S().column_vector(), eigen.U());
        let least = least(values.iter().copied().fold(0.0, f64::max));
        let shown: Vec<usize> = (0..p).filter(|k| values[*k] > least).collect();
        let basis = Mat::from_fn(p, shown.len(), |i, k| vectors[(i, shown[k])]);
        let free = (0..p).map(|i| 1.0 - basis.row(i).iter().map(|x| x * x).sum::<f64>()).collect();
        Self { basis, free }
    }

    /// How many there are that samples do not show.
    pub fn hidden(&self) -> usize {
        self.basis.nrows() - self.basis.ncols()
    }

    /// Whether a number cannot move with others without any residual.
    pub fn shows(&self, i: usize) -> bool {
        self.free[i] <= FREE
    }

    /// The inverse of a matrix in these directions; `None` where it is not positive definite there.
    pub fn inverse(&self, of: &Mat<f64>) -> Option<Mat<f64>> {
        let within = self.basis.transpose() * of * &self.basis;
        let factor = within.llt(Side::Lower).ok()?;
        Some(&self.basis * factor.inverse() * self.basis.transpose())
    }

    /// By how much numbers move where a part of the samples is left out: the inverse of the matrix of the rest times the part's gradient. Where the part
    /// alone shows something, of which the rest says nothing, the inverse of the whole stands in.
    pub fn moved(&self, rest: &Mat<f64>, gradient: &Mat<f64>, whole: &Mat<f64>) -> Mat<f64> {
        self.inverse(rest).as_ref().unwrap_or(whole) * gradient
    }

    /// Of the numbers that are shown the one that a number is correlated with most, by this covariance, and their correlation.
    pub fn strongest(&self, covariance: &Mat<f64>, i: usize) -> Option<(usize, f64)> {
        let correlation = |j: usize| {
            let both = covariance[(i, i)] * covariance[(j, j)];
            (j, covariance[(i, j)] / both.sqrt())
        };
        let others = (0..self.free.len()).filter(|j| *j != i && self.shows(*j)).map(correlation);
        let known = others.filter(|(_, part)| part.is_finite() && self.shows(i));
        known.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}
