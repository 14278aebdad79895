//! Currents of an arm's drives along logged motion: models learn from the log of an exciting motion, and are judged on
//! it and on all other logs.
//!
//! **Protocol.** Positions, logged velocities and currents are interpolated linearly to 10.7 ms and filtered by a
//! Butterworth filter of order 4 at 10 Hz, forward and backward; accelerations are central differences of the filtered
//! velocities; 20 samples are dropped at each end. The error is the mean over joints of the mean squared error over the
//! variance of the current on the judged log. A log of a load that the model does not know is judged like the others.

mod models;

use super::arm::Learned;
use super::entries::label;
use super::error::HardwareError;
use super::log::log_files;
use super::machine::Machine;
use crate::HARDWARE;
use crate::record::{Measure, Record};
use crate::task::{Task, TaskError, Tell, json};
use leastaction_learning::data::read_measured;
use leastaction_learning::torque::fit::{mean_nmse, squared_errors, variances};
use leastaction_learning::torque::{Preparation, Samples};
use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Inertias, read};
use models::{MODELS, Model};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Text in the name of the log that is learned from.
const LEARNED: &str = "50sec_12harm";
/// Step of the grid, s.
const STEP: f64 = 0.0107;
/// Cut-off of the filter, Hz.
const CUT_OFF: f64 = 10.0;
/// Samples dropped at each end.
const DROPPED: f64 = 20.0;
/// Speed below which a joint counts as at rest, rad/s.
const REST: f64 = 0.01;
/// Torque of every joint for a current of 1 A, N m, as the authors of the logs publish it.
///
/// Source: Mamedov and Mikhel, "Practical aspects of model-based collision detection", Frontiers in Robotics and AI 7,
/// 2020.
const GAINS: [f64; 6] = [10.0, 10.7, 8.46, 9.0, 9.48, 10.12];

/// Samples of all logs of an arm.
#[derive(Clone, Debug)]
pub struct CurrentData {
    /// Folder of the logs.
    pub folder: PathBuf,
    /// File of the description.
    pub urdf: PathBuf,
    /// The described arm.
    pub tree: Tree,
    /// Logs in order of name.
    pub logs: Vec<CurrentLog>,
    /// Index of the log that is learned from.
    pub learned: usize,
}

/// Samples of a log, whose torques are currents (A).
#[derive(Clone, Debug)]
pub struct CurrentLog {
    /// File of the log.
    pub file: PathBuf,
    /// Name of the file without its ending.
    pub name: String,
    /// The samples.
    pub samples: Samples,
}

/// A row of `--json`: a model on a log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurrentOutcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is the default model of a fit.
    pub default: bool,
    /// Name of the judged log.
    pub log: String,
    /// Whether the model learned from this log.
    pub is_learned: bool,
    /// Mean over joints of the mean squared error over the variance of the current.
    pub mean_nmse: f64,
    /// Mean squared error over variance of every joint's current.
    pub nmse: Vec<f64>,
    /// Root mean squared error of every joint's current, A.
    pub rmse: Vec<f64>,
    /// Share of every joint's squared error that arises while it rests, slower than 0.01 rad/s: static friction then
    /// takes any current up to its limit, whatever the state.
    pub at_rest: Vec<f64>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Number of these parameters that the samples alone determine, for least squares.
    pub rank: Option<usize>,
    /// Training time, s.
    pub train_seconds: f64,
}

impl CurrentData {
    /// Reads `data`/ur10e: the description ur10e.urdf and all logs.
    ///
    /// # Errors
    /// [`HardwareError`].
    pub fn read(data: &Path) -> Result<Self, HardwareError> {
        let folder = data.join(Machine::Ur10e.name());
        let urdf = folder.join("ur10e.urdf");
        let tree = read(&urdf, Inertias::Required).map_err(|error| HardwareError::unusable(&urdf, &error))?;
        let joints = Machine::Ur10e.joints();
        if tree.coordinates() != joints {
            let what = format!("{} moving joints; the logs have {joints}", tree.coordinates());
            return Err(HardwareError::unusable(&urdf, &what));
        }
        let logs = log_files(&folder)?.into_iter().map(CurrentLog::read).collect::<Result<Vec<_>, _>>()?;
        let learned = logs.iter().position(|log| log.name.contains(LEARNED)).ok_or_else(|| {
            HardwareError::unusable(
                &folder,
                &format!("no log to learn from: the name of one .csv file must have {LEARNED}"),
            )
        })?;
        Ok(Self { folder, urdf, tree, logs, learned })
    }

    /// Samples to learn from.
    fn train(&self) -> &Samples {
        &self.logs[self.learned].samples
    }
}

