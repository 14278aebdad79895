//! Small dense linear algebra in fixed-size arrays: only what a Newton step and a solve with the mass matrix need, without a panic branch
//! and with one order of operations on every target.

use crate::scalar::{Real, Scalar};
use core::fmt;

/// A square matrix, row by row.
pub type Matrix<S, const N: usize> = [[S; N]; N];

/// Reason why a system of linear equations has no finite solution.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveError {
    /// The matrix is singular: all remaining pivots were 0.
    Singular {
        /// The column of the pivot, from 0.
        column: u8,
    },
    /// The matrix, the right-hand side or the solution has entries that are infinite or NaN.
    NotFinite,
}

impl SolveError {
    /// Error for a pivot that cannot be divided by.
    pub(crate) fn of_pivot<R: Real>(pivot: R, column: usize) -> Self {
        if pivot.is_finite() { Self::Singular { column: column as u8 } } else { Self::NotFinite }
    }
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Singular { column } => {
                write!(f, "the matrix is singular: column {column} has no pivot but 0")
            }
            Self::NotFinite => f.write_str("a number is infinite or not a number"),
        }
    }
}

impl core::error::Error for SolveError {}

/// Σ a_i b_i.
#[inline]
pub fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (a, b)| sum + *a * *b)
}

/// Av.
#[inline]
pub fn multiply<S: Scalar, const N: usize, const M: usize>(a: &[[S; M]; N], v: &[S; M]) -> [S; N] {
    core::array::from_fn(|i| dot(&a[i], v))
}

/// Aᵀ.
#[inline]
pub fn transpose<S: Scalar, const N: usize, const M: usize>(a: &[[S; M]; N]) -> [[S; N]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

/// The matrix with the given entries on its diagonal.
pub fn diagonal<S: Scalar, const N: usize>(entries: [S; N]) -> Matrix<S, N> {
    let mut matrix = [[S::zero(); N]; N];
    for (i, (row, entry)) in matrix.iter_mut().zip(entries).enumerate() {
        row[i] = entry;
    }
    matrix
}

/// The identity matrix.
pub fn identity<S: Scalar, const N: usize>() -> Matrix<S, N> {
    diagonal([S::one(); N])
}

/// AB.
pub fn product<S: Scalar, const I: usize, const J: usize, const K: usize>(
    a: &[[S; J]; I],
    b: &[[S; K]; J],
) -> [[S; K]; I] {
    let mut sum = [[S::zero(); K]; I];
    for (sum, row) in sum.iter_mut().zip(a) {
        for (factor, b) in row.iter().zip(b) {
            *sum = add_scaled(sum, *factor, b);
        }
    }
    sum
}

/// a + cb.
#[inline]
pub fn add_scaled<S: Scalar, const N: usize>(a: &[S; N], c: S, b: &[S; N]) -> [S; N] {
    core::array::from_fn(|i| a[i] + c * b[i])
}

/// A + cB.
#[inline]
pub fn add_scaled_matrix<S: Scalar, const N: usize, const M: usize>(
    a: &[[S; M]; N],
    c: S,
    b: &[[S; M]; N],
) -> [[S; M]; N] {
    core::array::from_fn(|i| add_scaled(&a[i], c, &b[i]))
}

/// A⁻¹b by Gaussian elimination with partial pivoting.
pub fn solve<R: Real, const N: usize>(a: [[R; N]; N], b: [R; N]) -> Result<[R; N], SolveError> {
    let [x] = solve_many(a, [b])?;
    Ok(x)
}

/// A⁻¹b for each b of `rhs`, in one elimination.
pub fn solve_many<R: Real, const N: usize, const C: usize>(
    mut a: [[R; N]; N],
    mut rhs: [[R; N]; C],
) -> Result<[[R; N]; C], SolveError> {
    for k in 0..N {
        pivot(&mut a, &mut rhs, k)?;
        let row_k = a[k];
        for i in k + 1..N {
            let factor = a[i][k] / row_k[k];
            for (entry, above) in a[i].iter_mut().zip(&row_k).skip(k + 1) {
                *entry -= factor * *above;
            }
            for b in &mut rhs {
                b[i] -= factor * b[k];
            }
        }
    }
    for b in &mut rhs {
        substitute(&a, b);
    }
    Ok(rhs)
}

/// A⁻¹B.
pub fn solve_columns<R: Real, const N: usize>(
    a: Matrix<R, N>,
    b: &Matrix<R, N>,
) -> Result<Matrix<R, N>, SolveError> {
    Ok(transpose(&solve_many(a, transpose(b))?))
}

/// A⁻¹b for each b of `rhs` and a symmetric A that is positive (or negative) definite: elimination without pivoting, LDLᵀ, with N divisions
/// and no branch except the check of pivots.
#[inline]
pub fn solve_definite<R: Real, const N: usize, const C: usize>(
    mut a: [[R; N]; N],
    mut rhs: [[R; N]; C],
) -> Result<[[R; N]; C], SolveError> {
    for k in 0..N {
        let row_k = a[k];
        let reciprocal = R::one() / row_k[k];
        if !(reciprocal.abs() > R::zero() && reciprocal.is_finite()) {
            return Err(SolveError::of_pivot(row_k[k], k));
        }
        a[k][k] = reciprocal;
        for i in k + 1..N {
            let factor = row_k[i] * reciprocal;
            for j in k + 1..N {
                a[i][j] -= factor * row_k[j];
            }
            for b in &mut rhs {
                b[i] -= factor * b[k];
            }
        }
    }
    for b in &mut rhs {
        for i in (0..N).rev() {
            for j in i + 1..N {
                b[i] -= a[i][j] * b[j];
            }
            b[i] = b[i] * a[i][i];
        }
    }
    Ok(rhs)
}

/// Brings the row with the largest entry of column k, among rows k and below, to row k.
#[inline]
fn pivot<R: Real, const N: usize, const C: usize>(
    a: &mut [[R; N]; N],
    rhs: &mut [[R; N]; C],
    k: usize,
) -> Result<(), SolveError> {
    for i in k + 1..N {
        if a[i][k].abs() > a[k][k].abs() {
            a.swap(i, k);
            for b in rhs.iter_mut() {
                b.swap(i, k);
            }
        }
    }
    if a[k][k].abs() > R::zero() && a[k][k].is_finite() {
        Ok(())
    } else {
        Err(SolveError::of_pivot(a[k][k], k))
    }
}

/// Back substitution in the upper triangle.
#[inline]
fn substitute<R: Real, const N: usize>(a: &[[R; N]; N], b: &mut [R; N]) {
    for i in (0..N).rev() {
        let mut sum = b[i];
        for j in i + 1..N {
            sum -= a[i][j] * b[j];
        }
        b[i] = sum / a[i][i];
    }
}
