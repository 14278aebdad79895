//! Models that the paper compares with (Table 2 and Figure 5), trained by its authors' recipe.

use super::super::training::{Bounds, Limits, Recipe};
use super::{Experiment, Judge, Outcome, PREDICTION, published};
use crate::baselines::{Follow, Hnn, Lnn, Mlp, Momenta, PredictionModel};
use crate::task::TaskError;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::ManyBody;
use leastaction_learning::data::modlanet::ModlanetSet;
use leastaction_learning::training::{AdamSettings, Samples, Schedule};
use leastaction_models::Family as _;
use serde::Serialize;

/// Error per step of their predictions, far below the error of the models.
const TOLERANCE: f64 = 1e-8;

/// A model of the paper's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Baseline {
    /// Hamiltonian network.
    Hnn,
    /// Hamiltonian network about as large as ModLaNet.
    LightHnn,
    /// Lagrangian network.
    Lnn,
    /// Lagrangian network about as large as ModLaNet.
    LightLnn,
    /// Plain network from the state to the accelerations.
    Mlp,
    /// Plain network about as large as ModLaNet; in the authors' program, but not in the table.
    LightMlp,
}

impl Baseline {
    /// All models, in the order of the table.
    pub const ALL: [Self; 6] =
        [Self::Hnn, Self::LightHnn, Self::Lnn, Self::LightLnn, Self::Mlp, Self::LightMlp];

    /// Models that are about as large as ModLaNet.
    pub const LIGHT: [Self; 3] = [Self::LightHnn, Self::LightLnn, Self::LightMlp];

    /// Name in tables.
    pub fn title(self) -> &'static str {
        self.names()[0]
    }

    /// Name in files.
    pub fn name(self) -> &'static str {
        self.names()[1]
    }

    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Hnn => ["HNN", "hnn"],
            Self::LightHnn => ["HNN, light", "light-hnn"],
            Self::Lnn => ["LNN", "lnn"],
            Self::LightLnn => ["LNN, light", "light-lnn"],
            Self::Mlp => ["MLP", "mlp"],
            Self::LightMlp => ["MLP, light", "light-mlp"],
        }
    }

    fn is_lnn(self) -> bool {
        matches!(self, Self::Lnn | Self::LightLnn)
    }

    /// Number of units of its two hidden layers, as in the authors' program.
    pub fn width(self, system: ManyBody) -> usize {
        match (self, system) {
            (Self::Lnn, _) => 600,
            (Self::Hnn | Self::Mlp, _) => 200,
            (_, ManyBody::Pendulum(_)) => 75,
            (_, ManyBody::Bodies(_)) => 70,
        }
    }

    /// Recipe of the authors: weight decay 1e-4; for pendulums 10,000 epochs at 1e-2, halved after 3,000 and 9,000; for
    /// bodies 3,000 epochs at 1e-3. LNN is trained at 1e-3 throughout.
    pub fn recipe(self, system: ManyBody) -> Recipe {
        let (epochs, learning_rate, schedule) = match (system, self.is_lnn()) {
            (ManyBody::Pendulum(_), false) => {
                (10_000, 1e-2, Schedule::Steps { factor: 0.5, epochs: [3_000, 9_000, 15_000] })
            }
            (ManyBody::Pendulum(_), true) => (10_000, 1e-3, Schedule::Constant),
            (ManyBody::Bodies(_), _) => (3_000, 1e-3, Schedule::Constant),
        };
        Recipe { epochs, adam: AdamSettings { learning_rate, batch: 0, schedule, decay: 1e-4, seed: 0 } }
    }

    /// Returns its shape for a system; `coordinates` has one letter each, `a` for angles.
    pub fn model(self, system: ManyBody, coordinates: &str) -> Result<Box<dyn PredictionModel>, ModelError> {
        let width = self.width(system);
        Ok(match self {
            Self::Hnn | Self::LightHnn => Box::new(Hnn::new(coordinates, width, Momenta::of(system))?),
            Self::Lnn | Self::LightLnn => Box::new(Lnn::new(coordinates, width)),
            Self::Mlp | Self::LightMlp => Box::new(Mlp::of_width(coordinates, width)?),
        })
    }
}

impl Experiment<'_> {
    /// Trains a baseline and evaluates it.
    pub(super) fn baseline(
        &self,
        (baseline, bounds): (Baseline, Bounds),
        system: ManyBody,
        set: &ModlanetSet,
    ) -> Result<Outcome, TaskError> {
        let judge = self.judge(system, PREDICTION)?;
        let recipe = baseline.recipe(system);
        let model = baseline.model(system, &self.architecture(system, set)?.coordinates())?;
        let (name, samples) = (baseline.name(), Samples::modlanet(&set.train));
        let tell = |line: &str| (self.tell)(&format!("{name}, {line}"));
        let trained = recipe.train(&*model, samples, (self.options.seed, bounds), &tell)?;
        let learned = (&*model, trained.weights.as_slice());
        let mut outcome = self.outcome(system, name, set, learned, trained.seconds)?;
        outcome.published = published(system, name);
        (outcome.epochs, outcome.ending) = (Some(trained.epochs), trained.ending);
        if let Some(judge) = &judge {
            self.predict_baseline(&mut outcome, judge, learned, bounds.limits)?;
        }
        Ok(outcome)
    }

    /// Makes predictions if the errors of the accelerations are smaller than the accelerations themselves and time is
    /// left.
    fn predict_baseline(
        &self,
        outcome: &mut Outcome,
        judge: &Judge,
        learned: (&dyn PredictionModel, &[f64]),
        limits: Limits,
    ) -> Result<(), TaskError> {
        if outcome.relative_test_mse.is_nan() || outcome.relative_test_mse >= 1.0 {
            outcome.unpredicted = Some("worse than no acceleration at all");
            return Ok(());
        }
        (self.tell)(&format!("{}: predicting {} s", outcome.kind, judge.length));
        let follow =
            Follow { motion: judge.motion.as_ref(), tolerance: TOLERANCE, deadline: limits.deadline() };
        let found = judge.predict(learned, follow)?;
        match follow.is_late() {
            true => outcome.unpredicted = Some("out of time"),
            false => judge.put(outcome, found),
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "baseline_tests.rs"]
mod tests;
