//! Torques of an arm along a logged motion: learned from the beginning and the end of a log, judged on the motion between.
//!
//! **Protocol.** Positions, velocities and torques are brought onto 1 ms along straight lines and filtered by a Butterworth filter of order 4
//! at 20 Hz, forward and backward; accelerations are differences of the filtered velocities. Samples stand every 20 ms from 0.2 s to 0.2 s
//! before the end. The motion of the Panda's log repeats after 13.32 s, so a split in time would test what was learned from: it is learned
//! from t < 7.56 s and t > 13.44 s, and tested on 7.76 … 13.24 s, motion that is seen nowhere else. The error is the mean over joints
//! of the mean squared error over the variance of the torque on the tested part.

mod models;
mod network;
mod panda;

pub use models::{Identification, MODELS};
pub use panda::{panda, panda_urdf};

use super::error::HardwareError;
use super::machine::Machine;
use crate::record::{Measure, Record};
use crate::task::{Task, TaskError};
use leastaction_learning::data::read_measured;
use leastaction_learning::torque::fit::{mean_nmse, squared_errors, variances};
use leastaction_learning::torque::{Preparation, Samples};
use models::Learned;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Of the tested part, s.
const TESTED: [f64; 2] = [7.76, 13.24];
/// Before and after it, s: what lies between is near both parts.
const LEARNED: [f64; 2] = [7.56, 13.44];
/// After so long the motion repeats, s.
const PERIOD: f64 = 13.32;
/// Parts of the learned motion that are held back in turn, in blocks of time.
const FOLDS: usize = 5;
/// Of a block, s.
const BLOCK: f64 = 0.76;
/// The log.
const FILE: &str = "excitation.csv";

/// Samples of the arm's log.
#[derive(Clone, Debug)]
pub struct ArmData {
    /// Its file.
    pub file: PathBuf,
    /// To learn from.
    pub train: Samples,
    /// To judge by.
    pub test: Samples,
}

/// A row of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmOutcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is what a fit gives where nothing is chosen.
    pub default: bool,
    /// Mean over joints of the mean squared error over the variance of the torque.
    pub mean_nmse: f64,
    /// Root mean squared error of every joint's torque, N m.
    pub rmse: Vec<f64>,
    /// The mean over joints on what was learned from.
    pub train_nmse: f64,
    /// Numbers that were learned.
    pub parameters: usize,
    /// Of them what the samples alone determine, to 10⁻⁶ of the best determined; not of networks.
    pub rank: Option<usize>,
    /// The least eigenvalue of a body's pseudo-inertia whose diagonal is scaled to 1: above 0 where all bodies can be. Only of bodies that are found.
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
            .map_err(|error| HardwareError::Parameters { file: file.clone(), what: error.to_string() })?;
        let [from, to] = TESTED;
        let test = samples.at(|t| (from - 1e-9..=to + 1e-9).contains(&t));
        let train = samples.at(|t| !(LEARNED[0] - 1e-9..=LEARNED[1] + 1e-9).contains(&t));
        if test.count() == 0 || train.count() == 0 {
            let what = format!("it must last longer than {to} s");
            return Err(HardwareError::Parameters { file, what });
        }
        Ok(Self { file, train, test })
    }

    /// Which fold each learned sample belongs to: both passes through a piece of motion to the same one.
    pub fn folds(&self) -> Vec<usize> {
        self.train.t.iter().map(|t| (t % PERIOD / BLOCK) as usize % FOLDS).collect()
    }
}

/// The tasks of all models.
pub fn arm_tasks(data: &Arc<ArmData>, arguments: &str) -> Vec<Box<dyn Task>> {
    let task = |model: &Identification| -> Box<dyn Task> {
        Box::new(ArmTask { model: *model, data: Arc::clone(data), arguments: arguments.to_owned() })
    };
    MODELS.iter().map(task).collect()
}

/// A model on the arm's log.
struct ArmTask {
    model: Identification,
    data: Arc<ArmData>,
    arguments: String,
}

impl Task for ArmTask {
    fn name(&self) -> String {
        format!("{}-{}", Machine::Panda.name(), self.model.label())
    }

    fn command(&self) -> String {
        let machine = Machine::Panda.name();
        let label = self.model.label();
        format!("leastaction-papers hardware --machine {machine} --only {machine}-{label}{}", self.arguments)
    }

    fn data(&self) -> String {
        format!(
            "{}: {} samples, tested on {}",
            self.data.file.display(),
            self.data.train.count(),
            self.data.test.count()
        )
    }

    fn settings(&self) -> String {
        serde_json::to_string(&(Machine::Panda, self.model.name, self.data())).unwrap_or_default()
    }

    fn options(&self) -> String {
        self.arguments.clone()
    }

    fn expected_seconds(&self) -> f64 {
        self.model.expected_seconds
    }

    fn run(&self, _: Option<&Path>, _: &(dyn Fn(&str) + Sync)) -> Result<Vec<Record>, TaskError> {
        let start = Instant::now();
        let learned = (self.model.learn)(&self.data)?;
        let row = self.outcome(&learned, start.elapsed().as_secs_f64());
        Ok(vec![self.record(&row)?])
    }
}

impl ArmTask {
    fn outcome(&self, learned: &Learned, train_seconds: f64) -> ArmOutcome {
        let errors = |of: &Samples| squared_errors(&(learned.predict)(of), of);
        let nmse = |of: &Samples| mean_nmse(&errors(of), &variances(of));
        ArmOutcome {
            machine: Machine::Panda.name(),
            model: self.model.name,
            default: self.model.is_default,
            mean_nmse: nmse(&self.data.test),
            rmse: errors(&self.data.test).iter().map(|error| error.sqrt()).collect(),
            train_nmse: nmse(&self.data.train),
            parameters: learned.parameters,
            rank: learned.rank,
            consistency: learned.consistency,
            train_seconds,
        }
    }

    fn record(&self, row: &ArmOutcome) -> Result<Record, serde_json::Error> {
        let joints = row.rmse.iter().enumerate();
        let joints = joints.map(|(k, error)| Measure::error(&format!("joint {}, N m", k + 1), *error, None));
        let first = Measure::error("mean NMSE", row.mean_nmse, None);
        Ok(Record {
            table: format!("{}, torques of motion that was not seen", row.machine),
            subject: vec![("tested".to_owned(), format!("{} … {} s", TESTED[0], TESTED[1]))],
            model: row.model.to_owned(),
            is_ours: self.model.is_ours,
            parameters: row.parameters,
            paper_parameters: None,
            seed: 0,
            train_seconds: row.train_seconds,
            measures: std::iter::once(first).chain(joints).collect(),
            note: None,
            pictures: Vec::new(),
            details: serde_json::to_value(row)?,
            is_summary: false,
        })
    }
}
