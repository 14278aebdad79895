//! Newton's method for the points of a chain, and the transposed equations for its derivatives.

use super::chain::{Chain, Stretch};
use super::model::{MAX_ITERATIONS, RodModel, SETTLED, settled};
use crate::dynamics::{Failures, Lu, contracted, max_abs};
use crate::row::{Row, WIDTH};

impl Chain {
    /// Solves for everything that is not logged.
    pub fn solve(&mut self, model: &mut RodModel, weights: &[f64]) {
        for stretch in self.stretches.clone() {
            self.solve_stretch(model, weights, stretch);
        }
    }

    fn solve_stretch(&mut self, model: &mut RodModel, weights: &[f64], stretch: Stretch) {
        let mut done = self.failures;
        let scales = self.points.iter().map(|point| max_abs(&point.x));
        let scale = scales.fold(Row::default(), |a, b| a.zip(&b, f64::max));
        for iteration in 0..MAX_ITERATIONS {
            self.evaluate((&mut *model, weights), stretch, iteration == 0, done);
            done = done.or(self.failures);
            let owed = self.owed(stretch);
            for sample in 0..WIDTH {
                if done.0[sample] {
                    continue;
                }
                if !self.factor(&mut model.lu, model.n, stretch, sample) {
                    self.failures.0[sample] = true;
                }
                let change = model.lu.solve(|i| owed[i].0[sample]);
                let last = self.apply(stretch, change, sample, SETTLED * scale.0[sample]);
                done.0[sample] = last || self.failures.0[sample];
            }
            if done.all() {
                return;
            }
        }
        self.failures = self.failures.or(Failures(done.0.map(|done| !done)));
    }

    /// Residuals of the equations of a stretch: for every point the equation of motion, and φ at the unknown position.
    fn owed(&self, Stretch { start, end, ahead }: Stretch) -> Vec<Row> {
        (start..end).flat_map(|k| [self.residual(k), self.points[k + ahead].phi.clone()].concat()).collect()
    }

    /// Factors the derivatives of these equations with respect to x and λ, point by point; returns `false` if they are
    /// singular.
    ///
    /// The elimination skips the zeros outside the blocks of neighbours.
    fn factor(&self, lu: &mut Lu, n: usize, Stretch { start, end, ahead }: Stretch, sample: usize) -> bool {
        let size = n + self.points[start].lambda.len();
        lu.factor((end - start) * size, |i, j| {
            let ((row, i), (column, j)) = ((start + i / size, i % size), (start + j / size, j % size));
            let slopes = &self.points[row].slopes;
            match (i < n, j < n) {
                (true, true) => (column + ahead + 1)
                    .checked_sub(row)
                    .and_then(|slot| slopes.get(slot))
                    .map_or(0.0, |slope| slope[i * n + j].0[sample]),
                (true, false) if row == column => self.points[row].gradients[(j - n) * n + i].0[sample],
                (false, true) if row == column => {
                    self.points[row + ahead].gradients[(i - n) * n + j].0[sample]
                }
                _ => 0.0,
            }
        })
    }

    /// Subtracts the change from the unknowns of a sample; returns whether the change was so small that it can be the
    /// last.
    fn apply(&mut self, stretch: Stretch, change: &[f64], sample: usize, bound: f64) -> bool {
        let (n, Stretch { start, end, ahead }) = (self.points[0].x.len(), stretch);
        let size = change.len() / (end - start);
        let mut last = true;
        for (k, change) in (start..end).zip(change.chunks_exact(size)) {
            let (dx, of_lambda) = change.split_at(n);
            self.points[k + ahead].x.iter_mut().zip(dx).for_each(|(x, dx)| x.0[sample] -= dx);
            let lambda = &mut self.points[k].lambda;
            lambda.iter_mut().zip(of_lambda).for_each(|(lambda, change)| lambda.0[sample] -= change);
            last &= settled(dx.iter().copied(), bound);
        }
        last
    }
}

/// Weights y of the equations of all points in a number of residual components, n rows per point.
pub(super) struct Adjoints {
    /// Weights y of every component and point; 0 at both ends.
    pub y: Vec<Vec<Vec<Row>>>,
    /// Derivative of every component with respect to the position of every point, through the equations that have weights.
    moves: Vec<Vec<Vec<Row>>>,
}

impl Adjoints {
    pub fn new(components: usize, points: usize, n: usize) -> Self {
        let zero = vec![vec![vec![Row::default(); n]; points]; components];
        Self { y: zero.clone(), moves: zero }
    }

    /// Starts from components that are functions of the position of one point.
    pub fn moving(mut self, point: usize, with: &[Vec<Row>]) -> Self {
        self.moves.iter_mut().zip(with).for_each(|(moves, with)| moves[point].clone_from(with));
        self
    }

    /// Starts from components in which one equation has these weights.
    pub fn weighing(mut self, chain: &Chain, k: usize, y: &[Vec<Row>]) -> Self {
        self.y.iter_mut().zip(y).for_each(|(own, y)| own[k].clone_from(y));
        self.push(chain, k);
        self
    }

    /// Adds the contribution of the solved unknowns by the implicit function theorem: y = −K⁻ᵀ ∂r, where K is block
    /// triangular in the stretches.
    pub fn solve(&mut self, chain: &mut Chain, model: &mut RodModel) {
        for stretch in chain.stretches.clone().iter().rev() {
            for sample in 0..WIDTH {
                if chain.failures.0[sample] {
                    continue;
                }
                if chain.factor(&mut model.lu, model.n, *stretch, sample) {
                    self.solve_sample(model, *stretch, sample);
                } else {
                    chain.failures.0[sample] = true;
                }
            }
            (stretch.start..stretch.end).for_each(|k| self.push(chain, k));
        }
    }

    fn solve_sample(&mut self, model: &mut RodModel, Stretch { start, end, ahead }: Stretch, sample: usize) {
        let (n, size) = (model.n, model.size());
        for (y, moves) in self.y.iter_mut().zip(&self.moves) {
            let solution = model.lu.solve_transposed(|i| {
                let moves = &moves[start + i / size + ahead];
                moves.get(i % size).map_or(0.0, |moves| -moves.0[sample])
            });
            for (k, solution) in (start..end).zip(solution.chunks_exact(size)) {
                y[k].iter_mut().zip(&solution[..n]).for_each(|(y, x)| y.0[sample] = *x);
            }
        }
    }

    fn push(&mut self, chain: &Chain, k: usize) {
        for (y, moves) in self.y.iter().zip(&mut self.moves) {
            for (moves, slope) in moves[k - 1..].iter_mut().zip(&chain.points[k].slopes) {
                let n = moves.len();
                let pulled = contracted(&y[k], slope, n);
                moves.iter_mut().zip(&pulled).for_each(|(moves, pulled)| moves.add_scaled(1.0, pulled));
            }
        }
    }
}
