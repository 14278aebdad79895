//! Sums over samples: fixed parts, each computed in order on one thread, added in order. Results do not depend on the
//! number of threads.

use super::{NormalEquations, Objective};
use crate::parallel;
use faer::Mat;
use leastaction_programs::{Row, WIDTH};
use std::ops::Range;

/// Samples whose rows are multiplied at once; not a power of two, for columns of the Jacobian would then share cache lines.
const CHUNK: usize = 240;
/// Parts whose sums are computed apart: as many threads as this can help.
const PARTS: usize = 8;

/// The residual of one sample could not be computed at these weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failed;

/// The residuals of samples and their derivatives in the weights, chunk by chunk: all that an [`Objective`] is made of,
/// whatever the model.
pub trait Residuals: Sync {
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// Samples.
    fn samples(&self) -> usize;
    /// Residual components of a sample.
    fn components(&self) -> usize;
    /// The sum of squared residuals of a chunk.
    ///
    /// # Errors
    /// Where one cannot be computed.
    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed>;
    /// Samples of a chunk that cannot be computed and count as predicted by a constant velocity.
    fn unsolved(&self, _weights: &[f64], _samples: Range<usize>) -> usize {
        0
    }
    /// Residuals and their derivatives of a chunk: component i of sample k is row i · samples + k.
    ///
    /// # Errors
    /// Where one cannot be computed.
    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed>;
    /// Adds Jᵀr and rᵀr of a chunk alone.
    ///
    /// # Errors
    /// Where one cannot be computed.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        self.linearise(weights, samples, rows)?;
        sum.add_gradient(&rows.jacobian, &rows.residual);
        Ok(())
    }
    /// As [`Objective::project`]: nothing where every number is a weight.
    fn project(&self, _weights: &mut [f64]) {}
}

/// Workspace for the rows of one chunk.
pub struct ChunkRows {
    /// r.
    pub residual: Vec<f64>,
    jacobian: Mat<f64>,
}

impl ChunkRows {
    fn new() -> Self {
        Self { residual: Vec::new(), jacobian: Mat::new() }
    }

    /// Makes room for so many rows.
    pub fn reset(&mut self, rows: usize, parameters: usize) {
        self.residual.clear();
        self.residual.resize(rows, 0.0);
        if self.jacobian.shape() != (rows, parameters) {
            self.jacobian = Mat::zeros(rows, parameters);
        }
    }

    /// A parameter's derivatives in some rows.
    pub fn column(&mut self, parameter: usize, rows: Range<usize>) -> &mut [f64] {
        &mut self.jacobian.col_as_slice_mut(parameter)[rows]
    }

    /// Stores the first numbers of a residual component and of its derivatives in these rows.
    pub(super) fn store_rows(&mut self, rows: Range<usize>, residual: &Row, derivatives: &[Row]) {
        let count = rows.len();
        self.residual[rows.clone()].copy_from_slice(&residual.0[..count]);
        for (j, derivative) in derivatives.iter().enumerate() {
            self.column(j, rows.clone()).copy_from_slice(&derivative.0[..count]);
        }
    }
}

/// The chunks of each part.
fn parts(samples: Range<usize>) -> Vec<Vec<Range<usize>>> {
    let chunk = CHUNK.min(samples.len().div_ceil(PARTS).next_multiple_of(WIDTH)).max(WIDTH);
    let chunks: Vec<_> =
        samples.clone().step_by(chunk).map(|start| start..samples.end.min(start + chunk)).collect();
    let per_part = chunks.len().div_ceil(PARTS).max(1);
    chunks.chunks(per_part).map(<[_]>::to_vec).collect()
}

/// Sums over parts: each on one thread, merged in order.
fn sum(
    samples: Range<usize>,
    zero: impl Fn() -> NormalEquations + Sync,
    add: impl Fn(&mut NormalEquations, &mut ChunkRows, Range<usize>) -> Result<(), Failed> + Sync,
) -> Option<NormalEquations> {
    let parts = parts(samples);
    let sums: Vec<Option<NormalEquations>> = parallel::map(parts.len(), &|k| {
        let (mut sum, mut workspace) = (zero(), ChunkRows::new());
        parts[k].iter().try_for_each(|chunk| add(&mut sum, &mut workspace, chunk.clone())).ok()?;
        Some(sum)
    });
    sums.into_iter().reduce(|total, part| {
        let (mut total, part) = (total?, part?);
        total.merge(&part);
        Some(total)
    })?
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
        let parts = parts(0..samples);
        let sums: Vec<Result<f64, Failed>> = parallel::map(parts.len(), &|k| {
            parts[k].iter().map(|chunk| self.squares(weights, chunk.clone())).sum()
        });
        match sums.into_iter().sum::<Result<f64, Failed>>() {
            Ok(sum) if sum.is_finite() => sum / (samples * self.components()) as f64,
            _ => f64::INFINITY,
        }
    }

    fn unsolved(&self, weights: &[f64]) -> usize {
        let parts = parts(0..Residuals::samples(self));
        let counts = parallel::map(parts.len(), &|k| -> usize {
            parts[k].iter().map(|chunk| Residuals::unsolved(self, weights, chunk.clone())).sum()
        });
        counts.into_iter().sum()
    }

    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations> {
        let p = weights.len();
        sum(
            0..Residuals::samples(self),
            || NormalEquations::zero(p),
            |sum, rows, chunk| {
                self.linearise(weights, chunk, rows)?;
                sum.add(&rows.jacobian, &rows.residual);
                Ok(())
            },
        )
    }

    fn gradient(&self, weights: &[f64], samples: Range<usize>) -> Option<NormalEquations> {
        let p = weights.len();
        let zero = || NormalEquations { gram: Mat::new(), gradient: vec![0.0; p], squares: 0.0, rows: 0 };
        sum(samples, zero, |sum, rows, chunk| self.add_gradient(weights, chunk, rows, sum))
    }

    fn project(&self, weights: &mut [f64]) {
        Residuals::project(self, weights);
    }
}
