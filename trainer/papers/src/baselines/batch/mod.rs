//! Tanh networks over many samples at once.
//!
//! With only eight samples side by side, every weight that is read is used for eight products, and the derivatives of
//! layers with hundreds of units do not fit in a cache. In a chunk of hundreds of samples, layers are matrix products,
//! which run at the full speed of the processor.

mod layers;

pub(super) use layers::{Adjoint, Derivatives, Layers, Pass};

use super::parameters_of;
use leastaction_learning::matrix::column;
use leastaction_learning::training::{ChunkRows, Failed, NormalEquations, Residuals};
use nalgebra::DMatrix;
use std::ops::Range;

/// Residuals r of samples that are computed together, all by the same network.
pub(super) trait Batched: Sync {
    /// Intermediate results of the residuals, for their derivatives.
    type Trace;
    /// Numbers of inputs, of units of the hidden layers, and of outputs.
    fn units(&self) -> [usize; 4];
    /// Number of samples.
    fn samples(&self) -> usize;
    /// Number of residual components of a sample.
    fn components(&self) -> usize;
    /// Residuals r: \[samples\]\[components\].
    fn residuals(&self, layers: &Layers, samples: &Range<usize>) -> (Self::Trace, DMatrix<f64>);
    /// Passes Σᵢ yᵢ ∂rᵢ/∂θ of every sample to `then`, with y \[samples\]\[components\].
    fn derive(
        &self,
        layers: &Layers,
        trace: (&Self::Trace, &Range<usize>),
        y: &DMatrix<f64>,
        then: impl FnOnce(&Derivatives),
    );
}

/// Arranges numbers in rows of `width`.
pub(super) fn matrix(values: &[f64], width: usize) -> DMatrix<f64> {
    DMatrix::from_fn(values.len() / width, width, |k, i| values[k * width + i])
}

fn layers(batched: &impl Batched, weights: &[f64]) -> Result<Layers, Failed> {
    Layers::take(weights, &batched.units()).ok_or(Failed)
}

/// Residuals that are computed together, as the optimisers see them.
pub(super) struct InBatches<B>(pub B);

impl<B: Batched> Residuals for InBatches<B> {
    fn parameters(&self) -> usize {
        parameters_of(&self.0.units())
    }

    fn samples(&self) -> usize {
        self.0.samples()
    }

    fn components(&self) -> usize {
        self.0.components()
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        Ok(self.0.residuals(&layers(&self.0, weights)?, &samples).1.norm_squared())
    }

    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        let (count, components) = (samples.len(), self.0.components());
        let layers = layers(&self.0, weights)?;
        let (trace, residuals) = self.0.residuals(&layers, &samples);
        rows.reset(count * components, weights.len());
        for i in 0..components {
            let range = i * count..(i + 1) * count;
            rows.residual[range.clone()].copy_from_slice(column(&residuals, i));
            let y = DMatrix::from_fn(count, components, |_, k| f64::from(u8::from(k == i)));
            self.0.derive(&layers, (&trace, &samples), &y, |each| layers.fill(each, rows, range));
        }
        add(rows);
        Ok(())
    }

    /// Adds the gradient without the Jacobian.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        _: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        let layers = layers(&self.0, weights)?;
        let (trace, residuals) = self.0.residuals(&layers, &samples);
        sum.squares += residuals.norm_squared();
        sum.rows += samples.len() * self.0.components();
        self.0.derive(&layers, (&trace, &samples), &residuals, |each| {
            layers.add_gradient(each, &mut sum.gradient);
        });
        Ok(())
    }
}
