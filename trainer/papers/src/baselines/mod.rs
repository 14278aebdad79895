//! Baselines of the papers: models without the structure that is learned here, trained by the same optimisers on the same samples.

mod batch;
mod cartesian_lnn;
mod direct;
mod features;
mod gns;
mod graph_network;
mod hnn;
mod lagrangian;
mod lgn;
mod lnn;
mod mlp;
mod node;
#[cfg(test)]
pub(crate) mod oracle;

pub use cartesian_lnn::CartesianLnn;
pub use gns::Gns;
pub use graph_network::GraphSizes;
pub use hnn::{Hnn, Momenta};
pub use lgn::Lgn;
pub use lnn::Lnn;
pub use mlp::Mlp;
pub use node::NeuralOde;

use crate::training::is_past;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::ExactMotion;
use leastaction_learning::evaluate::prediction::{Prediction, Truth};
use leastaction_learning::training::{LossKind, Objective, Samples, objective};
use leastaction_models::accelerations::Accelerations;
use leastaction_models::{Architecture, Family, Model, ModularArchitecture};
use std::time::Instant;

/// A model whose weights are learned from accelerations: a baseline, or one of ours.
pub trait AccelerationModel {
    /// Random weights.
    fn initial_weights(&self, seed: u64) -> Vec<f64>;

    /// Mean squared error of v̇ over samples of (q, v, v̇), the measure by which all models are compared.
    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError>;

    /// Objective of the training over the same samples: the common measure, unless the model's authors use another one.
    fn training(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        self.objective(samples)
    }
}

/// A model whose long predictions are compared with exact motion.
pub trait PredictionModel: AccelerationModel {
    /// Errors of long predictions from the starts of `truth`.
    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError>;
}

/// A model whose accelerations can be evaluated.
pub trait MotionModel: AccelerationModel {
    /// Returns v̇(q, v) for these weights, m/s², \[nodes\]\[D\], as a function.
    fn motion<'w>(&self, weights: &'w [f64]) -> Result<Box<Accelerations<'w>>, ModelError>;
}

/// Settings for following predictions.
#[derive(Clone, Copy)]
pub struct Follow<'a> {
    /// Exact motion, which gives the energies.
    pub motion: &'a dyn ExactMotion,
    /// Error per step, relative to 1 + |x|.
    pub tolerance: f64,
    /// Time at which to give up: predictions that have not reached the end by then count as failed.
    pub deadline: Option<Instant>,
}

impl Follow<'_> {
    /// Whether it is time to give up.
    pub fn is_late(&self) -> bool {
        is_past(self.deadline)
    }

    /// Errors of predictions by accelerations v̇(q, v).
    fn compare(
        &self,
        truth: &Truth,
        acceleration: impl Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync,
    ) -> Prediction {
        truth.compare(self.tolerance, self.motion, |q, v, out| match self.is_late() {
            true => None,
            false => acceleration(q, v, out),
        })
    }
}

/// Numbers of inputs and outputs of every layer of a network with these units, inputs and outputs included.
fn layers_of(units: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    units.iter().copied().zip(units.iter().copied().skip(1))
}

/// Length of the weight block of such a network, in numbers.
fn parameters_of(units: &[usize]) -> usize {
    layers_of(units).map(|(inputs, outputs)| (inputs + 1) * outputs).sum()
}

/// Refuses samples with another number of coordinates.
fn coordinates_fit(samples: &Samples, n: usize) -> Result<(), ModelError> {
    let error = ModelError::Shape { what: "coordinates", found: samples.n, compiled: n };
    if samples.n == n { Ok(()) } else { Err(error) }
}

/// Refuses fewer weights than needed.
fn enough_weights(weights: &[f64], needed: usize) -> Result<(), ModelError> {
    let error = ModelError::Shape { what: "weights", found: weights.len(), compiled: needed };
    if weights.len() < needed { Err(error) } else { Ok(()) }
}

impl AccelerationModel for ModularArchitecture {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        Family::initial_weights(self, seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        objective(&self.clone().into(), samples, LossKind::Acceleration, 2)
    }
}

impl PredictionModel for ModularArchitecture {
    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        let model = Model::new(Architecture::from(self.clone()), weights.to_vec());
        model.with_accelerations(|accelerations| follow.compare(truth, accelerations))
    }
}
