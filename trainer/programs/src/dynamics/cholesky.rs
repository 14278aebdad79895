use crate::row::{Row, WIDTH};

/// The factors of a small symmetric positive definite matrix of every sample, A = LDLᵀ, in storage that is used again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cholesky {
    n: usize,
    /// L below the diagonal, 1/D on it; row by row.
    entries: Vec<Row>,
}

impl Cholesky {
    /// Factors the matrix of these entries below and on the diagonal. Samples whose matrix is not positive definite are `false`; what
    /// is solved with them is no number.
    pub fn factor(&mut self, n: usize, entry: impl Fn(usize, usize) -> Row) -> [bool; WIDTH] {
        self.n = n;
        self.entries.clear();
        self.entries
            .extend((0..n * n).map(|k| if k % n <= k / n { entry(k / n, k % n) } else { Row::default() }));
        let mut least = Row::splat(f64::INFINITY);
        for k in 0..n {
            let pivot = self.eliminate(k);
            least = least.zip(&pivot, |least, d| if d < least { d } else { least });
            // What is no number is not less either.
            least = least.zip(&pivot, |least, d| if d < f64::INFINITY { least } else { 0.0 });
        }
        least.0.map(|d| d > 0.0)
    }

    /// Takes column k out of the rows below; returns its pivot.
    fn eliminate(&mut self, k: usize) -> Row {
        let n = self.n;
        let pivot = self.entries[k * n + k];
        let inverse = pivot.zip(&pivot, |d, _| 1.0 / d);
        self.entries[k * n + k] = inverse;
        for i in k + 1..n {
            let own = self.entries[i * n + k];
            let factor = own.zip(&inverse, |a, inverse| -a * inverse);
            // Those of column k that are not divided yet are at or below row i.
            for j in i..n {
                let other = self.entries[j * n + k];
                self.entries[j * n + i].add_product(&factor, &other);
            }
            self.entries[i * n + k] = factor;
        }
        pivot
    }

    /// Replaces b by A⁻¹b.
    pub fn solve(&self, b: &mut [Row]) {
        let n = self.n;
        // −L is what is kept.
        for i in 0..n {
            for j in 0..i {
                let x = b[j];
                b[i].add_product(&self.entries[i * n + j], &x);
            }
        }
        for (i, b) in b.iter_mut().enumerate() {
            *b = b.zip(&self.entries[i * n + i], |x, inverse| x * inverse);
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                let x = b[j];
                b[i].add_product(&self.entries[j * n + i], &x);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BᵀB + I/2, B of every sample another; sample 5 is made indefinite.
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
