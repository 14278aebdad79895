//! What is learned, and how.

use crate::baselines::AccelerationModel;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::LgnnSystem;
use leastaction_ground_truth::lgnn_graph;
use leastaction_learning::training::{Levenberg, Samples};
use leastaction_models::GraphArchitecture;

/// Of 4 samples 3 are learned from, and one judges.
pub(super) const JUDGES: usize = 4;
/// Mean squared error, relative to the mean square, that is rounding.
const ROUNDING: f64 = 1e-26;

/// A trained model.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedGraph {
    /// Its shape.
    pub architecture: GraphArchitecture,
    /// Its weight block.
    pub weights: Vec<f64>,
}

impl LearnedGraph {
    /// The same nodes and edges in another graph.
    #[must_use]
    pub fn on(&self, system: LgnnSystem) -> Self {
        Self { architecture: self.architecture.with_graph(lgnn_graph(system)), weights: self.weights.clone() }
    }
}

/// Learns from accelerations by Levenberg–Marquardt on three quarters of the samples: first the simple laws alone, then with
/// the networks beside them; keeps what is best on the fourth quarter. `watch` is called with the iteration and the loss. Also
/// the mean squared errors on both.
///
/// # Errors
/// Where the shape does not fit in itself or the data.
pub fn train(
    architecture: GraphArchitecture,
    samples: &Samples,
    iterations: usize,
    seed: u64,
    mut watch: impl FnMut(usize, f64),
) -> Result<(LearnedGraph, [f64; 2]), ModelError> {
    let [rows, judges] = samples.shuffled(seed).split(samples.len() / JUDGES);
    let (objective, judge) = (architecture.objective(rows.clone())?, architecture.objective(judges.clone())?);
    let mut best = Vec::new();
    let mut weights = architecture.beginning(seed);
    if let Some(laws) = architecture.laws_alone() {
        let (objective, judge) = (laws.objective(rows)?, laws.objective(judges)?);
        weights = Levenberg::new(&*objective, weights).best(&*objective, &*judge, iterations, |_, _| ());
        best.push(architecture.with_corrections_scaled(weights.clone(), 0.0));
    }
    // Where the laws are all there is, networks could only learn rounding.
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
