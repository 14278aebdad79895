//! What the papers compare with: models without the structure that is learned here, trained by the same optimisers on the
//! same samples.

mod mlp;
mod node;

pub use mlp::{MAX_WIDTH as MAX_MLP_WIDTH, Mlp};
pub use node::Node;

use crate::architecture::{GraphArchitecture, ModularArchitecture};
use crate::training::{LossKind, Objective, Samples, objective};
use leastaction_core::model::ModelError;

/// A shape whose weights are learned from accelerations: a baseline, or one of ours.
pub trait AccelerationModel {
    /// Random weights.
    fn initial_weights(&self, seed: u64) -> Vec<f64>;

    /// The mean squared error of v̇ over samples of (q, v, v̇).
    ///
    /// # Errors
    /// Where the shape is beyond what is compiled.
    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError>;
}

impl AccelerationModel for ModularArchitecture {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        self.initial_weights(seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        objective(&self.clone().into(), samples, LossKind::Acceleration, 2)
    }
}

impl AccelerationModel for GraphArchitecture {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        self.initial_weights(seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        objective(&self.clone().into(), samples, LossKind::Acceleration, 2)
    }
}
