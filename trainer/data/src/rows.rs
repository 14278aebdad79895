//! A table of samples.

use std::ops::{Index, Range};
use std::slice::ChunksExact;

/// Samples of an n-vector, one after the other: `rows[k][i]` is coordinate i of sample k.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    width: usize,
    values: Vec<f64>,
}

impl Rows {
    /// Takes row-major values; `None` unless `width` ≥ 1 divides their number.
    #[must_use]
    pub fn from_flat(width: usize, values: Vec<f64>) -> Option<Self> {
        (width > 0 && values.len().is_multiple_of(width)).then_some(Self { width, values })
    }

    /// Copies samples; `None` unless every one has `width` ≥ 1 entries.
    #[must_use]
    pub fn from_rows<R: AsRef<[f64]>>(width: usize, rows: impl IntoIterator<Item = R>) -> Option<Self> {
        let mut values = Vec::new();
        for row in rows {
            let row = row.as_ref();
            (row.len() == width).then(|| values.extend_from_slice(row))?;
        }
        Self::from_flat(width, values)
    }

    /// Copies samples of a width known at compile time.
    #[must_use]
    pub fn from_arrays<const N: usize>(rows: &[[f64; N]]) -> Self {
        Self { width: N, values: rows.as_flattened().to_vec() }
    }

    /// Number of entries per sample, n.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Whether there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Sample `k`, or `None` beyond the last.
    #[must_use]
    pub fn get(&self, k: usize) -> Option<&[f64]> {
        self.iter().nth(k)
    }

    /// The samples in order.
    pub fn iter(&self) -> ChunksExact<'_, f64> {
        self.values.chunks_exact(self.width)
    }

    /// Coordinate `i` of every sample; empty if `i` ≥ n.
    pub fn column(&self, i: usize) -> impl Iterator<Item = f64> + '_ {
        self.iter().filter_map(move |row| row.get(i).copied())
    }

    /// Mutable access to coordinate `i` of every sample.
    pub(crate) fn column_mut(&mut self, i: usize) -> impl Iterator<Item = &mut f64> {
        self.values.iter_mut().skip(i).step_by(self.width)
    }

    /// All values, row-major.
    #[must_use]
    pub fn as_flat(&self) -> &[f64] {
        &self.values
    }

    /// A copy of the samples in `range`, clipped to the existing samples.
    #[must_use]
    pub fn slice(&self, range: Range<usize>) -> Self {
        let rows = self.iter().take(range.end).skip(range.start);
        Self { width: self.width, values: rows.flatten().copied().collect() }
    }

    /// The samples with these indices, in this order; indices out of range are skipped.
    #[must_use]
    pub fn select(&self, samples: &[usize]) -> Self {
        let rows = samples.iter().filter_map(|k| self.get(*k));
        Self { width: self.width, values: rows.flatten().copied().collect() }
    }

    /// Applies `f` to every value, in order.
    #[must_use]
    pub fn map(&self, f: impl FnMut(f64) -> f64) -> Self {
        Self { width: self.width, values: self.values.iter().copied().map(f).collect() }
    }
}

impl Index<usize> for Rows {
    type Output = [f64];

    /// Sample `k`. Panics beyond the last sample, like a slice.
    fn index(&self, k: usize) -> &[f64] {
        &self.values[k * self.width..][..self.width]
    }
}

impl<'a> IntoIterator for &'a Rows {
    type Item = &'a [f64];
    type IntoIter = ChunksExact<'a, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_by_two() -> Rows {
        Rows::from_rows(2, [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]).unwrap()
    }

    #[test]
    fn rows_columns_and_slices_agree() {
        let rows = three_by_two();
        assert_eq!((rows.len(), rows.width(), rows.is_empty()), (3, 2, false));
        assert_eq!(rows[1], [2.0, 3.0]);
        assert_eq!(rows.get(2), Some(&[4.0, 5.0][..]));
        assert_eq!(rows.get(3), None);
        assert_eq!(rows.column(1).collect::<Vec<_>>(), [1.0, 3.0, 5.0]);
        assert_eq!(rows.column(2).count(), 0);
        assert_eq!(rows.slice(1..9).as_flat(), [2.0, 3.0, 4.0, 5.0]);
        assert_eq!(rows.select(&[2, 7, 0]).as_flat(), [4.0, 5.0, 0.0, 1.0]);
        assert_eq!(rows.map(|x| 2.0 * x).column(1).collect::<Vec<_>>(), [2.0, 6.0, 10.0]);
        assert_eq!(rows.iter().count(), 3);
    }

    #[test]
    fn ragged_or_empty_widths_are_refused() {
        assert!(Rows::from_flat(2, vec![1.0, 2.0, 3.0]).is_none());
        assert!(Rows::from_flat(0, vec![]).is_none());
        assert!(Rows::from_rows(2, [vec![1.0, 2.0], vec![3.0]]).is_none());
        assert!(Rows::from_flat(3, vec![]).unwrap().is_empty());
    }
}
