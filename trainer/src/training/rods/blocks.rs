//! Matrices of a size known at run time, made of blocks of N coordinates.

use super::Failed;
use faer::Mat;
use leastaction_core::linear::transpose;

/// Writes a block with its first entry at (row, column).
pub(super) fn set<const N: usize>(to: &mut Mat<f64>, (row, column): (usize, usize), block: &[[f64; N]; N]) {
    for (i, entries) in block.iter().enumerate() {
        set_row(to, (row + i, column), entries);
    }
}

/// Writes a part of a row from (row, column) on.
pub(super) fn set_row<const N: usize>(to: &mut Mat<f64>, (row, column): (usize, usize), part: &[f64; N]) {
    for (j, entry) in part.iter().enumerate() {
        to[(row, column + j)] = *entry;
    }
}

/// Writes a part of a column from (row, column) on.
pub(super) fn set_column<const N: usize>(to: &mut Mat<f64>, (row, column): (usize, usize), part: &[f64; N]) {
    for (i, entry) in part.iter().enumerate() {
        to[(row + i, column)] = *entry;
    }
}

/// A part of a column from (row, column) on.
pub(super) fn column<const N: usize>(of: &Mat<f64>, (row, column): (usize, usize)) -> [f64; N] {
    std::array::from_fn(|i| of[(row + i, column)])
}

/// The block with its first entry at (row, column).
pub(super) fn block<const N: usize>(of: &Mat<f64>, (row, first): (usize, usize)) -> [[f64; N]; N] {
    transpose(&std::array::from_fn(|j| column(of, (row, first + j))))
}

/// What a solve gave; an error where the matrix was singular, or a weight has left its range.
pub(super) fn finite(solution: Mat<f64>) -> Result<Mat<f64>, Failed> {
    if solution.is_all_finite() { Ok(solution) } else { Err(Failed) }
}
