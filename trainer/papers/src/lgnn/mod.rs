//! LGNN's experiments (Bhattoo et al., MLST 2023): pendulums on rods and rings of springs, learned from accelerations
//! and run on other sizes and on hybrids of both.
//!
//! Data and truth are exact motion; the authors' data contains the error of their integrator, which limits their
//! training loss.

mod baselines;
mod figures;
mod growth;
mod insight;
mod outcome;
mod published;
mod recipe;
mod speed;
mod task;
mod trial;

pub use recipe::train;
pub use task::tasks;

use baselines::Baseline;
use insight::{Compared, Insight};
use outcome::Outcome;
use published::{Published, published};
use recipe::LearnedGraph;
use speed::{LINEAR_SIZES, step_microseconds};

use super::training::Bounds;
use crate::task::{TaskError, Tell, watch};
use leastaction_core::energy::graph::{Graph, Member, Union};
use leastaction_core::particles::Particles;
use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_graph, lgnn_set, lgnn_shape};
use leastaction_learning::training::Samples;
use leastaction_models::particles::Driven;
use leastaction_models::{Family as _, HostTypes};
use serde::Serialize;
use std::time::Instant;

/// One of the paper's experiments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Case {
    /// Three pendulums on rods, and the same model run on 4 and 5.
    #[default]
    Pendulum,
    /// Five springs in a ring, and the same model run on 3 and 4.
    Spring,
    /// The model of five springs run on 50, 500 and 5,000.
    Scale,
    /// Two pendulums and four springs, with the models of three pendulums and five springs.
    Hybrid,
    /// The hybrid under 10 N on the second bob.
    HybridForce,
    /// Pendulums and springs with drag.
    Drag,
    /// Pendulums and springs from 100 to 10,000 samples.
    DataEfficiency,
}

/// Settings for running a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Options {
    /// Seed of the initial weights and of generated data.
    pub seed: u64,
    /// Maximum number of Levenberg–Marquardt iterations.
    pub iterations: usize,
    /// Number of starts of rollouts; fewer are taken for large systems.
    pub starts: usize,
    /// Whether the networks are learned without simple laws beside them.
    pub networks_alone: bool,
}

impl Options {
    /// Settings of the printed tables.
    pub fn new(seed: u64) -> Self {
        Self { seed, iterations: 200, starts: 100, networks_alone: false }
    }

    /// Settings for a first look.
    pub fn quick(seed: u64) -> Self {
        Self { iterations: 60, starts: 10, ..Self::new(seed) }
    }
}

/// Runs a case with our model, or with one of those that the paper compares with; `tell` occasionally gets a line of progress.
pub fn run(
    (case, baseline): (Case, Option<(Baseline, Bounds)>),
    options: &Options,
    tell: &Tell,
) -> Result<Vec<Outcome>, TaskError> {
    let experiment = Experiment { case, options, tell };
    if let Some((baseline, bounds)) = baseline {
        return experiment.baseline(baseline, bounds);
    }
    let pendulums = [3, 4, 5].map(LgnnSystem::Pendulum);
    match case {
        Case::Pendulum => experiment.sizes(LgnnSystem::Pendulum(3), 0.0, &pendulums),
        Case::Spring => experiment.sizes(LgnnSystem::Spring(5), 0.0, &[5, 3, 4].map(LgnnSystem::Spring)),
        Case::Scale => experiment.scale(),
        Case::Hybrid => experiment.hybrid(0.0),
        Case::HybridForce => experiment.hybrid(PULL),
        Case::Drag => {
            let mut rows = experiment.sizes(LgnnSystem::Pendulum(3), DRAG, &pendulums)?;
            let springs = [5, 3, 4, 50, 500].map(LgnnSystem::Spring);
            rows.extend(experiment.sizes(LgnnSystem::Spring(5), DRAG, &springs)?);
            Ok(rows)
        }
        Case::DataEfficiency => experiment.data_efficiency(),
    }
}

/// Drag in the authors' experiments, N s/m.
const DRAG: f64 = 0.1;
/// Force on the hybrid in the authors' experiments, N.
const PULL: f64 = 10.0;
/// Error per step of rollouts, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-11;
/// Numbers of samples in `data-efficiency`, held-back samples included.
const SAMPLES: [usize; 5] = [100, 500, 1_000, 5_000, 10_000];

struct Experiment<'a> {
    case: Case,
    options: &'a Options,
    tell: &'a Tell<'a>,
}

/// A trained model with its row after training.
struct Learned {
    model: LearnedGraph,
    row: Outcome,
}

