//! The models that the paper compares with (Table 2 and Figure 5), trained as its authors train them.

use super::published;
use super::{Ending, Experiment, Judge, Outcome, ReproduceError};
use crate::baselines::{AccelerationModel, Follow, Hnn, Lnn, Mlp, Momenta};
use crate::data::modlanet::ModlanetSet;
use crate::ground_truth::ManyBody;
use crate::training::{Adam, AdamSettings, Progress, Samples, Schedule};
use leastaction_core::model::ModelError;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Error a step of their predictions: that of the models is far above it.
const TOLERANCE: f64 = 1e-8;
/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(10);

/// Where the training of a baseline ends, beside the end of its recipe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Limits {
    /// Epochs; `None`: the recipe's.
    pub epochs: Option<u64>,
    /// Wall time of training, and again of the predictions.
    pub time: Option<Duration>,
}

/// A model of the paper's table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Baseline {
    /// Hamiltonian network.
    Hnn,
    /// The same, about as large as ModLaNet.
    LightHnn,
    /// Lagrangian network.
    Lnn,
    /// The same, about as large as ModLaNet.
    LightLnn,
    /// From the state to the accelerations.
    Mlp,
    /// The same, about as large as ModLaNet; the program has it, the table not.
    LightMlp,
}

/// How a baseline is trained: by Adam on all samples at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Passes through the samples, a step each.
    pub epochs: u64,
    /// Steps.
    pub adam: AdamSettings,
}

impl Baseline {
    /// All, in the order of the table.
    pub const ALL: [Self; 6] =
        [Self::Hnn, Self::LightHnn, Self::Lnn, Self::LightLnn, Self::Mlp, Self::LightMlp];

    /// Those that are about as large as ModLaNet.
    pub const LIGHT: [Self; 3] = [Self::LightHnn, Self::LightLnn, Self::LightMlp];

    /// As in tables.
    pub fn title(self) -> &'static str {
        match self {
            Self::Hnn => "HNN",
            Self::LightHnn => "HNN, light",
            Self::Lnn => "LNN",
            Self::LightLnn => "LNN, light",
            Self::Mlp => "MLP",
            Self::LightMlp => "MLP, light",
        }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hnn => "hnn",
            Self::LightHnn => "light-hnn",
            Self::Lnn => "lnn",
            Self::LightLnn => "light-lnn",
            Self::Mlp => "mlp",
            Self::LightMlp => "light-mlp",
        }
    }

    fn is_lnn(self) -> bool {
        matches!(self, Self::Lnn | Self::LightLnn)
    }

    /// Units of its two hidden layers, as in the authors' program.
    pub fn width(self, system: ManyBody) -> usize {
        match (self, system) {
            (Self::Lnn, _) => 600,
            (Self::Hnn | Self::Mlp, _) => 200,
            (_, ManyBody::Pendulum(_)) => 75,
            (_, ManyBody::Bodies(_)) => 70,
        }
    }

    /// The authors': weight decay 1e-4; 10,000 epochs of pendulums at 1e-2, halved after 3,000 and 9,000, and 3,000 epochs of
    /// bodies at 1e-3; LNN at 1e-3 throughout.
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

    /// Its shape for a system; `coordinates` has a letter each, `a` for angles.
    ///
    /// # Errors
    /// Where it is beyond what is compiled.
    pub fn model(
        self,
        system: ManyBody,
        coordinates: &str,
    ) -> Result<Box<dyn AccelerationModel>, ModelError> {
        let width = self.width(system);
        Ok(match self {
            Self::Hnn | Self::LightHnn => Box::new(Hnn::new(coordinates, width, Momenta::of(system))?),
            Self::Lnn | Self::LightLnn => Box::new(Lnn::new(coordinates, width)?),
            Self::Mlp | Self::LightMlp => Box::new(Mlp::of_width(coordinates, width)?),
        })
    }
}

/// What training gives.
struct Trained {
    weights: Vec<f64>,
    /// Epochs done.
    epochs: u64,
    ending: Ending,
}

impl Recipe {
    /// Trains until a limit, or until the loss is not a number any more: then the weights are the last that had one.
    fn train(
        &self,
        model: &dyn AccelerationModel,
        samples: Samples,
        (seed, time): (u64, Option<Duration>),
        mut watch: impl FnMut(u64, f64),
    ) -> Result<Trained, ModelError> {
        let clock = Instant::now();
        let objective = model.training(samples)?;
        let mut adam = Adam::new(&*objective, model.initial_weights(seed), self.adam);
        let mut good = adam.weights.clone();
        for epoch in 1..=self.epochs {
            if time.is_some_and(|time| clock.elapsed() >= time) {
                let ending = Ending::OutOfTime { epoch: epoch - 1 };
                return Ok(Trained { weights: adam.weights, epochs: epoch - 1, ending });
            }
            let before = adam.weights.clone();
            if adam.iterate(&*objective) == Progress::Stuck || !adam.loss.is_finite() {
                return Ok(Trained { weights: good, epochs: epoch - 1, ending: Ending::Diverged { epoch } });
            }
            // The loss is that of the weights before the step.
            good = before;
            watch(epoch, adam.loss);
        }
        Ok(Trained { weights: adam.weights, epochs: self.epochs, ending: Ending::Complete })
    }
}

impl Experiment<'_> {
    /// Trains one and judges it.
    pub(super) fn baseline(
        &self,
        baseline: Baseline,
        (system, set): (ManyBody, &ModlanetSet),
        limits: Limits,
        judge: Option<&Judge>,
    ) -> Result<Outcome, ReproduceError> {
        let clock = Instant::now();
        let recipe = baseline.recipe(system);
        let recipe = Recipe { epochs: limits.epochs.unwrap_or(recipe.epochs), ..recipe };
        let model = baseline.model(system, &self.architecture(system, set)?.coordinates())?;
        let (name, tell, mut last) = (baseline.name(), self.tell, clock);
        let samples = Samples::modlanet(&set.train);
        let trained = recipe.train(&*model, samples, (self.options.seed, limits.time), |epoch, loss| {
            if last.elapsed() >= PAUSE {
                last = Instant::now();
                tell(&format!("{name}, epoch {epoch} of {}: training loss {loss:.2e}", recipe.epochs));
            }
        })?;
        let seconds = clock.elapsed().as_secs_f64();
        let learned = (&*model, trained.weights.as_slice());
        let mut outcome = self.outcome(system, name, set, learned, seconds)?;
        outcome.published = published::baseline(system, baseline);
        (outcome.epochs, outcome.ending) = (Some(trained.epochs), trained.ending);
        if let Some(judge) = judge {
            self.predict_baseline(&mut outcome, judge, learned, limits)?;
        }
        Ok(outcome)
    }

    /// Predicts where the errors of accelerations are below the accelerations themselves, and there is time enough.
    fn predict_baseline(
        &self,
        outcome: &mut Outcome,
        judge: &Judge,
        learned: (&dyn AccelerationModel, &[f64]),
        limits: Limits,
    ) -> Result<(), ReproduceError> {
        if outcome.relative_test_mse.is_nan() || outcome.relative_test_mse >= 1.0 {
            outcome.unpredicted = Some("worse than no acceleration at all");
            return Ok(());
        }
        (self.tell)(&format!("{}: predicting {} s", outcome.kind, judge.length));
        let deadline = limits.time.map(|time| Instant::now() + time);
        let follow = Follow { motion: judge.motion.as_ref(), tolerance: TOLERANCE, deadline };
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
