//! The pendulums of Finzi, Wang and Wilson (NeurIPS 2020), "Simplifying Hamiltonian and Lagrangian Neural Networks via Explicit
//! Constraints": chains in Cartesian coordinates, learned from short trajectories of positions and velocities.

mod data;
mod recipe;
mod task;

pub use data::{LENGTHS, STEP, chain, starts, training_set};
pub use recipe::architecture;
pub use task::tasks;

use super::lgnn::train;
use super::rollouts::{RolledOut, UNSEEN};
use super::task::{TaskError, Tell, watch};
use leastaction_core::energy::graph::Graph;
use leastaction_core::particles::Particles;
use leastaction_ground_truth::{GenerationError, Horizon, Truss};
use leastaction_learning::evaluate::prediction::Truth;
use leastaction_learning::evaluate::rollouts::{Compared, Rollouts};
use leastaction_learning::training::Samples;
use leastaction_models::particles::Driven;
use leastaction_models::{Family as _, HostTypes};
use serde::Serialize;
use std::time::Instant;

/// Settings for learning and judging a chain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Options {
    /// Seed of the chain, the data and the weights.
    pub seed: u64,
    /// Maximum number of Levenberg–Marquardt iterations.
    pub iterations: usize,
    /// Number of training trajectories; the authors use 800.
    pub trajectories: usize,
    /// Number of starts of the rollouts; the authors use 100.
    pub starts: usize,
}

impl Options {
    /// The authors' numbers.
    pub fn new(seed: u64) -> Self {
        Self { seed, iterations: 200, trajectories: 800, starts: 100 }
    }

    /// Smaller numbers for a first look.
    pub fn quick(seed: u64) -> Self {
        Self { iterations: 60, starts: 20, ..Self::new(seed) }
    }
}

/// Results for a chain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Number of pendulums.
    pub count: usize,
    /// Number of training trajectories.
    pub trajectories: usize,
    /// Number of learned entries of the weight block.
    pub parameters: usize,
    /// Mean squared error of the accelerations interpolated from the training data, on held-back samples.
    pub validation_mse: f64,
    /// Largest relative error of a learned mass; the first mass is known.
    pub mass_error: f64,
    /// Errors of the rollouts of (q, v).
    #[serde(flatten)]
    pub rolled_out: RolledOut,
    /// Training time, s.
    pub train_seconds: f64,
    /// Seed of the chain, the data and the weights.
    pub seed: u64,
}

/// Numbers of pendulums.
pub const COUNTS: [usize; 3] = [2, 3, 5];
/// Error per step of rollouts, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-11;
/// Number of steps of a rollout.
const ROLLOUT: usize = 100;

/// Learns a chain of `count` pendulums, and rolls it out.
pub fn run(count: usize, options: &Options, tell: &Tell) -> Result<Outcome, TaskError> {
    let Options { seed, iterations, trajectories, .. } = *options;
    let truss = chain(count, seed).map_err(GenerationError::from)?;
    let samples = Samples::interpolated(&training_set(&truss, trajectories, seed)?)?;
    let clock = Instant::now();
    let watch = watch(tell, 20, (String::new(), format!(" of {iterations}: training loss")));
    let (model, [_, validation_mse]) = train(architecture(&truss)?, &samples, iterations, seed, watch)?;
    let train_seconds = clock.elapsed().as_secs_f64();

    tell("rolling out");
    let horizon = Horizon { h: STEP, samples: ROLLOUT + 1 };
    let truth = Truth::new(&truss, starts(&truss, options.starts, seed ^ UNSEEN), horizon)?;
    let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
    let graph = model.architecture.graph()?;
    let (particles, rods) = (Graph::new(types, &graph.nodes, &graph.edges)?, graph.constraints());
    let driven = Driven::new(&particles, &rods)?;
    let accelerations = |q: &[f64], v: &[f64], a: &mut [f64]| driven.acceleration(q, v, &[], a);
    let rollouts = Rollouts::new(&truth, &truss, Compared::States, TOLERANCE, accelerations);
    Ok(Outcome {
        count,
        trajectories,
        parameters: model.weights.len() - model.architecture.fixed_positions().len(),
        validation_mse,
        mass_error: mass_error(&particles, &truss),
        rolled_out: RolledOut::new(&rollouts, (&truth, &truss, Compared::States), seed)?,
        train_seconds,
        seed,
    })
}

/// Largest relative error of a learned mass. Accelerations determine masses only up to a common factor, which the known
/// first mass fixes.
fn mass_error(learned: &impl Particles<f64, 2>, truss: &Truss) -> f64 {
    let first = truss.masses.first().copied().unwrap_or(1.0);
    let error = |(node, mass): (usize, &f64)| {
        let [[learned, _], _] = learned.mass(node, &[0.0; 2]);
        (learned * first / mass - 1.0).abs()
    };
    truss.masses.iter().enumerate().map(error).fold(0.0, f64::max)
}
