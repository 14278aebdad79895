//! Identifiability of fitted numbers: the directions that samples determine, and standard errors.

use crate::matrix::{cholesky, singular};
use nalgebra::DMatrix;

/// Precision with which the samples determine a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shown {
    /// Standard error.
    Within(f64),
    /// Not determined: it can change together with other numbers without changing a residual.
    Together,
    /// At an end of its range.
    AtBound,
}

/// Largest share of a number in undetermined directions at which the number still counts as determined.
const FREE: f64 = 1e-4;

/// The 97.5th percentile of Student's t distribution with `free` degrees of freedom, by the Cornish–Fisher expansion
/// (within 0.3% from four degrees of freedom on). It is the half-width of a 95% interval in standard errors.
#[must_use]
pub fn student(free: usize) -> f64 {
    /// The 97.5th percentile of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    let (z, free) = (NORMAL, free.max(1) as f64);
    let powers = [z.powi(3) + z, 5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z];
    let third = 3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z;
    z + powers[0] / (4.0 * free) + powers[1] / (96.0 * free.powi(2)) + third / (384.0 * free.powi(3))
}

/// Directions, in the space of scaled numbers, that samples determine.
#[derive(Clone)]
pub(crate) struct Directions {
    /// Orthonormal basis, as columns.
    basis: DMatrix<f64>,
    /// Orthonormal basis of the directions that are not determined, as columns.
    complement: DMatrix<f64>,
    /// Share of every number in the undetermined directions.
    free: Vec<f64>,
}

impl Directions {
    /// Eigenvectors of the scaled matrix of the normal equations whose eigenvalues are above `least` of the largest
    /// one; none if the decomposition fails.
    pub fn of(scaled: &DMatrix<f64>, least: impl FnOnce(f64) -> f64) -> Self {
        let p = scaled.nrows();
        let Some(eigen) = singular(scaled) else {
            let [basis, complement] = [DMatrix::zeros(p, 0), DMatrix::identity(p, p)];
            return Self { basis, complement, free: vec![1.0; p] };
        };
        let least = least(eigen.values.first().copied().unwrap_or(0.0));
        let shown = eigen.values.iter().filter(|value| **value > least).count();
        let basis = eigen.right.columns(0, shown).into_owned();
        let complement = eigen.right.columns_range(shown..).into_owned();
        let free = (0..p).map(|i| 1.0 - basis.row(i).iter().map(|x| x * x).sum::<f64>()).collect();
        Self { basis, complement, free }
    }

    /// Orthonormal basis of the directions that the samples do not determine, as columns.
    pub fn complement(&self) -> &DMatrix<f64> {
        &self.complement
    }

    /// Number of directions that the samples do not determine.
    pub fn hidden(&self) -> usize {
        self.basis.nrows() - self.basis.ncols()
    }

    /// Whether a number is determined: it cannot change together with others without changing a residual.
    pub fn shows(&self, i: usize) -> bool {
        self.free[i] <= FREE
    }

    /// The inverse of a matrix within these directions; `None` if it is not positive definite there.
    pub fn inverse(&self, of: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let within = self.basis.transpose() * of * &self.basis;
        Some(&self.basis * cholesky(within)?.inverse() * self.basis.transpose())
    }

    /// Change of the numbers if a part of the samples is left out: the inverse of the rest's matrix times the part's
    /// gradient. If only that part determines some direction, the inverse of the whole replaces that of the rest.
    pub fn moved(&self, rest: &DMatrix<f64>, gradient: &DMatrix<f64>, whole: &DMatrix<f64>) -> DMatrix<f64> {
        self.inverse(rest).as_ref().unwrap_or(whole) * gradient
    }

    /// The determined number, among those that count, that is most strongly correlated with number i by this covariance,
    /// and the correlation.
    pub fn strongest(
        &self,
        covariance: &DMatrix<f64>,
        i: usize,
        counts: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let correlation = |j: usize| {
            let both = covariance[(i, i)] * covariance[(j, j)];
            (j, covariance[(i, j)] / both.sqrt())
        };
        let others =
            (0..self.free.len()).filter(|j| *j != i && self.shows(*j) && counts(*j)).map(correlation);
        let known = others.filter(|(_, part)| part.is_finite() && self.shows(i));
        known.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}
