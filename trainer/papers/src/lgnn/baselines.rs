//! Models that the paper compares with, trained by its authors' recipe.

use super::super::training::{Bounds, Limits, Recipe, is_past};
use super::recipe::JUDGES;
use super::{Case, Experiment, Outcome, published};
use crate::baselines::{CartesianLnn, Gns, GraphSizes, Lgn, MotionModel};
use crate::task::TaskError;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_graph, lgnn_set};
use leastaction_learning::training::{AdamSettings, Samples, Schedule};
use serde::Serialize;

/// Error per step of their rollouts, relative to 1 + |x|, far below the error of the models.
const TOLERANCE: f64 = 1e-8;

/// Number of units of each hidden layer of LNN.
const LNN_WIDTH: usize = 256;

/// A model of the paper's figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Baseline {
    /// Graph network from the state to the accelerations, trained on five springs and run on more.
    Gns,
    /// Graph network from the state to the Lagrangian, for three pendulums with their rods, and trained on five springs and run on more.
    Lgn,
    /// Lagrangian network of the positions of three pendulums, with their rods.
    Lnn,
}

impl Baseline {
    /// Baselines of a case.
    pub fn of(case: Case) -> &'static [Self] {
        match case {
            Case::Pendulum => &[Self::Lnn, Self::Lgn],
            Case::Scale => &[Self::Gns, Self::Lgn],
            _ => &[],
        }
    }

    /// Name in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::Gns => "GNS",
            Self::Lgn => "LGN",
            Self::Lnn => "LNN",
        }
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gns => "gns",
            Self::Lgn => "lgn",
            Self::Lnn => "lnn",
        }
    }

    /// System that a baseline is trained on in a case.
    fn trained(case: Case) -> LgnnSystem {
        if case == Case::Pendulum { LgnnSystem::Pendulum(3) } else { LgnnSystem::Spring(5) }
    }

    /// Systems that a baseline is run on in a case. LGN's mass matrix is dense: a rollout of 500 springs would take hours.
    fn systems(self, case: Case) -> Vec<LgnnSystem> {
        match (case, self) {
            (Case::Pendulum, _) => vec![LgnnSystem::Pendulum(3)],
            (_, Self::Lgn) => [5, 50].map(LgnnSystem::Spring).to_vec(),
            _ => [5, 50, 500].map(LgnnSystem::Spring).to_vec(),
        }
    }

    /// Shape of the baseline on a system.
    fn model(self, system: LgnnSystem) -> Result<Box<dyn MotionModel>, ModelError> {
        let graph = lgnn_graph(system);
        Ok(match self {
            Self::Gns => Box::new(Gns::new(GraphSizes::LGNN, &graph)?),
            Self::Lgn => Box::new(Lgn::new(GraphSizes::LGNN, graph)?),
            Self::Lnn => Box::new(CartesianLnn::new(graph, LNN_WIDTH)),
        })
    }
}

/// Recipe of the authors: 10,000 epochs at 1e-3 in batches of 100.
fn recipe(seed: u64) -> Recipe {
    let schedule = Schedule::Constant;
    Recipe {
        epochs: 10_000,
        adam: AdamSettings { learning_rate: 1e-3, batch: 100, schedule, decay: 0.0, seed },
    }
}

impl Experiment<'_> {
    /// Trains a baseline within limits, and rolls it out.
    pub(super) fn baseline(&self, baseline: Baseline, bounds: Bounds) -> Result<Vec<Outcome>, TaskError> {
        let (seed, system) = (self.options.seed, Baseline::trained(self.case));
        let samples = Samples::accelerations(&lgnn_set(&LgnnSettings::published(system, seed))?)?;
        let [rows, judges] = samples.shuffled(seed).split(samples.len() / JUDGES);
        let tell = |line: &str| (self.tell)(&format!("{}, {line}", baseline.name()));
        let model = baseline.model(system)?;
        let trained = recipe(seed).train(&*model, rows.clone(), (seed, bounds), &tell)?;
        let row = Outcome {
            model: baseline.title(),
            samples: samples.len(),
            parameters: trained.weights.len(),
            train_mse: model.objective(rows)?.loss(&trained.weights),
            validation_mse: model.objective(judges)?.loss(&trained.weights),
            train_seconds: trained.seconds,
            epochs: Some(trained.epochs),
            ending: trained.ending,
            ..Outcome::trained(self.case, system, seed)
        };
        let one = |on: LgnnSystem| {
            let kind = if on == system { "trained" } else { "zero-shot" };
            let row = Outcome { kind, published: published(row.model, on, false), ..row.clone() };
            self.baseline_on((row, baseline.model(on)?), on, &trained.weights, bounds.limits)
        };
        baseline.systems(self.case).into_iter().map(one).collect()
    }

    /// Completes a row with the rollouts of a trained model on a system; those that are not finished in time count as failed.
    fn baseline_on(
        &self,
        (row, model): (Outcome, Box<dyn MotionModel>),
        system: LgnnSystem,
        weights: &[f64],
        limits: Limits,
    ) -> Result<Outcome, TaskError> {
        let trial = self.trial(&row, system)?;
        let (motion, deadline) = (model.motion(weights)?, limits.deadline());
        let rollouts = trial.roll_out(TOLERANCE, |q, v, a| match is_past(deadline) {
            true => None,
            false => motion(q, v, a),
        });
        trial.judged(row, rollouts)
    }
}
