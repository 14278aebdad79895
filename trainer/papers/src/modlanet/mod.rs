//! ModLaNet's experiments (Lu et al., ICML 2022): pendulums and bodies, learned from accelerations and extended to
//! larger numbers of them.

mod baselines;
mod case;
mod figures;
mod judge;
mod noise;
mod outcome;
mod published;
mod recipe;
mod stepping;
mod task;

pub use baselines::Baseline;
pub use case::{Case, Options};
pub use task::{ModlanetData, tasks};

use outcome::{Outcome, Pictured, Predicted, Stepped};
use published::{Published, by_samples, published};
use recipe::{LearnedTree, architecture, best_of, train};
use stepping::{Energies, LongRun, long_run};

use super::training::Bounds;
use crate::baselines::{Follow, PredictionModel};
use crate::task::{TaskError, Tell, watch};
use judge::Judge;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{GenerationError, ManyBody, ModlanetSettings, modlanet_set, modlanet_set_of};
use leastaction_learning::data::modlanet::{ModlanetRows, ModlanetSet};
use leastaction_learning::evaluate::prediction::TOLERANCE;
use leastaction_learning::training::Samples;
use leastaction_models::{Family as _, ModularArchitecture};
use std::time::Instant;

/// Runs a case with our model or, in a case that has baselines, with one of the models that the paper compares with;
/// `tell` occasionally gets a line of progress.
pub fn run(
    (case, baseline): (Case, Option<(Baseline, Bounds)>),
    options: &Options,
    data: Option<&ModlanetSet>,
    tell: &Tell,
) -> Result<Vec<Outcome>, TaskError> {
    let experiment = Experiment { case, options, tell };
    let system = case.system().unwrap_or(ManyBody::Pendulum(2));
    let set = || data.cloned().map_or_else(|| modlanet_set(system, options.seed), Ok);
    if let Some(baseline) = baseline {
        return Ok(vec![experiment.baseline(baseline, system, &set()?)?]);
    }
    match case {
        Case::DoublePendulum | Case::ThreeBody => Ok(vec![experiment.table_2(system, &set()?)?]),
        Case::ExtendPendulum => experiment.extend(system, &set()?, &[3, 4].map(ManyBody::Pendulum)),
        Case::ExtendBody => experiment.extend(system, &set()?, &[4, 5, 6].map(ManyBody::Bodies)),
        Case::DatasetSize => experiment.dataset_size(),
        Case::DirectLarge => [ManyBody::Pendulum(4), ManyBody::Bodies(6)]
            .into_iter()
            .map(|system| Ok(experiment.learn(system, &generated(system, options.seed, TRAJECTORIES)?)?.0))
            .collect(),
        Case::Noise => experiment.noise(system, &set()?),
    }
}

/// Generates data with a number of trajectories other than the authors'.
fn generated(system: ManyBody, seed: u64, trajectories: usize) -> Result<ModlanetSet, GenerationError> {
    modlanet_set_of(&ModlanetSettings { trajectories, ..ModlanetSettings::published(system, seed) })
}

struct Experiment<'a> {
    case: Case,
    options: &'a Options,
    tell: &'a Tell<'a>,
}

