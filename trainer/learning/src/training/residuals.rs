//! Sums over samples, in fixed parts. Each part is computed in order on one thread, and the parts are added in a fixed
//! tree, so that the results do not depend on the number of threads.

use super::{Bounds, NormalEquations, Objective, Solved};
use crate::matrix::column_mut;
use leastaction_models::bounds;
use leastaction_models::parallel;
use leastaction_programs::{Row, WIDTH};
use nalgebra::DMatrix;
use std::ops::Range;

/// Samples per matrix product; not a power of two, so that columns of the Jacobian do not share cache lines.
const CHUNK: usize = 240;
/// Largest number of parts with separate sums, and thus of useful threads.
const PARTS: usize = 64;
/// Number of parts for few samples.
const FEW_PARTS: usize = 8;
/// Number of samples in a part that makes up for the cost of clearing and adding its JᵀJ.
const WORTH_A_GRAM: usize = 512;
/// Largest number of entries in the JᵀJ of all parts together; they take 1 GiB. A single JᵀJ may be larger.
const GRAM_NUMBERS: usize = 1 << 27;

/// Error: the residual of a sample could not be computed at these weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failed;

/// The residuals of samples and their derivatives with respect to the weights, chunk by chunk. Every implementation is an [`Objective`],
/// whatever its model.
pub trait Residuals: Sync {
    /// Size of the weight block.
    fn parameters(&self) -> usize;
    /// Number of samples.
    fn samples(&self) -> usize;
    /// Number of residual components per sample.
    fn components(&self) -> usize;
    /// The sum of squared residuals of a chunk.
    ///
    /// # Errors
    /// [`Failed`] if a residual cannot be computed.
    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed>;
    /// The sum of squared residuals over the samples of a chunk that can be computed, and the number of samples that cannot.
    fn solved(&self, weights: &[f64], samples: Range<usize>) -> (f64, usize) {
        match self.squares(weights, samples.clone()) {
            Ok(squares) if squares.is_finite() => (squares, 0),
            _ => (0.0, samples.len()),
        }
    }
    /// Passes the residuals of a chunk with their derivatives to `add`, at once or in parts, each written to `rows`.
    ///
    /// # Errors
    /// [`Failed`] if a residual cannot be computed.
    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed>;
    /// Adds only Jᵀr and rᵀr of a chunk.
    ///
    /// # Errors
    /// [`Failed`] if a residual cannot be computed.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        self.linearise(weights, samples, rows, &mut |rows| sum.add_gradient(rows))
    }
    /// See [`Objective::project`]; does nothing if every number is a weight.
    fn project(&self, _weights: &mut [f64]) {}
    /// See [`Objective::shared`].
    fn shared(&self) -> usize {
        self.parameters()
    }
    /// See [`Objective::weights`].
    fn weights(&self) -> usize {
        self.shared()
    }
    /// Largest number of samples computed at once.
    fn chunk(&self) -> usize {
        CHUNK
    }
    /// Adds the normal equations of the prior on the weights.
    fn add_penalty(&self, _weights: &[f64], _sum: &mut NormalEquations) {}
    /// See [`Objective::enter`].
    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        weights
    }
    /// See [`Objective::settle`].
    fn settle(&self, _weights: &mut [f64]) -> bool {
        false
    }
    /// See [`Objective::completed_loss`].
    fn completed_loss(&self, weights: &mut [f64]) -> f64
    where
        Self: Sized,
    {
        Objective::loss(self, weights)
    }
    /// See [`Objective::held_back_loss`]; `None` if it is the loss itself.
    fn held_back_loss(&self, _weights: &[f64]) -> Option<f64> {
        None
    }
    /// Sum of the squared residuals of a motion with constant velocity over the samples of a chunk; `None` if it is not
    /// defined.
    fn squares_of_constant_velocity(&self, _samples: Range<usize>) -> Option<f64> {
        None
    }
    /// See [`Objective::is_of_many_units`].
    fn is_of_many_units(&self) -> bool {
        false
    }
    /// See [`Objective::tolerance`].
    fn tolerance(&self) -> f64 {
        0.0
    }
    /// See [`Objective::limits`].
    fn limits(&self) -> &[[f64; 2]] {
        &[]
    }
    /// See [`Objective::bounds`]; no bounds if every number is a weight.
    fn bounds(&self) -> &Bounds {
        &bounds::NONE
    }
}

