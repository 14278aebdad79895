/// Factors of a small square matrix, PA = LU with partial pivoting; the storage is reused.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lu {
    n: usize,
    entries: Vec<f64>,
    order: Vec<usize>,
    solution: Vec<f64>,
}

impl Lu {
    /// Factors the matrix with these entries; returns `false` if it is singular or not finite.
    pub fn factor(&mut self, n: usize, entry: impl Fn(usize, usize) -> f64) -> bool {
        self.n = n;
        self.entries.clear();
        self.entries.extend((0..n * n).map(|k| entry(k / n, k % n)));
        self.order.clear();
        self.order.extend(0..n);
        (0..n).all(|k| self.eliminate(k))
    }

    fn eliminate(&mut self, k: usize) -> bool {
        let n = self.n;
        let size = |row: &usize| self.entries[row * n + k].abs();
        let Some(pivot) = (k..n).max_by(|a, b| size(a).total_cmp(&size(b))) else { return false };
        let largest = size(&pivot);
        if !(largest > 0.0 && largest.is_finite()) {
            return false;
        }
        if pivot != k {
            (0..n).for_each(|j| self.entries.swap(k * n + j, pivot * n + j));
            self.order.swap(k, pivot);
        }
        let (upper, lower) = self.entries.split_at_mut((k + 1) * n);
        let row = &upper[k * n..];
        for other in lower.chunks_exact_mut(n) {
            let factor = other[k] / row[k];
            other[k] = factor;
            if factor != 0.0 {
                other[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(x, y)| *x -= factor * y);
            }
        }
        true
    }

    /// Returns A⁻¹b.
    pub fn solve(&mut self, b: impl Fn(usize) -> f64) -> &[f64] {
        let n = self.n;
        self.solution.clear();
        self.solution.extend(self.order.iter().map(|row| b(*row)));
        for i in 0..n {
            let (done, rest) = self.solution.split_at_mut(i);
            rest[0] -= dot(&self.entries[i * n..i * n + i], done);
        }
        for i in (0..n).rev() {
            let (rest, done) = self.solution.split_at_mut(i + 1);
            let row = &self.entries[i * n..(i + 1) * n];
            rest[i] = (rest[i] - dot(&row[i + 1..], done)) / row[i];
        }
        &self.solution
    }

    /// Returns A⁻ᵀb.
    pub fn solve_transposed(&mut self, b: impl Fn(usize) -> f64) -> &[f64] {
        let n = self.n;
        let mut x: Vec<f64> = (0..n).map(b).collect();
        for i in 0..n {
            x[i] /= self.entries[i * n + i];
            let own = x[i];
            (i + 1..n).for_each(|j| x[j] -= self.entries[i * n + j] * own);
        }
        for i in (0..n).rev() {
            let own = x[i];
            (0..i).for_each(|j| x[j] -= self.entries[i * n + j] * own);
        }
        self.solution.clear();
        self.solution.resize(n, 0.0);
        for (row, x) in self.order.iter().zip(x) {
            self.solution[*row] = x;
        }
        &self.solution
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_solutions_are_those_of_the_matrix() {
        let n = 5;
        let entry = |i: usize, j: usize| (1.3 * i as f64 - 0.7 * (j * j) as f64 + (i * j) as f64).sin();
        let mut lu = Lu::default();
        assert!(lu.factor(n, entry));
        let b = |i: usize| i as f64 - 1.5;
        let x = lu.solve(b).to_vec();
        let y = lu.solve_transposed(b).to_vec();
        for i in 0..n {
            let row: f64 = (0..n).map(|j| entry(i, j) * x[j]).sum();
            let column: f64 = (0..n).map(|j| entry(j, i) * y[j]).sum();
            assert!((row - b(i)).abs() < 1e-12 && (column - b(i)).abs() < 1e-12);
        }
        assert!(!lu.factor(3, |i, j| (i + j) as f64 * 0.0));
        assert!(!lu.factor(2, |_, _| f64::NAN));
    }
}
