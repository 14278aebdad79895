//! The squared error of accelerations over samples.

use super::{Gns, Pass};
use leastaction::training::{ChunkRows, Failed, NormalEquations, Residuals};
use leastaction_core::scalar::{LANES, Lanes};
use std::ops::Range;

/// The errors of v̇ over fixed inputs.
pub(super) struct Regression {
    pub model: Gns,
    /// \[samples\]\[inputs\], flat.
    pub inputs: Vec<f64>,
    /// \[samples\]\[outputs\], flat.
    pub targets: Vec<f64>,
}

impl Regression {
    /// Outputs less targets of the samples from `start` on, and their pass; that before `end` fills the group up.
    fn errors(&self, weights: &[f64], [start, end]: [usize; 2]) -> Result<(Pass<Lanes>, Vec<Lanes>), Failed> {
        let networks = self.model.networks(weights).ok_or(Failed)?;
        let pass = self.model.pass(&networks, &group(&self.inputs, self.model.inputs(), start, end));
        let mut errors = vec![Lanes([0.0; LANES]); self.model.outputs()];
        pass.accelerations(&mut errors);
        let targets = group(&self.targets, errors.len(), start, end);
        errors.iter_mut().zip(targets).for_each(|(y, target)| *y -= target);
        Ok((pass, errors))
    }
}

impl Residuals for Regression {
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
        let mut sum = 0.0;
        for start in samples.clone().step_by(LANES) {
            let (_, errors) = self.errors(weights, [start, samples.end])?;
            sum += errors.iter().map(|error| squares(error, samples.end - start)).sum::<f64>();
        }
        Ok(sum)
    }

    fn linearise(&self, weights: &[f64], samples: Range<usize>, rows: &mut ChunkRows) -> Result<(), Failed> {
        let (count, n) = (samples.len(), self.model.outputs());
        rows.reset(count * n, weights.len());
        let mut y_bar = vec![Lanes([0.0; LANES]); n];
        for start in samples.clone().step_by(LANES) {
            let own = (samples.end - start).min(LANES);
            let (pass, errors) = self.errors(weights, [start, samples.end])?;
            for (i, error) in errors.into_iter().enumerate() {
                y_bar.fill(Lanes([0.0; LANES]));
                y_bar[i] = Lanes([1.0; LANES]);
                rows.fill((i * count + start - samples.start, own), &error, |row| {
                    self.model.adjoint(weights, &pass, &y_bar, row).ok_or(Failed)
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
        for start in samples.clone().step_by(LANES) {
            let (pass, mut errors) = self.errors(weights, [start, samples.end])?;
            for error in &mut errors {
                *error = first(error, samples.end - start);
                sum.squares += squares(error, LANES);
            }
            self.model.adjoint(weights, &pass, &errors, &mut rows.buffer).ok_or(Failed)?;
        }
        sum.add_lanes(&rows.buffer, samples.len() * self.model.outputs());
        Ok(())
    }
}

/// Eight samples from `start` on, of rows of `width` numbers; that before `end` fills the group up.
fn group(values: &[f64], width: usize, start: usize, end: usize) -> Vec<Lanes> {
    let sample = |lane: usize| (start + lane).min(end - 1);
    (0..width).map(|i| Lanes(std::array::from_fn(|lane| values[sample(lane) * width + i]))).collect()
}

/// The first `count` lanes, squared and added.
fn squares(residual: &Lanes, count: usize) -> f64 {
    residual.0.iter().take(count.min(LANES)).map(|r| r * r).sum()
}

/// The first `count` lanes; 0 in the others, which fill a group up.
fn first(lanes: &Lanes, count: usize) -> Lanes {
    Lanes(std::array::from_fn(|lane| if lane < count { lanes.0[lane] } else { 0.0 }))
}
