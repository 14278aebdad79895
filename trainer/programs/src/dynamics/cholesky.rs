use crate::row::{Row, WIDTH};
use wide::f64x8;

/// Factors of small symmetric positive definite matrices, A = LDLᵀ, one matrix per sample, for any number of rows of
/// samples; the storage is reused.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cholesky {
    n: usize,
    rows: usize,
    /// L below the diagonal and 1/D on it, row by row.
    entries: Vec<Row>,
    /// Whether all pivots of a sample's matrix are positive: 1 if so, otherwise 0.
    positive: Vec<Row>,
}

impl Cholesky {
    /// Factors the matrix with these entries on and below the diagonal. Returns `false` for samples whose matrix is not positive definite;
    /// solutions for them are NaN.
    pub fn factor(&mut self, n: usize, entry: impl Fn(usize, usize) -> Row) -> [bool; WIDTH] {
        self.factor_rows(n, 1, |i, j, place| place[0] = entry(i, j));
        std::array::from_fn(|k| self.is_positive(0, k))
    }

    /// Does the same for `rows` rows of samples: `write` writes entry (i, j) of all of them.
    pub fn factor_rows(&mut self, n: usize, rows: usize, write: impl Fn(usize, usize, &mut [Row])) {
        (self.n, self.rows) = (n, rows);
        self.entries.resize(n * n * rows, Row::default());
        for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            write(i, j, &mut self.entries[(i * n + j) * rows..][..rows]);
        }
        self.positive.clear();
        self.positive.resize(rows, Row::splat(1.0));
        (0..n).for_each(|k| self.eliminate(k));
    }

    /// Whether the matrix of a sample is positive definite.
    pub fn is_positive(&self, row: usize, sample: usize) -> bool {
        self.positive[row].0[sample] > 0.0
    }

    /// Whether the matrices of all samples of a row are positive definite.
    pub fn are_positive(&self, row: usize) -> bool {
        let [first, second] = self.positive[row].load();
        (first & second).simd_eq(f64x8::ONE).all()
    }

    /// Eliminates column k from the rows below.
    fn eliminate(&mut self, k: usize) {
        let (n, rows) = (self.n, self.rows);
        let at = |i: usize, j: usize| (i * n + j) * rows;
        for (d, positive) in self.entries[at(k, k)..].iter_mut().zip(&mut self.positive) {
            let (own, pivot) = (positive.load(), d.load());
            // NaN counts as not positive.
            let is_number = pivot.map(|d| d.simd_gt(f64x8::ZERO) & d.simd_lt(f64x8::splat(f64::INFINITY)));
            *positive = Row::store(std::array::from_fn(|g| own[g] & is_number[g]));
            *d = Row::store(pivot.map(|d| f64x8::ONE / d));
        }
        for (i, row) in (k + 1..n).flat_map(|i| (0..rows).map(move |row| (i, row))) {
            let (own, inverse) = (self.entries[at(i, k) + row], self.entries[at(k, k) + row]);
            let factor = own.zip(&inverse, |a, inverse| -a * inverse);
            // Entries of column k that are not divided by the pivot yet are at or below row i.
            for j in i..n {
                let other = self.entries[at(j, k) + row];
                self.entries[at(j, i) + row].add_product(&factor, &other);
            }
            self.entries[at(i, k) + row] = factor;
        }
    }

    /// Replaces b by A⁻¹b; all rows of samples of the first number come first.
    pub fn solve(&self, b: &mut [Row]) {
        let (n, rows) = (self.n, self.rows);
        let entry = |i: usize, j: usize, row: usize| &self.entries[(i * n + j) * rows + row];
        let below = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
        let above = (0..n).rev().flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        // The stored entries are −L.
        for (i, j) in below {
            for row in 0..rows {
                let x = b[j * rows + row];
                b[i * rows + row].add_product(entry(i, j, row), &x);
            }
        }
        for (i, b) in b.chunks_mut(rows).enumerate() {
            let inverse = &self.entries[(i * n + i) * rows..];
            b.iter_mut().zip(inverse).for_each(|(b, inverse)| *b = b.product(inverse));
        }
        for (i, j) in above {
            for row in 0..rows {
                let x = b[j * rows + row];
                b[i * rows + row].add_product(entry(j, i, row), &x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BᵀB + I/2 with a different B for every sample; sample 5 is made indefinite.
    fn matrix(n: usize) -> impl Fn(usize, usize) -> Row {
        let b =
            |i: usize, j: usize, sample: usize| (1.3 * i as f64 - 0.7 * (j * j) as f64 + sample as f64).sin();
        let entry = move |i: usize, j: usize, sample: usize| -> f64 {
            let own = if i == j { 0.5 } else { 0.0 };
            own + (0..n).map(|k| b(k, i, sample) * b(k, j, sample)).sum::<f64>()
        };
        move |i, j| {
            let mut row = Row(std::array::from_fn(|sample| entry(i, j, sample)));
            row.0[5] *= if i == n - 1 && j == n - 1 { -1.0 } else { 1.0 };
            row
        }
    }

    #[test]
    fn solutions_are_those_of_every_samples_matrix() {
        for n in [1, 2, 5] {
            let (entry, mut cholesky) = (matrix(n), Cholesky::default());
            let positive = cholesky.factor(n, &entry);
            assert!(positive.iter().enumerate().all(|(sample, positive)| *positive == (sample != 5)));
            let b: Vec<Row> = (0..n).map(|i| Row::splat(i as f64 - 1.5)).collect();
            let mut x = b.clone();
            cholesky.solve(&mut x);
            for (sample, i) in (0..WIDTH).flat_map(|sample| (0..n).map(move |i| (sample, i))) {
                let product: f64 = (0..n).map(|j| entry(i, j).0[sample] * x[j].0[sample]).sum();
                assert!(sample == 5 || (product - b[i].0[sample]).abs() < 1e-12, "{n}, sample {sample}");
            }
        }
    }
}