/// Workspace for the rows of one chunk: residuals, and their derivatives with respect to the parameters on which they depend.
pub struct ChunkRows {
    /// Residuals r.
    pub residual: Vec<f64>,
    jacobian: DMatrix<f64>,
    /// Parameter of every column, in ascending order.
    positions: Vec<usize>,
}

impl ChunkRows {
    fn new() -> Self {
        Self { residual: Vec::new(), jacobian: DMatrix::zeros(0, 0), positions: Vec::new() }
    }

    /// Rows with a column for every parameter.
    #[cfg(test)]
    pub fn of(jacobian: DMatrix<f64>, residual: Vec<f64>) -> Self {
        Self { residual, positions: (0..jacobian.ncols()).collect(), jacobian }
    }

    /// Resizes to `rows` rows and a column for every parameter. Residuals are 0; columns may hold earlier numbers.
    pub fn reset(&mut self, rows: usize, parameters: usize) {
        self.reset_to(rows, 0..parameters);
    }

    /// Resizes to `rows` rows and columns for these parameters, in ascending order; the derivatives with respect to all others are 0.
    /// Residuals are 0; columns may hold earlier numbers.
    pub fn reset_to(&mut self, rows: usize, parameters: impl IntoIterator<Item = usize>) {
        self.residual.clear();
        self.residual.resize(rows, 0.0);
        self.positions.clear();
        self.positions.extend(parameters);
        if self.jacobian.shape() != (rows, self.positions.len()) {
            self.jacobian = DMatrix::zeros(rows, self.positions.len());
        }
    }

    /// Parameter of every column, in ascending order.
    pub fn positions(&self) -> &[usize] {
        &self.positions
    }

    /// The derivatives, one row for every residual.
    pub fn jacobian(&self) -> &DMatrix<f64> {
        &self.jacobian
    }

    /// Column `k` of the derivatives in some rows.
    pub fn column(&mut self, k: usize, rows: Range<usize>) -> &mut [f64] {
        &mut column_mut(&mut self.jacobian, k)[rows]
    }

    /// Stores the first lanes of a residual component and of its derivatives in these rows.
    pub(super) fn store_rows(&mut self, rows: Range<usize>, residual: &Row, derivatives: &[Row]) {
        let count = rows.len();
        self.residual[rows.clone()].copy_from_slice(&residual.0[..count]);
        for (j, derivative) in derivatives.iter().enumerate() {
            self.column(j, rows.clone()).copy_from_slice(&derivative.0[..count]);
        }
    }
}

/// Divides samples into at most `most` parts of chunks with at most `largest` samples.
fn parts(samples: Range<usize>, most: usize, largest: usize) -> Vec<Vec<Range<usize>>> {
    let chunk = largest.min(samples.len().div_ceil(most).next_multiple_of(WIDTH)).max(WIDTH);
    let chunks: Vec<_> =
        samples.clone().step_by(chunk).map(|start| start..samples.end.min(start + chunk)).collect();
    let per_part = chunks.len().div_ceil(most).max(1);
    chunks.chunks(per_part).map(<[_]>::to_vec).collect()
}

/// Number of parts, each with a JᵀJ of p² entries.
fn parts_with_gram(samples: usize, p: usize) -> usize {
    let fit = GRAM_NUMBERS / (p * p).max(1);
    samples.div_ceil(WORTH_A_GRAM).max(FEW_PARTS).min(fit).clamp(1, PARTS)
}

/// Sum of one thread over the chunks of a part.
type Part<'a> = dyn Fn(&[Range<usize>]) -> Option<NormalEquations> + Sync + 'a;