impl Experiment<'_> {
    /// Learns a system from the authors' number of samples, or from the first `samples` of them in an order drawn by the seed.
    fn learn(&self, system: LgnnSystem, drag: f64, samples: Option<usize>) -> Result<Learned, TaskError> {
        let seed = self.options.seed;
        let settings = LgnnSettings { drag, ..LgnnSettings::published(system, seed) };
        let all = Samples::accelerations(&lgnn_set(&settings)?)?;
        let samples = samples.map_or_else(|| all.clone(), |count| all.shuffled(!seed).range(0..count));
        let architecture = lgnn_shape(system, drag > 0.0, self.options.networks_alone)?;
        let (clock, iterations) = (Instant::now(), self.options.iterations);
        let name = format!("{} of {}: ", system.name(), system.nodes());
        let watch = watch(self.tell, 20, (name, format!(" of {iterations}: training loss")));
        let (model, [train_mse, validation_mse]) = train(architecture, &samples, iterations, seed, watch)?;
        let parameters = model.weights.len() - model.architecture.fixed_positions().len();
        let row = Outcome {
            drag,
            samples: samples.len(),
            parameters,
            train_mse,
            validation_mse,
            train_seconds: clock.elapsed().as_secs_f64(),
            insight: Insight::new(&model, drag, &samples)?,
            ..Outcome::trained(self.case, system, seed)
        };
        let drag_error = (drag > 0.0).then(|| drag_error(&model, drag, &samples)).transpose()?;
        Ok(Learned { row: Outcome { drag_error, ..row }, model })
    }

    /// Learns a system, and rolls the model out on it and on other systems.
    fn sizes(
        &self,
        trained: LgnnSystem,
        drag: f64,
        systems: &[LgnnSystem],
    ) -> Result<Vec<Outcome>, TaskError> {
        let learned = self.learn(trained, drag, None)?;
        systems.iter().map(|system| self.roll_out(&learned, trained, *system)).collect()
    }

    /// Rolls a model out on a system.
    fn roll_out(
        &self,
        learned: &Learned,
        trained: LgnnSystem,
        system: LgnnSystem,
    ) -> Result<Outcome, TaskError> {
        let Learned { model, row } = learned;
        let kind = if system == trained { "trained" } else { "zero-shot" };
        let published = published(row.model, system, row.drag > 0.0);
        let row = Outcome { kind, published, ..row.clone() };
        let model = model.on(system);
        let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
        let graph = model.architecture.graph()?;
        self.rolled_out(row, system, &Graph::new(types, &graph.nodes, &graph.edges)?)
    }

    /// Completes a row with the rollouts of learned particles on a system.
    fn rolled_out<P: Particles<f64, 2> + Sync>(
        &self,
        row: Outcome,
        system: LgnnSystem,
        particles: &P,
    ) -> Result<Outcome, TaskError> {
        let trial = self.trial(&row, system)?;
        let rods = lgnn_graph(system).constraints();
        let u = trial.pull();
        let driven = Driven::new(particles, &rods)?;
        let rollouts = trial.roll_out(TOLERANCE, |q, v, a| driven.acceleration(q, v, &u, a));
        let rods = trial.pulls(&driven, &u);
        let insight = Insight { rods, ..row.insight.clone() };
        Ok(Outcome { insight, ..trial.judged(row, rollouts)? })
    }

    /// Runs the model of five springs on growing numbers of them, with the time of a step.
    fn scale(&self) -> Result<Vec<Outcome>, TaskError> {
        let trained = LgnnSystem::Spring(5);
        let learned = self.learn(trained, 0.0, None)?;
        let one = |count: usize| {
            let row = self.roll_out(&learned, trained, LgnnSystem::Spring(count))?;
            let microseconds = step_microseconds(&learned.model.on(LgnnSystem::Spring(count)))?;
            Ok(Outcome { step_microseconds: Some(microseconds), ..row })
        };
        LINEAR_SIZES.into_iter().map(one).collect()
    }

    /// Runs the union of the models of three pendulums and of five springs.
    fn hybrid(&self, pull: f64) -> Result<Vec<Outcome>, TaskError> {
        let bobs = self.learn(LgnnSystem::Pendulum(3), 0.0, None)?;
        let springs = self.learn(LgnnSystem::Spring(5), 0.0, None)?;
        let system = LgnnSystem::Hybrid;
        let [bobs_model, springs_model] = [&bobs, &springs].map(|learned| learned.model.on(system));
        let bob_types: HostTypes<'_, f64, 2> = bobs_model.architecture.host_types(&bobs_model.weights)?;
        let spring_types: HostTypes<'_, f64, 2> =
            springs_model.architecture.host_types(&springs_model.weights)?;
        let nodes = bobs_model.architecture.graph()?.nodes.clone();
        let edges = springs_model.architecture.graph()?.edges.clone();
        let all: Vec<u16> = (0..).take(nodes.len()).collect();
        let hanging = Graph::new(bob_types, &nodes, &[])?;
        let joined = Graph::new(spring_types, &nodes, &edges)?;
        let members = [hanging, joined].map(|graph| Member { graph, nodes: &all });
        let union = Union::new(&members, nodes.len())?;
        let row = Outcome {
            kind: "zero-shot",
            pull,
            parameters: bobs.row.parameters + springs.row.parameters,
            published: published("ours", system, pull > 0.0),
            ..springs.row.clone()
        };
        Ok(vec![self.rolled_out(row, system, &union)?])
    }

    /// Learns pendulums and springs from growing numbers of samples.
    fn data_efficiency(&self) -> Result<Vec<Outcome>, TaskError> {
        let mut rows = Vec::new();
        for system in [LgnnSystem::Pendulum(3), LgnnSystem::Spring(5)] {
            for samples in SAMPLES {
                let learned = self.learn(system, 0.0, Some(samples))?;
                let row = self.roll_out(&learned, system, system)?;
                rows.push(Outcome { published: Published::default(), ..row });
            }
        }
        Ok(rows)
    }
}

/// Largest |Q(v) + cv|/|cv| of the learned drag over the velocities of the samples, except those below 1% of the
/// fastest.
fn drag_error(model: &LearnedGraph, drag: f64, samples: &Samples) -> Result<f64, TaskError> {
    let types: HostTypes<'_, f64, 2> = model.architecture.host_types(&model.weights)?;
    let graph = Graph::new(types, &[0], &[])?;
    let velocities = &samples.states[1];
    let fastest = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let error = |v: &f64| {
        let [learned, _] = Particles::<f64, 2>::drag(&graph, 0, &[*v, 0.0]);
        ((learned + drag * v) / (drag * v)).abs()
    };
    Ok(velocities.iter().filter(|v| v.abs() > 0.01 * fastest).map(error).fold(0.0, f64::max))
}
