//! The balance of logged torques as a sum of squares, with its scale held if the torques do not show it.

use super::blocks::Blocks;
use super::residuals::{ChunkRows, Failed, Residuals};
use super::{Bounds, NormalEquations};
use std::ops::Range;

/// Σ |M v̇ + L_vq v − L_q − Q − τ|² over samples.
///
/// Without a torque and without a known number that acts, every term of the balance is proportional to a learned
/// number, and the sum is least where all of them are 0. Such a balance gets the penalty k² s² with
/// s = (I − κ m|c|²)/(I + m|c|²) for a body whose mass or moment of inertia is known, where κ is the initial ratio of I
/// to m|c|² and k² the sum of the squared terms. The motion determines the ratios of the numbers, and this body their
/// common factor.
pub(super) struct Balance {
    blocks: Blocks,
    scale: Option<HeldScale>,
}

/// Ratio κ that is held at a body.
pub(super) struct HeldScale {
    /// Positions of m, the two coordinates of c, and I.
    body: [usize; 4],
    ratio: f64,
    /// k².
    weight: f64,
}

impl HeldScale {
    /// Holds the ratio that the body at these positions has now.
    pub fn new(body: [usize; 4], weights: &[f64], weight: f64) -> Self {
        let [m, x, y, inertia] = body.map(|at| weights[at]);
        let square = (m * (x * x + y * y)).max(f64::MIN_POSITIVE);
        Self { body, ratio: inertia / square, weight }
    }

    /// s and its derivatives by position.
    fn residual(&self, weights: &[f64]) -> (f64, [(usize, f64); 4]) {
        let [m, x, y, inertia] = self.body.map(|at| weights[at]);
        let square = m * (x * x + y * y);
        let sum = inertia + square;
        let of_inertia = (1.0 + self.ratio) * square / (sum * sum);
        let of_square = -(1.0 + self.ratio) * inertia / (sum * sum);
        let slopes =
            [of_square * (x * x + y * y), of_square * 2.0 * m * x, of_square * 2.0 * m * y, of_inertia];
        let places = std::array::from_fn(|k| (self.body[k], slopes[k]));
        ((inertia - self.ratio * square) / sum, places)
    }
}

impl Balance {
    /// The balance alone.
    pub fn new(blocks: Blocks) -> Self {
        Self { blocks, scale: None }
    }

    /// Whether the scale of the numbers is held.
    pub fn holds_scale(&self) -> bool {
        self.scale.is_some()
    }

    /// Holds the scale.
    pub fn with_scale(self, scale: HeldScale) -> Self {
        Self { scale: Some(scale), ..self }
    }
}

impl Residuals for Balance {
    fn parameters(&self) -> usize {
        Residuals::parameters(&self.blocks)
    }

    fn samples(&self) -> usize {
        Residuals::samples(&self.blocks)
    }

    fn components(&self) -> usize {
        self.blocks.components()
    }

    fn squares(&self, weights: &[f64], samples: Range<usize>) -> Result<f64, Failed> {
        let held = self.scale.as_ref().filter(|_| samples.start == 0);
        let penalty = held.map_or(0.0, |scale| scale.weight * scale.residual(weights).0.powi(2));
        Ok(self.blocks.squares(weights, samples)? + penalty)
    }

    fn linearise(
        &self,
        weights: &[f64],
        samples: Range<usize>,
        rows: &mut ChunkRows,
        add: &mut dyn FnMut(&ChunkRows),
    ) -> Result<(), Failed> {
        self.blocks.linearise(weights, samples, rows, add)
    }

    fn add_penalty(&self, weights: &[f64], sum: &mut NormalEquations) {
        let Some(scale) = &self.scale else { return };
        let (residual, slopes) = scale.residual(weights);
        let learned = slopes.into_iter().filter(|(at, _)| self.blocks.is_learned(*at));
        sum.add_square(&learned.collect::<Vec<_>>(), residual, scale.weight);
    }

    fn bounds(&self) -> &Bounds {
        Residuals::bounds(&self.blocks)
    }
}