impl Experiment<'_> {
    /// Returns the model of a system, if the data belongs to it.
    fn architecture(&self, system: ManyBody, set: &ModlanetSet) -> Result<ModularArchitecture, TaskError> {
        let architecture = architecture(system, self.options.pair);
        let (found, needed) = (set.train.q.width(), architecture.n());
        if found != needed {
            return Err(format!("the data has {found} coordinates, the case needs {needed}").into());
        }
        Ok(architecture)
    }

    /// Learns a system, with predictions of 30 s and, for pendulums, a long run.
    fn table_2(&self, system: ManyBody, set: &ModlanetSet) -> Result<Outcome, TaskError> {
        let (mut outcome, model) = self.learn(system, set)?;
        if let Some(judge) = &self.judge(system, PREDICTION)? {
            self.predict(&mut outcome, judge, &model)?;
        }
        let steps = self.options.steps;
        if self.case == Case::DoublePendulum && steps > 0 {
            (self.tell)(&format!("{steps} steps in single precision"));
            let run = long_run(&model, steps, LONG_STEP)?;
            outcome.stepped = Some(Stepped::from(&run));
            outcome.long_run = Some(run);
        }
        Ok(outcome)
    }

    /// Learns a system from its own data.
    fn learn(&self, system: ManyBody, set: &ModlanetSet) -> Result<(Outcome, LearnedTree), TaskError> {
        let architecture = self.architecture(system, set)?;
        let clock = Instant::now();
        let (iterations, seed) = (self.iterations(), self.options.seed);
        let watch = watch(self.tell, 10, (String::new(), format!(" of {iterations}: training loss")));
        let model = train(architecture, &set.train, iterations, seed, watch)?;
        let seconds = clock.elapsed().as_secs_f64();
        Ok((self.judged((system, "trained"), set, (&model, seconds), None)?, model))
    }

    /// Evaluates one of our models on the data of a system and, given a judge, by predictions.
    fn judged(
        &self,
        (system, kind): (ManyBody, &'static str),
        set: &ModlanetSet,
        (model, seconds): (&LearnedTree, f64),
        judge: Option<&Judge>,
    ) -> Result<Outcome, TaskError> {
        let mut outcome = self.outcome(system, kind, set, model.learned(), seconds)?;
        outcome.published = published(system, kind);
        outcome.accelerations = model.accelerations(&set.test)?;
        if let Some(judge) = judge {
            self.predict(&mut outcome, judge, model)?;
        }
        Ok(outcome)
    }

    fn outcome(
        &self,
        system: ManyBody,
        kind: &'static str,
        set: &ModlanetSet,
        (shape, weights): (&dyn PredictionModel, &[f64]),
        train_seconds: f64,
    ) -> Result<Outcome, TaskError> {
        let loss = |rows| Ok::<_, ModelError>(shape.objective(Samples::modlanet(rows))?.loss(weights));
        let test_mse = loss(&set.test)?;
        Ok(Outcome {
            case: self.case,
            system: system.name(),
            count: system.count(),
            kind,
            samples: set.train.q.len(),
            parameters: weights.len(),
            train_mse: loss(&set.train)?,
            test_mse,
            relative_test_mse: test_mse / set.test.mean_squared_acceleration(),
            train_seconds,
            seed: self.options.seed,
            ..Outcome::default()
        })
    }

    fn iterations(&self) -> usize {
        self.options.iterations.unwrap_or_else(|| self.case.iterations(self.options.pair))
    }

    /// Returns the judge for predictions over `length` s; `None` if no predictions are made.
    fn judge(&self, system: ManyBody, length: f64) -> Result<Option<Judge>, TaskError> {
        if self.options.starts == 0 {
            return Ok(None);
        }
        (self.tell)(&format!("{} of {}: exact motions of {length} s", system.name(), system.count()));
        Judge::new(system, self.options, length).map(Some)
    }

    fn predict(&self, outcome: &mut Outcome, judge: &Judge, model: &LearnedTree) -> Result<(), TaskError> {
        (self.tell)(&format!("{} of {}: predicting {} s", outcome.system, outcome.count, judge.length));
        let follow = Follow { motion: judge.motion.as_ref(), tolerance: TOLERANCE, deadline: None };
        judge.put(outcome, judge.predict(model.learned(), follow)?);
        Ok(())
    }

    /// Applies the trained model to larger systems, unchanged and fine-tuned.
    fn extend(
        &self,
        system: ManyBody,
        set: &ModlanetSet,
        larger: &[ManyBody],
    ) -> Result<Vec<Outcome>, TaskError> {
        let (trained, model) = self.learn(system, set)?;
        let mut rows = vec![trained];
        for system in larger {
            rows.extend(self.extend_to(*system, &model.extended(*system))?);
        }
        Ok(rows)
    }

    fn extend_to(&self, system: ManyBody, model: &LearnedTree) -> Result<[Outcome; 2], TaskError> {
        let set = modlanet_set(system, self.options.seed)?;
        let judge = self.judge(system, 10.0)?;
        let zero_shot = self.judged((system, "zero-shot"), &set, (model, 0.0), judge.as_ref())?;
        let clock = Instant::now();
        let [rows, validation] = held_back(&set.train, 9);
        let weights = best_of(&model.architecture, [&rows, &validation], model.weights.clone(), FINE_TUNING)?;
        let tuned = LearnedTree { weights, ..model.clone() };
        let seconds = clock.elapsed().as_secs_f64();
        let fine_tuned = self.judged((system, "fine-tuned"), &set, (&tuned, seconds), judge.as_ref())?;
        Ok([Outcome { samples: 0, ..zero_shot }, fine_tuned])
    }

    /// Learns the double pendulum from growing numbers of samples, with the same number of iterations.
    fn dataset_size(&self) -> Result<Vec<Outcome>, TaskError> {
        let system = ManyBody::Pendulum(2);
        let sizes = [10_000, 20_000, 40_000, 100_000, 1_000_000];
        let mut rows = Vec::new();
        for samples in sizes.into_iter().filter(|samples| *samples <= self.options.most_samples) {
            (self.tell)(&format!("{samples} samples"));
            // Nine of every ten trajectories, each of 101 states, are for training.
            let set = generated(system, self.options.seed, samples / 100)?;
            let (outcome, _) = self.learn(system, &set)?;
            rows.push(Outcome { published: by_samples(samples), accelerations: Vec::new(), ..outcome });
        }
        Ok(rows)
    }
}

/// Length of the predictions for a system on which a model was trained, s.
const PREDICTION: f64 = 30.0;
/// Step size of the long run, s.
const LONG_STEP: f32 = 0.01;
/// Number of trajectories of large systems, which equals that of the trained sizes.
const TRAJECTORIES: usize = 100;
/// Number of iterations of fine-tuning.
const FINE_TUNING: usize = 30;

/// Holds back the last 1/`one_in` of the trajectories (at least one) for validation; of a single trajectory, the last
/// 1/`one_in` of its rows. Returns the remaining rows, then the held-back rows.
fn held_back(rows: &ModlanetRows, one_in: usize) -> [ModlanetRows; 2] {
    let starts = rows.starts();
    let first = starts.get(starts.len() - (starts.len() / one_in).max(1)).copied().unwrap_or(0);
    let split = if first == 0 { rows.q.len() * (one_in - 1) / one_in } else { first };
    [rows.slice(0..split), rows.slice(split..rows.q.len())]
}
