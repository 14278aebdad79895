//! Friction of a positioning axis: models learn from one log, and predict all of it from its start under the logged force.
//!
//! **Protocol.** The error is the root mean square of the position over a whole log, from q(0) and v = 0, each force held until the next
//! sample. It is that of the log that is learned from and, where there is one, that of another. Besides, each third of the log is held back
//! in turn: models learn from the other two, and predict it from its measured start.
//!
//! Identified numbers move exactly, with friction that sticks (`motion`); our models do the steps that a chip does, one to a sample.

mod identify;
mod models;
mod motion;
mod ours;
mod stretch;

pub use motion::Axis;

use super::entries::label;
use super::error::HardwareError;
use super::machine::Machine;
use crate::HARDWARE;
use crate::record::{Measure, Record};
use crate::task::{Task, TaskError, Tell, json};
use models::{Learned, MODELS, Model};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use stretch::Stretch;

/// Log to learn from.
const TRAIN: &str = "train.csv";
/// Log that is only predicted.
const TEST: &str = "test.csv";

/// Logs of an axis.
#[derive(Clone, Debug)]
pub struct AxisData {
    train: Stretch,
    test: Option<Stretch>,
}

impl AxisData {
    /// Reads `data`/emps/train.csv, and test.csv beside it if it is there: columns time (s), position (m) and force (N).
    ///
    /// # Errors
    /// [`HardwareError`].
    pub fn read(data: &Path) -> Result<Self, HardwareError> {
        let folder = data.join(Machine::Emps.name());
        let test = Some(folder.join(TEST)).filter(|file| file.exists());
        let test = test.map(|file| Stretch::read(&file)).transpose()?;
        Ok(Self { train: Stretch::read(&folder.join(TRAIN))?, test })
    }
}

/// A row of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisOutcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is the model that `leastaction train` learns with the configuration that `leastaction look` writes
    /// for the log.
    pub default: bool,
    /// Root mean square error of the position along the log that was learned from, mm.
    pub error_train_mm: f64,
    /// Error along the other log, mm; `None` if there is none.
    pub error_test_mm: Option<f64>,
    /// Errors along each third of the log, learned from the other two, mm.
    pub error_thirds_mm: [f64; 3],
    /// Error along the log that was learned from with two steps to a sample, mm: it differs from `error_train_mm` by as much as the
    /// step matters. `None` for a model that moves exactly.
    pub error_half_step_mm: Option<f64>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Identified numbers; `None` for our models.
    pub numbers: Option<Axis>,
    /// Time to learn from the whole log, s.
    pub train_seconds: f64,
}

/// Creates the tasks of all models. `arguments` are the command-line options other than machine and model.
pub fn axis_tasks(data: &Arc<AxisData>, (quick, arguments): (bool, &str)) -> Vec<Task> {
    MODELS.iter().map(|model| task(*model, Arc::clone(data), (quick, arguments))).collect()
}

fn task(model: Model, data: Arc<AxisData>, (quick, arguments): (bool, &str)) -> Task {
    let (paper, machine, label) = (HARDWARE.name, Machine::Emps.name(), label(model.name));
    let test =
        data.test.as_ref().map_or(String::new(), |test| format!(", tested on {}", test.file.display()));
    let source = format!("{}: {} samples{test}", data.train.file.display(), data.train.q.len());
    Task {
        name: format!("{machine}-{label}"),
        command: format!(
            "leastaction-papers {paper} --machine {machine} --only {machine}-{label}{arguments}"
        ),
        settings: json(&(Machine::Emps, model.name, quick, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: if model.is_ours() { 120.0 } else { 2.0 },
        is_timed: false,
        run: Box::new(move |_, tell| {
            let row = outcome(&model, &data, quick, tell)?;
            Ok(vec![record(&model, &row)?])
        }),
    }
}

fn outcome(model: &Model, data: &AxisData, quick: bool, tell: &Tell) -> Result<AxisOutcome, TaskError> {
    let start = Instant::now();
    let learned = model.learn(&[&data.train], quick, tell)?;
    let train_seconds = start.elapsed().as_secs_f64();
    let test = data.test.as_ref().map(|test| error_mm(&learned, test, 1));
    let halves = model.is_ours().then(|| error_mm(&learned, &data.train, 2));
    Ok(AxisOutcome {
        machine: Machine::Emps.name(),
        model: model.name,
        default: model.is_default,
        error_train_mm: error_mm(&learned, &data.train, 1)?,
        error_test_mm: test.transpose()?,
        error_thirds_mm: thirds(model, data, quick, tell)?,
        error_half_step_mm: halves.transpose()?,
        parameters: learned.parameters,
        numbers: learned.axis,
        train_seconds,
    })
}

/// Errors of every third, learned from the other two.
fn thirds(model: &Model, data: &AxisData, quick: bool, tell: &Tell) -> Result<[f64; 3], TaskError> {
    let folder = tempfile::tempdir()?;
    let [a, b, c] = &data.train.thirds(folder.path())?;
    let held_back = |[learned @ .., tested]: [&Stretch; 3]| -> Result<f64, TaskError> {
        error_mm(&model.learn(&learned, quick, tell)?, tested, 1)
    };
    Ok([held_back([b, c, a])?, held_back([a, c, b])?, held_back([a, b, c])?])
}

fn error_mm(learned: &Learned, stretch: &Stretch, parts: usize) -> Result<f64, TaskError> {
    Ok(1e3 * stretch.error(&(learned.predict)(stretch, parts)?))
}

fn record(model: &Model, row: &AxisOutcome) -> Result<Record, serde_json::Error> {
    let error = |name: &str, error: f64| Measure::error(name, error, None);
    let [first, second, third] = row.error_thirds_mm;
    let table = format!("{}, position along a whole log", row.machine);
    Ok(Record {
        model: row.model.to_owned(),
        is_ours: model.is_ours(),
        parameters: row.parameters,
        train_seconds: row.train_seconds,
        measures: vec![
            error("learned from, mm", row.error_train_mm),
            error("other log, mm", row.error_test_mm.unwrap_or(f64::NAN)),
            error("first third held back, mm", first),
            error("second", second),
            error("last", third),
        ],
        ..Record::of(&table, [("log", TRAIN.to_owned())], row)?
    })
}
