use super::{Bounds, ChunkRows};
use crate::matrix::{add_gram, column, column_mut};
use leastaction_programs::Row;
use nalgebra::DMatrix;

/// The normal equations of a nonlinear least-squares problem, summed chunk by chunk: JᵀJ (lower triangle), Jᵀr and rᵀr.
/// The memory needed is that of JᵀJ, whatever the number of samples.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    /// JᵀJ; only the lower triangle is meaningful.
    pub gram: DMatrix<f64>,
    /// Jᵀr.
    pub gradient: Vec<f64>,
    /// rᵀr.
    pub squares: f64,
    /// Number of residual components.
    pub rows: usize,
}

impl NormalEquations {
    /// Empty equations for p parameters.
    pub fn zero(p: usize) -> Self {
        Self { gram: DMatrix::zeros(p, p), gradient: vec![0.0; p], squares: 0.0, rows: 0 }
    }

    /// Adds the rows of a chunk. The sum is sequential, so it is the same on any number of threads.
    pub fn add(&mut self, rows: &ChunkRows) {
        add_gram(&mut self.gram, rows.jacobian(), rows.positions());
        self.add_gradient(rows);
    }

    /// Adds the rows of a chunk to the gradient and the sum of squares alone.
    pub fn add_gradient(&mut self, rows: &ChunkRows) {
        let residual = &rows.residual;
        for (j, position) in rows.positions().iter().enumerate() {
            let products = column(rows.jacobian(), j).iter().zip(residual).map(|(a, b)| a * b);
            self.gradient[*position] += products.sum::<f64>();
        }
        self.squares += residual.iter().map(|r| r * r).sum::<f64>();
        self.rows += residual.len();
    }

    /// Adds gradients of ½Σ r² that are held side by side, for the first `count` samples.
    pub(super) fn add_row(&mut self, gradient: &[Row], count: usize) {
        for (sum, row) in self.gradient.iter_mut().zip(gradient) {
            *sum += row.0[..count].iter().sum::<f64>();
        }
    }

    /// Adds the normal equations of the penalty λ|θ|² on the mean square, for the first numbers of θ. Numbers on which
    /// no residual depends, known numbers among them, get no penalty and stay where they are.
    pub fn add_decay(&mut self, decay: f64, weights: &[f64]) {
        let decay = decay * self.rows as f64;
        for (i, w) in weights.iter().take(self.gradient.len()).enumerate() {
            if self.gram[(i, i)] == 0.0 {
                continue;
            }
            self.gram[(i, i)] += decay;
            self.gradient[i] += decay * w;
        }
    }

    /// Adds the normal equations of the penalty c(w − w₀)² on the sum of squares; `difference` is w − w₀.
    pub fn add_penalty(&mut self, position: usize, c: f64, difference: f64) {
        self.gram[(position, position)] += c;
        self.gradient[position] += c * difference;
    }

    /// Adds the normal equations of c s², given s and its derivatives by position.
    pub(super) fn add_square(&mut self, slopes: &[(usize, f64)], s: f64, c: f64) {
        for (i, slope) in slopes.iter().copied() {
            self.gradient[i] += c * slope * s;
            let rows = slopes.iter().filter(|(j, _)| *j <= i);
            rows.for_each(|(j, other)| self.gram[(i, *j)] += c * slope * other);
        }
    }

    /// Transforms the equations from weights to the unbounded numbers θ.
    pub(super) fn bring_to_free(&mut self, bounds: &Bounds, theta: &[f64]) {
        self.scale(bounds.slopes_at(theta));
        for (position, slopes) in bounds.body_slopes(theta) {
            self.mix(position, &slopes);
        }
    }

    /// Transforms single weights to θ, given dw/dθ by position; for all other weights dw/dθ is 1.
    pub(super) fn scale(&mut self, slopes: impl Iterator<Item = (usize, f64)>) {
        for (position, slope) in slopes {
            self.gradient[position] *= slope;
            // `gram` is empty when only the gradient is summed. The diagonal entry is scaled twice: as part of the row
            // and as part of the column.
            let columns = self.gram.ncols().min(position + 1);
            (0..columns).for_each(|j| self.gram[(position, j)] *= slope);
            if columns > 0 {
                column_mut(&mut self.gram, position)[position..].iter_mut().for_each(|entry| *entry *= slope);
            }
        }
    }

    /// Transforms the M weights from `position` on to the same number of θ; ∂w_j/∂θ_k is `slopes[k][j]`.
    fn mix<const M: usize>(&mut self, position: usize, slopes: &[[f64; M]; M]) {
        let mixed = |own: [f64; M]| slopes.map(|row| row.iter().zip(own).map(|(slope, x)| slope * x).sum());
        let of: [f64; M] = mixed(std::array::from_fn(|j| self.gradient[position + j]));
        self.gradient[position..position + M].copy_from_slice(&of);
        let count = self.gram.ncols();
        // `gram` is empty when only the gradient is summed.
        if count == 0 {
            return;
        }
        let at = |i: usize, j: usize| (i.max(j), i.min(j));
        for other in (0..count).filter(|other| !(position..position + M).contains(other)) {
            let own: [f64; M] = mixed(std::array::from_fn(|j| self.gram[at(position + j, other)]));
            own.into_iter().enumerate().for_each(|(k, x)| self.gram[at(position + k, other)] = x);
        }
        let block: [[f64; M]; M] =
            std::array::from_fn(|i| std::array::from_fn(|j| self.gram[at(position + i, position + j)]));
        let half = block.map(mixed);
        for (i, slopes) in slopes.iter().enumerate() {
            for j in 0..=i {
                let sum: f64 = slopes.iter().zip(&half).map(|(slope, row)| slope * row[j]).sum();
                self.gram[(position + i, position + j)] = sum;
            }
        }
    }

    /// An entry of JᵀJ.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.gram[(i.max(j), i.min(j))]
    }

    /// Adds another partial sum.
    pub fn merge(&mut self, other: &Self) {
        // `gram` is empty when only the gradient is summed.
        for j in 0..self.gram.ncols() {
            let below = column_mut(&mut self.gram, j)[j..].iter_mut();
            below.zip(&column(&other.gram, j)[j..]).for_each(|(a, b)| *a += b);
        }
        for (a, b) in self.gradient.iter_mut().zip(&other.gradient) {
            *a += b;
        }
        self.squares += other.squares;
        self.rows += other.rows;
    }

    /// The loss: mean square of the residual components.
    pub fn mean_square(&self) -> f64 {
        self.squares / self.rows as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_penalty_leaves_numbers_alone_that_nothing_varies_with() {
        let mut equations = NormalEquations::zero(2);
        (equations.rows, equations.gram[(0, 0)]) = (4, 1.0);
        equations.add_decay(0.5, &[3.0, 1.0]);
        assert_eq!((equations.gram[(0, 0)], equations.gram[(1, 1)]), (3.0, 0.0));
        assert_eq!(equations.gradient, [6.0, 0.0]);
    }
}
