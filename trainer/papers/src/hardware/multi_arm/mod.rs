//! Free swings of pendulums of one, two and three arms: models learn from the first four fifths of the logged swings
//! and are tested on the last fifth.
//!
//! **Protocol.** Samples are 1 ms apart. A window starts every 0.25 s of a swing, and predicts 1 s from the state of a
//! quadratic through 21 samples. The error to a horizon is the root mean square over all joints at every 10 ms; a row
//! has the medians over windows. Ours knows the first mass and the lengths of the arms, and nothing else. Without a
//! known force, motion does not show the scale of masses and inertias; they are listed beside those of the authors.

mod published;
mod windows;

use published::{PENDULUMS, Pendulum};

use super::configured::{End, trained};
use super::error::HardwareError;
use super::machine::Machine;
use super::predictor::{ConstantVelocity, Learned, Predictor};
use super::window::Summary;
use crate::HARDWARE;
use crate::record::{Measure, Record};
use crate::task::{Task, TaskError, Tell, json};
use leastaction_learning::config::Config;
use leastaction_learning::data::{self, Dataset};
use leastaction_models::Architecture;
use leastaction_programs::System;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use windows::window_errors;

/// One in this number of swings is tested.
const TESTED: usize = 5;

/// Swings of a pendulum.
#[derive(Clone, Debug)]
pub struct Swings {
    pendulum: Pendulum,
    file: PathBuf,
    /// Swings to learn from.
    train: Dataset,
    /// Swings to test with.
    test: Dataset,
}

/// Models in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Model {
    ConstantVelocity,
    Published,
    Learned,
}

/// A learned number beside that of the authors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// Name, with its unit.
    pub name: String,
    /// Learned value.
    pub learned: f64,
    /// Value of the authors.
    pub published: f64,
    /// Whether the swings leave it free, alone or together with others.
    pub is_free: bool,
}

/// A row of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SwingsOutcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the pendulum.
    pub pendulum: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is our model.
    pub default: bool,
    /// Median window error after 0.1 s, rad.
    pub error_100ms: f64,
    /// Median window error after 0.5 s, rad.
    pub error_500ms: f64,
    /// Median window error after 1 s, rad.
    pub error_1s: f64,
    /// Number of windows.
    pub windows: usize,
    /// Learned numbers.
    pub numbers: Vec<Number>,
    /// Training time, s.
    pub train_seconds: f64,
}

impl Model {
    const ALL: [Self; 3] = [Self::ConstantVelocity, Self::Published, Self::Learned];

    fn name(self) -> &'static str {
        match self {
            Self::ConstantVelocity => "constant velocity",
            Self::Published => "parameters of the authors",
            Self::Learned => "leastaction, first mass and lengths known",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::ConstantVelocity => "constant-velocity",
            Self::Published => "published",
            Self::Learned => "leastaction",
        }
    }
}

/// Reads `data`/multi-arm/single_id.npz, double_id.npz and triple_id.npz, as far as they are there.
///
/// # Errors
/// [`HardwareError`]; also if none is there, or if one has fewer than two swings.
pub fn read_swings(data: &Path) -> Result<Vec<Arc<Swings>>, HardwareError> {
    let folder = data.join(Machine::MultiArm.name());
    let files = PENDULUMS.map(|pendulum| (pendulum, folder.join(pendulum.file())));
    let found: Vec<_> = files.into_iter().filter(|(_, file)| file.exists()).collect();
    if found.is_empty() {
        let names = PENDULUMS.map(|pendulum| pendulum.file()).join(", ");
        let what = format!("none of the files {names} is there");
        return Err(HardwareError::unusable(&folder, &what));
    }
    found.into_iter().map(|(pendulum, file)| Ok(Arc::new(Swings::read(pendulum, file)?))).collect()
}

impl Swings {
    fn read(pendulum: Pendulum, file: PathBuf) -> Result<Self, HardwareError> {
        let (all, _) = data::read(&file)?;
        let (count, n) = (all.trajectories.len(), pendulum.arms.len());
        let what = match count {
            _ if all.n != n => format!("it has {} coordinates; a pendulum of that name has {n}", all.n),
            0 | 1 => "only one swing; at least two are needed, to learn from one and test another".to_owned(),
            _ => {
                let (train, test) = all.split(count - (count / TESTED).max(1));
                return Ok(Self { pendulum, file, train, test });
            }
        };
        Err(HardwareError::unusable(&file, &what))
    }
}

/// Creates the tasks of all models on these swings.
pub fn swing_tasks(all: &[Arc<Swings>], (quick, arguments): (bool, &str)) -> Vec<Task> {
    let tasks =
        |swings: &Arc<Swings>| Model::ALL.map(|model| task(model, Arc::clone(swings), (quick, arguments)));
    all.iter().flat_map(tasks).collect()
}

