//! What an experiment gives, and why it cannot be done.

use super::super::training::{Ending, TrainingError, in_words};
use super::{Case, Insight, Published};
use leastaction_core::constraints::ConstraintError;
use leastaction_core::energy::graph::GraphError;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{GenerationError, IntegrationError, LgnnSystem};
use leastaction_learning::evaluate::rollouts::Rollouts;
use serde::Serialize;
use thiserror::Error;

/// Rollouts in the paper's measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RolledOut {
    /// Length, s.
    pub rollout_seconds: f64,
    /// Starts.
    pub starts: usize,
    /// Geometric mean of the rollout error.
    pub rollout_error: f64,
    /// The same at the end.
    pub last_rollout_error: f64,
    /// Geometric mean of the energy violation.
    pub energy_violation: f64,
    /// Rollouts that could not be followed to the end.
    pub failed: usize,
    /// Geometric mean of the rollout error of exact motion from starts that are off by 1e-8.
    pub floor_rollout_error: f64,
    /// The same of the energy violation.
    pub floor_energy_violation: f64,
}

/// What one row of a table gives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The experiment.
    pub case: Case,
    /// The kind of system.
    pub system: &'static str,
    /// Nodes.
    pub count: usize,
    /// Drag of the system, N s/m.
    pub drag: f64,
    /// Pull on the second node, N.
    pub pull: f64,
    /// `trained` on this system, or `zero-shot`.
    pub kind: &'static str,
    /// `ours`, or a baseline as in [`Baseline::title`](super::Baseline::title).
    pub model: &'static str,
    /// Samples learned from.
    pub samples: usize,
    /// Numbers in the weight block that are learned.
    pub parameters: usize,
    /// Mean squared error of accelerations, training samples.
    pub train_mse: f64,
    /// The same, samples held back.
    pub validation_mse: f64,
    /// Training time, s.
    pub train_seconds: f64,
    /// Of the weights and of the data.
    pub seed: u64,
    /// Epochs of Adam; none by Levenberg–Marquardt.
    pub epochs: Option<u64>,
    /// How training ended, in words; null where it was complete.
    #[serde(rename = "stopped", serialize_with = "in_words")]
    pub ending: Ending,
    /// Rollouts.
    #[serde(flatten)]
    pub rolled_out: Option<RolledOut>,
    /// Largest error of the learned drag over the velocities in the data, relative to the exact one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag_error: Option<f64>,
    /// One step of order 2, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_microseconds: Option<f64>,
    /// The rollouts over time, with the time between comparisons, s.
    #[serde(skip)]
    pub pictured: Option<(f64, Rollouts)>,
    /// What was learned, beside the truth.
    #[serde(skip)]
    pub insight: Insight,
    /// The paper's.
    #[serde(skip)]
    pub published: Published,
}

impl Outcome {
    /// Of a model that is trained on a system, before it is.
    pub(super) fn trained(case: Case, system: LgnnSystem, seed: u64) -> Self {
        Self {
            case,
            system: system.name(),
            count: system.nodes(),
            drag: 0.0,
            pull: 0.0,
            kind: "trained",
            model: "ours",
            samples: 0,
            parameters: 0,
            train_mse: f64::NAN,
            validation_mse: f64::NAN,
            train_seconds: 0.0,
            seed,
            epochs: None,
            ending: Ending::Complete,
            rolled_out: None,
            drag_error: None,
            step_microseconds: None,
            pictured: None,
            insight: Insight::default(),
            published: Published::default(),
        }
    }
}

/// An experiment that cannot be done.
#[derive(Debug, Error)]
pub enum ReproduceError {
    /// There is no data.
    #[error(transparent)]
    Data(#[from] GenerationError),
    /// The shape does not fit in itself or the data.
    #[error(transparent)]
    LearnedGraph(#[from] ModelError),
    /// A model that the paper compares with cannot be trained.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// The exact motion cannot be followed.
    #[error(transparent)]
    ExactMotion(#[from] IntegrationError),
    /// The graph cannot be.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The rods cannot be.
    #[error("the rods cannot be: {0:?}")]
    Rods(ConstraintError<f64>),
    /// The data has no accelerations.
    #[error(transparent)]
    Samples(#[from] leastaction_learning::training::SampleError),
}

impl From<ConstraintError<f64>> for ReproduceError {
    fn from(error: ConstraintError<f64>) -> Self {
        Self::Rods(error)
    }
}