/// Adds the sums of all parts, each computed on one thread, as a binary tree. A single thread holds at most as many
/// sums at once as the tree is deep.
fn merged(parts: &[Vec<Range<usize>>], part: &Part) -> Option<NormalEquations> {
    if let [chunks] = parts {
        return part(chunks);
    }
    let (left, right) = parts.split_at_checked(parts.len() / 2).filter(|(left, _)| !left.is_empty())?;
    let (left, right) = rayon::join(|| merged(left, part), || merged(right, part));
    let (mut total, right) = (left?, right?);
    total.merge(&right);
    Some(total)
}

/// The sum over samples in at most `most` parts, with chunks of at most `largest` samples.
fn sum(
    (samples, most, largest): (Range<usize>, usize, usize),
    zero: impl Fn() -> NormalEquations + Sync,
    add: impl Fn(&mut NormalEquations, &mut ChunkRows, Range<usize>) -> Result<(), Failed> + Sync,
) -> Option<NormalEquations> {
    let parts = parts(samples, most, largest);
    let part = |chunks: &[Range<usize>]| {
        let (mut sum, mut workspace) = (zero(), ChunkRows::new());
        chunks.iter().try_for_each(|chunk| add(&mut sum, &mut workspace, chunk.clone())).ok()?;
        Some(sum)
    };
    parallel::within(|| merged(&parts, &part))
}

/// The normal equations of some samples, without the prior; `None` if a sample cannot be evaluated.
pub(crate) fn normal_equations_of<R: Residuals>(
    residuals: &R,
    weights: &[f64],
    samples: Range<usize>,
) -> Option<NormalEquations> {
    let p = residuals.shared();
    let parts = parts_with_gram(samples.len(), p);
    sum(
        (samples, parts, residuals.chunk()),
        || NormalEquations::zero(p),
        |sum, rows, chunk| residuals.linearise(weights, chunk, rows, &mut |rows| sum.add(rows)),
    )
}

impl<R: Residuals> Objective for R {
    fn parameters(&self) -> usize {
        Residuals::parameters(self)
    }

    fn samples(&self) -> usize {
        Residuals::samples(self)
    }

    fn loss(&self, weights: &[f64]) -> f64 {
        let samples = Residuals::samples(self);
        let parts = parts(0..samples, PARTS, self.chunk());
        let sums: Vec<Result<f64, Failed>> = parallel::map(parts.len(), &|k| {
            parts[k].iter().map(|chunk| self.squares(weights, chunk.clone())).sum()
        });
        match sums.into_iter().sum::<Result<f64, Failed>>() {
            Ok(sum) if sum.is_finite() => sum / (samples * self.components()) as f64,
            _ => f64::INFINITY,
        }
    }