impl CurrentLog {
    fn read(file: PathBuf) -> Result<Self, HardwareError> {
        let log = read_measured(&file, &Machine::Ur10e.columns())?;
        let how = Preparation { step: STEP, cut_off: CUT_OFF, every: 1, margin: DROPPED * STEP };
        let samples = Samples::prepare(&log, &how).map_err(|error| HardwareError::unusable(&file, &error))?;
        let name = file.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self { file, name, samples })
    }
}

/// Creates the tasks of all models. `arguments` are the command-line options other than machine and model.
pub fn current_tasks(data: &Arc<CurrentData>, arguments: &str) -> Vec<Task> {
    MODELS.iter().map(|model| task(*model, Arc::clone(data), arguments)).collect()
}

fn task(model: Model, data: Arc<CurrentData>, arguments: &str) -> Task {
    let (paper, machine, label) = (HARDWARE.name, Machine::Ur10e.name(), label(model.name));
    let source = format!("{} logs in {}", data.logs.len(), data.folder.display());
    Task {
        name: format!("{machine}-{label}"),
        command: format!(
            "leastaction-papers {paper} --machine {machine} --only {machine}-{label}{arguments}"
        ),
        settings: json(&(Machine::Ur10e, model.name, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: model.expected_seconds,
        is_timed: false,
        run: Box::new(move |_, tell| run(&model, &data, tell)),
    }
}

/// Learns from one log and judges on all.
fn run(model: &Model, data: &CurrentData, tell: &Tell) -> Result<Vec<Record>, TaskError> {
    let start = Instant::now();
    let learned = (model.learn)(data, tell)?;
    let seconds = start.elapsed().as_secs_f64();
    let logs = data.logs.iter().enumerate();
    let rows = logs.map(|(k, log)| outcome(model, (log, k == data.learned), &learned, seconds));
    rows.map(|row| Ok(record(model, &row)?)).collect()
}

fn outcome(
    model: &Model,
    (log, is_learned): (&CurrentLog, bool),
    learned: &Learned,
    train_seconds: f64,
) -> CurrentOutcome {
    let predicted = (learned.predict)(&log.samples);
    let errors = squared_errors(&predicted, &log.samples);
    let variances = variances(&log.samples);
    CurrentOutcome {
        machine: Machine::Ur10e.name(),
        model: model.name,
        default: model.is_default,
        log: log.name.clone(),
        is_learned,
        mean_nmse: mean_nmse(&errors, &variances),
        nmse: errors.iter().zip(&variances).map(|(error, variance)| error / variance).collect(),
        rmse: errors.iter().map(|error| error.sqrt()).collect(),
        at_rest: at_rest(&predicted, &log.samples),
        parameters: learned.parameters,
        rank: learned.rank,
        train_seconds,
    }
}

/// Share of every joint's squared error that arises while it rests; NaN without any error.
fn at_rest(predicted: &[f64], samples: &Samples) -> Vec<f64> {
    let n = samples.v.width();
    let mut sums = vec![[0.0; 2]; n];
    let speeds = samples.v.as_flat();
    for (k, (predicted, current)) in predicted.iter().zip(samples.tau.as_flat()).enumerate() {
        let square = (predicted - current) * (predicted - current);
        sums[k % n][0] += if speeds[k].abs() < REST { square } else { 0.0 };
        sums[k % n][1] += square;
    }
    sums.into_iter().map(|[rest, all]| rest / all).collect()
}

fn record(model: &Model, row: &CurrentOutcome) -> Result<Record, serde_json::Error> {
    let joints = row.rmse.iter().enumerate();
    let joints = joints.map(|(k, error)| Measure::error(&format!("joint {}, A", k + 1), *error, None));
    let first = Measure::error("mean NMSE", row.mean_nmse, None);
    let learned = if row.is_learned { ", learned from" } else { "" };
    let table = format!("{}, currents of the drives", row.machine);
    Ok(Record {
        model: row.model.to_owned(),
        is_ours: model.is_ours,
        parameters: row.parameters,
        train_seconds: row.train_seconds,
        measures: std::iter::once(first).chain(joints).collect(),
        ..Record::of(&table, [("log", format!("{}{learned}", row.log))], row)?
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_learning::data::Rows;

    #[test]
    fn errors_at_rest_are_told_from_those_in_motion() {
        let rows = |values: [f64; 6]| Rows::from_flat(2, values.to_vec()).unwrap();
        let still = rows([0.0; 6]);
        let v = rows([0.0, 1.0, -0.005, 1.0, 0.5, -0.005]);
        let samples = Samples { t: vec![0.0; 3], q: still.clone(), v, a: still.clone(), tau: still };
        let shares = at_rest(&[1.0, 1.0, 1.0, 1.0, 2.0, 0.0], &samples);
        assert_eq!(shares, [2.0 / 6.0, 0.0]);
    }
}
