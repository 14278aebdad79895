//! Inertia and potential of a model at rest.

use crate::Model;
use leastaction_core::model::ModelError;
use leastaction_programs::dynamics::Accelerations;
use leastaction_programs::{Row, WIDTH};

/// Properties of a model at a position, at rest and without control.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// Inertia matrix M, \[n\]\[n\], flat.
    pub mass: Vec<f64>,
    /// Slope of the potential ∂V/∂q = −M v̇, N or N m.
    pub slope: Vec<f64>,
}

impl Model {
    /// Inertia and slope of the potential at each of these positions.
    ///
    /// # Errors
    /// An error if the shape is inconsistent or the weights do not fit it.
    pub fn at_rest(&self, positions: &[&[f64]]) -> Result<Vec<AtRest>, ModelError> {
        let (system, weights) = (self.system()?, &self.weights);
        let n = system.n();
        let (mut accelerations, zero) = (Accelerations::new(&system), vec![Row::default(); n]);
        let (mut all, mut a) = (Vec::new(), zero.clone());
        for block in positions.chunks(WIDTH) {
            let at = |lane: usize, i: usize| block.get(lane).or(block.last()).map_or(0.0, |q| q[i]);
            let q: Vec<Row> = (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect();
            // If M is singular, there are no accelerations, and therefore no slope.
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