fn task(model: Model, swings: Arc<Swings>, (quick, arguments): (bool, &str)) -> Task {
    let (paper, machine, pendulum) = (HARDWARE.name, Machine::MultiArm.name(), swings.pendulum.name);
    let [train, test] = [&swings.train, &swings.test].map(|part| part.trajectories.len());
    let source = format!("{}: {train} swings, tested on {test}", swings.file.display());
    let name = format!("{machine}-{pendulum}-{}", model.label());
    let is_learned = model == Model::Learned;
    Task {
        command: format!("leastaction-papers {paper} --machine {machine} --only {name}{arguments}"),
        settings: json(&(Machine::MultiArm, pendulum, model.name(), quick, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: if is_learned { swings.pendulum.expected_seconds } else { 0.5 },
        is_timed: false,
        run: Box::new(move |_, tell| Ok(vec![record(&outcome(model, &swings, (quick, tell))?)?])),
        name,
    }
}

/// A model that is to be tested.
struct Tested {
    predictor: Box<dyn Predictor>,
    numbers: Vec<Number>,
    seconds: f64,
}

impl Tested {
    /// A model that needs no training.
    fn known(predictor: Box<dyn Predictor>) -> Self {
        Self { predictor, numbers: Vec::new(), seconds: 0.0 }
    }
}

fn outcome(model: Model, swings: &Swings, running: (bool, &Tell)) -> Result<SwingsOutcome, TaskError> {
    let tested = match model {
        Model::ConstantVelocity => Tested::known(Box::new(ConstantVelocity)),
        Model::Published => {
            let (architecture, weights) = published(swings)?;
            Tested::known(predictor(&architecture, weights)?)
        }
        Model::Learned => learned(swings, running)?,
    };
    let Tested { predictor, numbers, seconds: train_seconds } = tested;
    let summary = Summary::of(&window_errors(&*predictor, &swings.test));
    let [error_100ms, error_500ms, error_1s] = summary.medians;
    Ok(SwingsOutcome {
        machine: Machine::MultiArm.name(),
        pendulum: swings.pendulum.name,
        model: model.name(),
        default: model == Model::Learned,
        error_100ms,
        error_500ms,
        error_1s,
        windows: summary.windows,
        numbers,
        train_seconds,
    })
}

fn predictor(architecture: &Architecture, weights: Vec<f64>) -> Result<Box<dyn Predictor>, TaskError> {
    Ok(Box::new(Learned::new(&System::new(&*architecture.energies()?), weights)))
}

/// The model of the authors, with its weights.
fn published(swings: &Swings) -> Result<(Architecture, Vec<f64>), TaskError> {
    let text = swings.pendulum.configuration("", true);
    Ok(Config::parse(&text, Path::new("published.toml"))?.beginning()?)
}

/// Learns as `leastaction train` does, from a file of the training swings.
fn learned(swings: &Swings, (quick, tell): (bool, &Tell)) -> Result<Tested, TaskError> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("swings.npz");
    data::write(&file, &swings.train)?;
    let text = swings.pendulum.configuration(&file.display().to_string(), false);
    let config = Config::parse(&text, &folder.path().join("pendulum.toml"))?;
    let End { trained, free, seconds, .. } = trained(config, (folder.path(), quick), tell)?;
    let (_, known) = published(swings)?;
    let names = trained.architecture.number_names();
    let fixed = trained.architecture.fixed_positions();
    let learned = (0..names.len()).filter(|position| !fixed.contains(position));
    let number = |position: usize| {
        let name = names[position].as_ref()?;
        Some(Number {
            name: format!("{}, {}", name.name, name.unit),
            learned: trained.best.weights[position],
            published: known[position],
            is_free: free.contains(&position),
        })
    };
    let numbers = learned.filter_map(number).collect();
    let predictor = predictor(&trained.architecture, trained.best.weights.clone())?;
    Ok(Tested { predictor, numbers, seconds })
}

fn record(row: &SwingsOutcome) -> Result<Record, serde_json::Error> {
    let measures = [("0.1 s", row.error_100ms), ("0.5 s", row.error_500ms), ("1 s", row.error_1s)];
    let number = |number: &Number| {
        let free = if number.is_free { ", free" } else { "" };
        format!("{} {:.3e} (authors {:.3e}{free})", number.name, number.learned, number.published)
    };
    let numbers: Vec<String> = row.numbers.iter().map(number).collect();
    let table = format!("{}, free swings that were not learned from", row.machine);
    Ok(Record {
        model: row.model.to_owned(),
        is_ours: row.default,
        parameters: row.numbers.len(),
        train_seconds: row.train_seconds,
        measures: measures.map(|(name, error)| Measure::error(name, error, None)).into(),
        note: (!numbers.is_empty()).then(|| numbers.join("; ")),
        ..Record::of(&table, [("pendulum", row.pendulum.to_owned())], row)?
    })
}
