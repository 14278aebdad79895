//! What a model is where nothing moves: its inertia and its potential.

use crate::Model;
use leastaction_core::model::ModelError;
use leastaction_programs::dynamics::Accelerations;
use leastaction_programs::{Row, WIDTH};

/// A model at a position, at rest and without control.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// M, \[n\]\[n\], flat.
    pub mass: Vec<f64>,
    /// ∂V/∂q = −M v̇, N or N m.
    pub slope: Vec<f64>,
}

impl Model {
    /// Inertia and slope of the potential at every one of these positions.
    ///
    /// # Errors
    /// Where the shape does not fit in itself or the weights.
    pub fn at_rest(&self, positions: &[&[f64]]) -> Result<Vec<AtRest>, ModelError> {
        let (system, weights) = (self.system()?, &self.weights);
        let n = system.n();
        let (mut accelerations, zero) = (Accelerations::new(&system), vec![Row::default(); n]);
        let (mut all, mut a) = (Vec::new(), zero.clone());
        for block in positions.chunks(WIDTH) {
            let at = |lane: usize, i: usize| block.get(lane).or(block.last()).map_or(0.0, |q| q[i]);
            let q: Vec<Row> = (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect();
            // Where M is singular there are no accelerations, and so no slope.
            let _failures = accelerations.evaluate(weights, [&q, &zero, &zero], &mut a, None);
            all.extend((0..block.len()).map(|lane| {
                let mass: Vec<f64> = (0..n * n).map(|k| accelerations.mass(k / n, k % n).0[lane]).collect();
                let slope = |i: usize| -(0..n).map(|j| mass[i * n + j] * a[j].0[lane]).sum::<f64>();
                AtRest { slope: (0..n).map(slope).collect(), mass }
            }));
        }
        Ok(all)
    }
}