    fn solved(&self, weights: &[f64]) -> Solved {
        let samples = Residuals::samples(self);
        let parts = parts(0..samples, PARTS, self.chunk());
        let all = parallel::map(parts.len(), &|k| -> Vec<(f64, usize)> {
            parts[k].iter().map(|chunk| Residuals::solved(self, weights, chunk.clone())).collect()
        });
        let (squares, unsolved) =
            all.into_iter().flatten().fold((0.0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        Solved::new(squares, (samples - unsolved) * self.components(), unsolved)
    }

    fn loss_of_constant_velocity(&self) -> Option<f64> {
        let samples = Residuals::samples(self);
        let sum = self.squares_of_constant_velocity(0..samples)?;
        Some(sum / (samples * self.components()) as f64).filter(|loss| loss.is_finite())
    }

    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations> {
        let mut total = normal_equations_of(self, weights, 0..Residuals::samples(self))?;
        self.add_penalty(weights, &mut total);
        Some(total)
    }

    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations> {
        let p = Residuals::shared(self);
        let zero =
            || NormalEquations { gram: DMatrix::zeros(0, 0), gradient: vec![0.0; p], squares: 0.0, rows: 0 };
        sum((samples, PARTS, self.chunk()), zero, |sum, rows, chunk| {
            self.add_gradient(weights, chunk, rows, sum)
        })
    }

    fn project(&self, weights: &mut [f64]) {
        Residuals::project(self, weights);
    }

    fn shared(&self) -> usize {
        Residuals::shared(self)
    }

    fn weights(&self) -> usize {
        Residuals::weights(self)
    }

    fn enter(&self, weights: Vec<f64>) -> Vec<f64> {
        Residuals::enter(self, weights)
    }

    fn settle(&self, weights: &mut [f64]) -> bool {
        Residuals::settle(self, weights)
    }

    fn completed_loss(&self, weights: &mut [f64]) -> f64 {
        Residuals::completed_loss(self, weights)
    }

    fn held_back_loss(&self, weights: &[f64]) -> f64 {
        Residuals::held_back_loss(self, weights).unwrap_or_else(|| self.loss(weights))
    }

    fn is_of_many_units(&self) -> bool {
        Residuals::is_of_many_units(self)
    }

    fn tolerance(&self) -> f64 {
        Residuals::tolerance(self)
    }

    fn limits(&self) -> &[[f64; 2]] {
        Residuals::limits(self)
    }

    fn bounds(&self) -> &Bounds {
        Residuals::bounds(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residual of sample k at weights w: r = w₀ + k w₁.
    struct Line;

    impl Residuals for Line {
        fn parameters(&self) -> usize {
            2
        }
        fn samples(&self) -> usize {
            10_001
        }
        fn components(&self) -> usize {
            1
        }
        fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
            Ok(samples.map(|k| (weights[0] + k as f64 * weights[1]).powi(2)).sum())
        }
        fn linearise(
            &self,
            weights: &[f64],
            samples: Range<usize>,
            rows: &mut ChunkRows,
            add: &mut dyn FnMut(&ChunkRows),
        ) -> Result<(), Failed> {
            rows.reset(samples.len(), 2);
            for (row, k) in samples.enumerate() {
                rows.residual[row] = weights[0] + k as f64 * weights[1];
                rows.column(0, row..row + 1)[0] = 1.0;
                rows.column(1, row..row + 1)[0] = k as f64;
            }
            add(rows);
            Ok(())
        }
    }

    #[test]
    fn sums_are_the_same_bits_on_any_number_of_threads() {
        let weights = [0.1, -0.7];
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let both =
                || (Line.normal_equations(&weights).unwrap(), Line.gradient(&weights, 3..9_000).unwrap());
            let (equations, gradient) = pool.install(both);
            let mut numbers = vec![equations.squares, gradient.squares, pool.install(|| Line.loss(&weights))];
            numbers.extend([equations.gram[(0, 0)], equations.gram[(1, 0)], equations.gram[(1, 1)]]);
            numbers.extend(equations.gradient.iter().chain(&gradient.gradient));
            (numbers, equations.rows, gradient.rows)
        };
        let one = on(1);
        assert_eq!((one.1, one.2), (10_001, 8_997));
        let exact: f64 = (0..10_001).map(|k| f64::from(k).powi(2)).sum();
        assert!((one.0[5] / exact - 1.0).abs() < 1e-13, "{:?}", one.0);
        for threads in [2, 3, 7, 16] {
            assert_eq!(on(threads), one, "{threads}");
        }
    }

    #[test]
    fn many_threads_help_and_memory_is_bounded() {
        assert_eq!(parts_with_gram(100_000, 692), PARTS);
        assert_eq!(parts_with_gram(10_000, 692), 20);
        assert_eq!(parts_with_gram(1_000, 692), FEW_PARTS);
        assert_eq!((parts_with_gram(10_000, 4_096), parts_with_gram(10_000, 100_000)), (8, 1));
        for samples in [1, 7, 63, 500, 10_001] {
            for most in [1, 8, PARTS] {
                let parts = parts(0..samples, most, CHUNK);
                assert!(parts.len() <= most);
                let all: Vec<usize> = parts.into_iter().flatten().flatten().collect();
                assert_eq!(all, (0..samples).collect::<Vec<_>>(), "{samples} {most}");
            }
        }
        assert!(parts(0..10_001, PARTS, CHUNK).len() > 40);
    }
}
