//! The models to be learned, and the training.

use leastaction_core::model::ModelError;
use leastaction_ground_truth::{LgnnSystem, lgnn_graph};
use leastaction_learning::training::{Levenberg, LossKind, Samples, objective};
use leastaction_models::GraphArchitecture;

/// Inverse of the fraction of the samples that are held back for validation.
pub(super) const JUDGES: usize = 4;
/// Mean squared error, relative to the mean square, that counts as rounding.
const ROUNDING: f64 = 1e-26;

/// A trained model.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedGraph {
    /// Shape of the model.
    pub architecture: GraphArchitecture,
    /// Weight block of the model.
    pub weights: Vec<f64>,
}

impl LearnedGraph {
    /// Returns the model with the same node and edge types on another graph.
    #[must_use]
    pub fn on(&self, system: LgnnSystem) -> Self {
        Self { architecture: self.architecture.with_graph(lgnn_graph(system)), weights: self.weights.clone() }
    }
}

/// Learns from accelerations by Levenberg–Marquardt on three quarters of the samples: first the simple laws alone, then
/// with the networks beside them. Keeps the weights that are best on the fourth quarter. `watch` is called with the
/// iteration and the loss. Also returns the mean squared errors on both parts.
pub fn train(
    architecture: GraphArchitecture,
    samples: &Samples,
    iterations: usize,
    seed: u64,
    mut watch: impl FnMut(usize, f64),
) -> Result<(LearnedGraph, [f64; 2]), ModelError> {
    let [rows, judges] = samples.shuffled(seed).split(samples.len() / JUDGES);
    let error = |shape: &GraphArchitecture, samples: &Samples| {
        objective(&shape.clone().into(), samples.clone(), LossKind::Acceleration, 2)
    };
    let (objective, judge) = (error(&architecture, &rows)?, error(&architecture, &judges)?);
    let mut best = Vec::new();
    let mut weights = architecture.beginning(seed);
    if let Some(laws) = architecture.laws_alone() {
        let (objective, judge) = (error(&laws, &rows)?, error(&laws, &judges)?);
        weights = Levenberg::new(&*objective, weights).best(&*objective, &*judge, iterations, |_, _| ());
        best.push(architecture.with_corrections_scaled(weights.clone(), 0.0));
    }
    // If the laws explain everything, networks could only learn rounding errors.
    let rounding = ROUNDING * samples.mean_square();
    if best.first().is_none_or(|laws| judge.loss(laws) > rounding) {
        let start = Levenberg::new(&*objective, weights);
        best.push(
            start.best(&*objective, &*judge, iterations, |iteration, state| watch(iteration, state.loss)),
        );
    }
    let loss = |weights: &Vec<f64>| judge.loss(weights);
    let weights = best.into_iter().min_by(|a, b| loss(a).total_cmp(&loss(b))).unwrap_or_default();
    let errors = [objective.loss(&weights), judge.loss(&weights)];
    Ok((LearnedGraph { architecture, weights }, errors))
}
