//! Operations on one matrix per sample: entries are [`Row`]s, stored row after row of the matrix.

use crate::row::Row;

/// Returns x·y.
pub(crate) fn dot(x: &[Row], y: &[Row]) -> Row {
    let mut sum = Row::default();
    x.iter().zip(y).for_each(|(x, y)| sum.add_product(x, y));
    sum
}

/// Returns Ax.
pub(crate) fn times(a: &[Row], x: &[Row]) -> Vec<Row> {
    a.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
}

/// Returns Aᵀy for a matrix of n columns: Σ_c y_c a_c.
pub(crate) fn contracted(y: &[Row], a: &[Row], n: usize) -> Vec<Row> {
    let mut sum = vec![Row::default(); n];
    for (y, row) in y.iter().zip(a.chunks_exact(n)) {
        sum.iter_mut().zip(row).for_each(|(sum, x)| sum.add_product(y, x));
    }
    sum
}

/// Returns AB for matrices of n × n entries.
pub(crate) fn product(a: &[Row], b: &[Row], n: usize) -> Vec<Row> {
    a.chunks_exact(n).flat_map(|row| contracted(row, b, n)).collect()
}

/// Adds cx to y.
pub(crate) fn add(y: &mut [Row], c: f64, x: &[Row]) {
    y.iter_mut().zip(x).for_each(|(y, x)| y.add_scaled(c, x));
}

/// Largest |x_i| of every sample, ignoring NaN.
pub(crate) fn max_abs(x: &[Row]) -> Row {
    x.iter().fold(Row::default(), |largest, x| largest.zip(x, |a, b| a.max(b.abs())))
}
