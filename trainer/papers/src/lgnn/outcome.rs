//! Results of an experiment.

use super::super::training::{Ending, in_words};
use super::{Case, Insight, Published};
use crate::rollouts::RolledOut;
use leastaction_ground_truth::LgnnSystem;
use leastaction_learning::evaluate::rollouts::Rollouts;
use serde::Serialize;

/// Results of one row of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    /// Reason, in words, why training ended early; null if it was complete.
    #[serde(rename = "stopped", serialize_with = "in_words")]
    pub ending: Ending,
    /// Length of a rollout, s.
    pub rollout_seconds: f64,
    /// Number of starts of the rollouts.
    pub starts: usize,
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
            kind: "trained",
            model: "ours",
            train_mse: f64::NAN,
            validation_mse: f64::NAN,
            seed,
            ..Self::default()
        }
    }
}
