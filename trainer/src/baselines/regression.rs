//! Accelerations that are outputs of networks: their squared error over samples.

use super::features::{first, group, squares};
use crate::training::{ChunkRows, Failed, NormalEquations, Residuals};
use leastaction_core::scalar::{LANES, Lanes};
use std::ops::Range;

/// Networks whose outputs are accelerations.
pub(super) trait Explicit: Sync {
    /// What the adjoint needs of a forward pass.
    type Trace: Default;
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// Numbers that are seen of a sample.
    fn inputs(&self) -> usize;
    /// Accelerations of a sample.
    fn outputs(&self) -> usize;
    /// Writes the accelerations of eight samples; `None` where the weights are too few.
    fn forward(&self, weights: &[f64], x: Vec<Lanes>, trace: &mut Self::Trace, y: &mut [Lanes])
    -> Option<()>;
    /// Adds ∂(ȳ·y)/∂θ after a forward pass with these weights; `None` where there was none.
    fn adjoint(&self, weights: &[f64], trace: &Self::Trace, y_bar: &[Lanes], row: &mut [Lanes])
    -> Option<()>;
}

/// The squared error over fixed inputs.
pub(super) struct Regression<M> {
    pub model: M,
    /// \[samples\]\[inputs\], flat.
    pub inputs: Vec<f64>,
    /// \[samples\]\[outputs\], flat.
    pub targets: Vec<f64>,
}

impl<M: Explicit> Regression<M> {
    /// Outputs less targets of the samples from `start` on; that before `end` fills the group up.
    fn errors(
        &self,
        weights: &[f64],
        trace: &mut M::Trace,
        [start, end]: [usize; 2],
    ) -> Result<Vec<Lanes>, Failed> {
        let n = self.model.outputs();
        let mut errors = vec![Lanes([0.0; LANES]); n];
        let inputs = group(&self.inputs, self.model.inputs(), start, end);
        self.model.forward(weights, inputs, trace, &mut errors).ok_or(Failed)?;
        let targets = group(&self.targets, n, start, end);
        errors.iter_mut().zip(targets).for_each(|(y, target)| *y -= target);
        Ok(errors)
    }
}

impl<M: Explicit> Residuals for Regression<M> {
    fn parameters(&self) -> usize {
        self.model.parameters()
    }

    fn samples(&self) -> usize {
        self.targets.len() / self.model.outputs()
    }

    fn components(&self) -> usize {
        self.model.outputs()
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let (mut trace, mut sum) = (M::Trace::default(), 0.0);
        for start in samples.clone().step_by(LANES) {
            let errors = self.errors(weights, &mut trace, [start, samples.end])?;
            sum += errors.iter().map(|error| squares(error, samples.end - start)).sum::<f64>();
        }
        Ok(sum)
    }

    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let (count, n) = (samples.len(), self.model.outputs());
        rows.reset(count * n, weights.len());
        let mut trace = M::Trace::default();
        let mut y_bar = vec![Lanes([0.0; LANES]); n];
        for start in samples.clone().step_by(LANES) {
            let own = (samples.end - start).min(LANES);
            let errors = self.errors(weights, &mut trace, [start, samples.end])?;
            for (i, error) in errors.into_iter().enumerate() {
                y_bar.fill(Lanes([0.0; LANES]));
                y_bar[i] = Lanes([1.0; LANES]);
                rows.fill((i * count + start - samples.start, own), &error, |row| {
                    self.model.adjoint(weights, &trace, &y_bar, row).ok_or(Failed)
                })?;
            }
        }
        Ok(())
    }

    /// Without the Jacobian: one adjoint of all outputs, weighed by the residuals.
    fn add_gradient(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        sum: &mut NormalEquations,
    ) -> Result<(), Failed> {
        rows.reset_buffer(weights.len());
        let mut trace = M::Trace::default();
        for start in samples.clone().step_by(LANES) {
            let mut errors = self.errors(weights, &mut trace, [start, samples.end])?;
            for error in &mut errors {
                *error = first(error, samples.end - start);
                sum.squares += squares(error, LANES);
            }
            self.model.adjoint(weights, &trace, &errors, &mut rows.buffer).ok_or(Failed)?;
        }
        sum.add_lanes(&rows.buffer, samples.len() * self.model.outputs());
        Ok(())
    }
}
