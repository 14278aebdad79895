//! Torques of an arm along a logged motion: models learn from the beginning and the end of a log, and are tested on the
//! motion in between.
//!
//! **Protocol.** Positions, velocities and torques are interpolated linearly to 1 ms and filtered by a Butterworth
//! filter of order 4 at 20 Hz, forward and backward; accelerations are differences of the filtered velocities. Samples
//! are taken every 20 ms from 0.2 s to 0.2 s before the end. The motion of the Panda's log repeats after 13.32 s, so a
//! simple split in time would test on the motion of the training data. The models therefore learn from t < 7.56 s and
//! t > 13.44 s, and are tested on 7.76 … 13.24 s, whose motion occurs nowhere else. The error is the mean over joints
//! of the mean squared error over the variance of the torque on the tested part.

mod models;
mod network;
mod panda;

pub(super) use models::{Learned, least_squares};

use models::{Identification, MODELS};

use super::entries::label;
use super::error::HardwareError;
use super::machine::Machine;
use crate::HARDWARE;
use crate::record::{Measure, Record};
use crate::task::{Task, json};
use leastaction_learning::data::read_measured;
use leastaction_learning::torque::fit::{mean_nmse, squared_errors, variances};
use leastaction_learning::torque::{Preparation, Samples};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// First and last time of the tested part, s.
const TESTED: [f64; 2] = [7.76, 13.24];
/// End of the first learned part and beginning of the second, s; the gaps separate them from the tested part.
const LEARNED: [f64; 2] = [7.56, 13.44];
/// Period after which the motion repeats, s.
const PERIOD: f64 = 13.32;
/// Number of folds of the training motion, made of blocks of time and held back in turn.
const FOLDS: usize = 5;
/// Length of a block, s.
const BLOCK: f64 = 0.76;
/// File of the log.
const FILE: &str = "excitation.csv";

/// Samples of the arm's log.
#[derive(Clone, Debug)]
pub struct ArmData {
    /// File of the log.
    pub file: PathBuf,
    /// Samples to learn from.
    pub train: Samples,
    /// Samples to test with.
    pub test: Samples,
}

/// A row of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmOutcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is the default model of a fit.
    pub default: bool,
    /// Mean over joints of the mean squared error over the variance of the torque.
    pub mean_nmse: f64,
    /// Root mean squared error of every joint's torque, N m.
    pub rmse: Vec<f64>,
    /// Mean over joints of the normalised error on the samples that were learned from.
    pub train_nmse: f64,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Number of these parameters that the samples alone determine: singular values down to 10⁻⁶ of the largest count.
    /// `None` for networks.
    pub rank: Option<usize>,
    /// Smallest eigenvalue of any body's pseudo-inertia, scaled to a unit diagonal: positive if all bodies are
    /// physically consistent. Only for models that identify bodies.
    pub consistency: Option<f64>,
    /// Training time, s.
    pub train_seconds: f64,
}

impl ArmData {
    /// Reads `data`/panda/excitation.csv.
    ///
    /// # Errors
    /// [`HardwareError`].
    pub fn read(data: &Path) -> Result<Self, HardwareError> {
        let file = data.join(Machine::Panda.name()).join(FILE);
        let log = read_measured(&file, &Machine::Panda.columns())?;
        let samples = Samples::prepare(&log, &Preparation::default())
            .map_err(|error| HardwareError::unusable(&file, &error))?;
        let [from, to] = TESTED;
        let test = samples.at(|t| (from - 1e-9..=to + 1e-9).contains(&t));
        let train = samples.at(|t| !(LEARNED[0] - 1e-9..=LEARNED[1] + 1e-9).contains(&t));
        if test.count() == 0 || train.count() == 0 {
            let what = format!("it must last longer than {to} s");
            return Err(HardwareError::unusable(&file, &what));
        }
        Ok(Self { file, train, test })
    }

    /// Fold of each training sample; both passes through the same piece of motion are in the same fold.
    pub fn folds(&self) -> Vec<usize> {
        self.train.t.iter().map(|t| (t % PERIOD / BLOCK) as usize % FOLDS).collect()
    }
}

/// Creates the tasks of all models.
pub fn arm_tasks(data: &Arc<ArmData>, arguments: &str) -> Vec<Task> {
    MODELS.iter().map(|model| task(*model, Arc::clone(data), arguments)).collect()
}

fn task(model: Identification, data: Arc<ArmData>, arguments: &str) -> Task {
    let (paper, machine, label) = (HARDWARE.name, Machine::Panda.name(), label(model.name));
    let (file, [train, test]) = (data.file.display(), [&data.train, &data.test].map(Samples::count));
    let source = format!("{file}: {train} samples, tested on {test}");
    Task {
        name: format!("{machine}-{label}"),
        command: format!(
            "leastaction-papers {paper} --machine {machine} --only {machine}-{label}{arguments}"
        ),
        settings: json(&(Machine::Panda, model.name, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: model.expected_seconds,
        is_timed: false,
        run: Box::new(move |_, _| {
            let start = Instant::now();
            let learned = (model.learn)(&data)?;
            let row = outcome((&model, &data), &learned, start.elapsed().as_secs_f64());
            Ok(vec![record(&model, &row)?])
        }),
    }
}

fn outcome((model, data): (&Identification, &ArmData), learned: &Learned, train_seconds: f64) -> ArmOutcome {
    let errors = |of: &Samples| squared_errors(&(learned.predict)(of), of);
    let nmse = |of: &Samples| mean_nmse(&errors(of), &variances(of));
    ArmOutcome {
        machine: Machine::Panda.name(),
        model: model.name,
        default: model.is_default,
        mean_nmse: nmse(&data.test),
        rmse: errors(&data.test).iter().map(|error| error.sqrt()).collect(),
        train_nmse: nmse(&data.train),
        parameters: learned.parameters,
        rank: learned.rank,
        consistency: learned.consistency,
        train_seconds,
    }
}

fn record(model: &Identification, row: &ArmOutcome) -> Result<Record, serde_json::Error> {
    let joints = row.rmse.iter().enumerate();
    let joints = joints.map(|(k, error)| Measure::error(&format!("joint {}, N m", k + 1), *error, None));
    let first = Measure::error("mean NMSE", row.mean_nmse, None);
    let table = format!("{}, torques of motion that was not seen", row.machine);
    Ok(Record {
        model: row.model.to_owned(),
        is_ours: model.is_ours,
        parameters: row.parameters,
        train_seconds: row.train_seconds,
        measures: std::iter::once(first).chain(joints).collect(),
        ..Record::of(&table, [("tested", format!("{} … {} s", TESTED[0], TESTED[1]))], row)?
    })
}
