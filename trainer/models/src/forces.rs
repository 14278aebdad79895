//! Forces of a model in addition to those of its energies: friction by formulas and by networks.

use crate::Model;
use leastaction_core::model::ModelError;
use leastaction_programs::{Row, WIDTH};

/// A state with its control force.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// Position q, m or rad.
    pub q: Vec<f64>,
    /// Velocity v, m/s or rad/s.
    pub v: Vec<f64>,
    /// Control force τ, N or N m.
    pub tau: Vec<f64>,
}

impl Model {
    /// Forces Q(q, v, τ) in addition to the control, N or N m, at each of these states.
    ///
    /// # Errors
    /// An error if the shape is inconsistent or the weights do not fit it.
    pub fn forces_at(&self, states: &[Driven]) -> Result<Vec<Vec<f64>>, ModelError> {
        let (system, weights) = (self.system()?, &self.weights);
        let (n, program) = (system.n(), system.force());
        let (mut workspace, mut all) = (program.workspace(), Vec::new());
        for block in states.chunks(WIDTH) {
            let rows = |of: &dyn Fn(&Driven) -> &[f64]| -> Vec<Row> {
                let at = |lane: usize, i: usize| {
                    block.get(lane).or(block.last()).map_or(0.0, |state| of(state)[i])
                };
                (0..n).map(|i| Row(std::array::from_fn(|lane| at(lane, i)))).collect()
            };
            let [q, v, tau] = [rows(&|of| &of.q), rows(&|of| &of.v), rows(&|of| &of.tau)];
            program.run_outputs(weights, &[&q, &v, &tau], &mut workspace);
            let force = workspace.output(0);
            all.extend((0..block.len()).map(|lane| force.iter().map(|row| row.0[lane]).collect()));
        }
        Ok(all)
    }
}
