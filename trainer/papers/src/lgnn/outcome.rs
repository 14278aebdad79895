//! Results of an experiment, and reasons why it fails.

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
    /// Length of a rollout, s.
    pub rollout_seconds: f64,
    /// Number of starts.
    pub starts: usize,
    /// Geometric mean of the rollout error.
    pub rollout_error: f64,
    /// Geometric mean of the rollout error at the end.
    pub last_rollout_error: f64,
    /// Geometric mean of the energy violation.
    pub energy_violation: f64,
    /// Number of rollouts that could not be followed to the end.
    pub failed: usize,
    /// Geometric mean of the rollout error of exact motion from starts that are off by 1e-8 m.
    pub floor_rollout_error: f64,
    /// Geometric mean of the energy violation of this motion.
    pub floor_energy_violation: f64,
}

/// Results of one row of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Experiment of the row.
    pub case: Case,
    /// Kind of system.
    pub system: &'static str,
    /// Number of nodes.
    pub count: usize,
    /// Drag of the system, N s/m.
    pub drag: f64,
    /// Pull on the second node, N.
    pub pull: f64,
    /// `trained` on this system, or `zero-shot`.
    pub kind: &'static str,
    /// Name of the model: `ours`, or that of a baseline as in [`Baseline::title`](super::Baseline::title).
    pub model: &'static str,
    /// Number of samples learned from.
    pub samples: usize,
    /// Number of learned entries of the weight block.
    pub parameters: usize,
    /// Mean squared error of accelerations on training samples.
    pub train_mse: f64,
    /// Mean squared error of accelerations on held-back samples.
    pub validation_mse: f64,
    /// Training time, s.
    pub train_seconds: f64,
    /// Seed of the weights and of the data.
    pub seed: u64,
    /// Number of epochs of Adam; `None` for Levenberg–Marquardt.
    pub epochs: Option<u64>,
    /// End of the training in words; null if it was complete.
    #[serde(rename = "stopped", serialize_with = "in_words")]
    pub ending: Ending,
    /// Results of the rollouts.
    #[serde(flatten)]
    pub rolled_out: Option<RolledOut>,
    /// Largest error of the learned drag over the velocities in the data, relative to the exact drag.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag_error: Option<f64>,
    /// Time of one step of order 2, µs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_microseconds: Option<f64>,
    /// Rollouts over time, with the time between comparisons, s.
    #[serde(skip)]
    pub pictured: Option<(f64, Rollouts)>,
    /// Learned terms, beside the true ones.
    #[serde(skip)]
    pub insight: Insight,
    /// Results of the paper.
    #[serde(skip)]
    pub published: Published,
}

impl Outcome {
    /// Creates the row of a model that is to be trained on a system.
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

/// Reason why an experiment fails.
#[derive(Debug, Error)]
pub enum ReproduceError {
    /// The data cannot be generated.
    #[error(transparent)]
    Data(#[from] GenerationError),
    /// The shape is inconsistent or does not fit the data.
    #[error(transparent)]
    LearnedGraph(#[from] ModelError),
    /// A model that the paper compares with cannot be trained.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// The exact motion cannot be followed.
    #[error(transparent)]
    ExactMotion(#[from] IntegrationError),
    /// The graph is invalid.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The rods are invalid.
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
