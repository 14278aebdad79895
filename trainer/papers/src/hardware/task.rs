//! A model on the logs of a machine as a task, with its rows as records.

use super::calibration::zero_offsets;
use super::data::MachineData;
use super::entries::{Entry, Fitted, Training};
use super::log::Log;
use super::split::{Split, listed};
use super::window::{CALIBRATED, HORIZONS, Summary, window_errors, windows};
use crate::HARDWARE;
use crate::record::{Measure, Record};
use crate::task::{Task, TaskError, Tell, json};
use serde::Serialize;

/// Column that says whether the zero offsets of a tested log were estimated.
pub(super) const ZEROS: &str = "zeros";

/// A row of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Name of the machine.
    pub machine: &'static str,
    /// Name of the model.
    pub model: &'static str,
    /// Whether it is the model that `leastaction train` learns with the configuration that `leastaction look` writes
    /// for the logs.
    pub default: bool,
    /// Tested logs, counted from 0 in order of name.
    pub test: Vec<usize>,
    /// Whether the zero offsets of a tested log's encoders are estimated from its first 2 s.
    pub calibrated: bool,
    /// Median window error after 0.1 s, rad.
    pub error_100ms: f64,
    /// Median window error after 0.5 s, rad.
    pub error_500ms: f64,
    /// Median window error after 1 s, rad.
    pub error_1s: f64,
    /// 90th percentile after 0.1 s, rad.
    pub p90_100ms: f64,
    /// 90th percentile after 0.5 s, rad.
    pub p90_500ms: f64,
    /// 90th percentile after 1 s, rad.
    pub p90_1s: f64,
    /// Number of windows that count.
    pub windows: usize,
    /// Offsets of every tested log that was calibrated, rad.
    pub zero_offsets: Vec<Vec<f64>>,
    /// Number of learned parameters.
    pub parameters: usize,
    /// Total training time, s.
    pub train_seconds: f64,
    /// Seed of the initial weights.
    pub seed: u64,
}

/// A model on a machine's logs.
pub(super) struct Experiment {
    pub entry: Entry,
    pub data: MachineData,
    pub split: Split,
    pub seed: u64,
    pub quick: bool,
    /// Command-line options other than those that name the case.
    pub arguments: String,
}

/// Errors of the windows, as is and calibrated.
#[derive(Default)]
struct Errors {
    windows: [Vec<[f64; 3]>; 2],
    offsets: Vec<Vec<f64>>,
    parameters: usize,
    seconds: f64,
}

impl From<Experiment> for Task {
    fn from(experiment: Experiment) -> Self {
        let Experiment { entry, data, split, seed, quick, arguments } = &experiment;
        let (paper, machine, label) = (HARDWARE.name, data.machine.name(), entry.label());
        let test = match &split.folds[..] {
            [test] => format!(" --test {}", listed(test, ",")),
            _ => String::new(),
        };
        let case = format!("--machine {machine}{test} --only {label}-{seed}");
        let source = format!("{} logs in {}", data.logs.len(), data.folder.display());
        let baseline = data.baseline_name();
        Self {
            name: format!("{machine}-{}-{label}-{seed}", split.label()),
            command: format!("leastaction-papers {paper} {case} --seed {seed}{arguments}"),
            settings: json(&(data.machine, split, entry.model, seed, quick, (&source, baseline))),
            data: source,
            options: arguments.clone(),
            expected_seconds: entry.expected_seconds * split.folds.len() as f64,
            is_timed: false,
            run: Box::new(move |_, tell| experiment.run(tell)),
        }
    }
}

impl Experiment {
    fn run(&self, tell: &Tell) -> Result<Vec<Record>, TaskError> {
        let mut errors = Errors::default();
        for test in &self.split.folds {
            let fitted = self.fit(test, tell)?;
            test.iter().for_each(|log| self.judge(&fitted, &self.data.logs[*log], &mut errors));
            errors.parameters = fitted.parameters;
            errors.seconds += fitted.seconds;
        }
        let kinds: &[bool] = if self.entry.has_zeros { &[false, true] } else { &[false] };
        kinds.iter().map(|calibrated| Ok(self.record(&self.outcome(&errors, *calibrated))?)).collect()
    }

    /// Learns from all logs except these.
    fn fit(&self, test: &[usize], tell: &Tell) -> Result<Fitted, TaskError> {
        let logs = self.data.logs.iter().enumerate();
        let logs = logs.filter(|(k, _)| !test.contains(k)).map(|(_, log)| log).collect();
        (self.entry.fit)(&Training {
            machine: self.data.machine,
            logs,
            baseline: self.data.baseline.as_deref(),
            seed: self.seed,
            quick: self.quick,
            tell,
        })
    }

    /// Adds the windows of a tested log.
    fn judge(&self, fitted: &Fitted, log: &Log, errors: &mut Errors) {
        let [.., steps] = HORIZONS;
        let mut starts = windows(self.data.machine, log, steps);
        starts.retain(|start| *start >= CALIBRATED);
        let predictor = &*fitted.predictor;
        errors.windows[0].extend(window_errors(predictor, log, &starts, &vec![0.0; log.joints()]));
        if self.entry.has_zeros {
            let offsets = zero_offsets(self.data.machine, predictor, log);
            errors.windows[1].extend(window_errors(predictor, log, &starts, &offsets));
            errors.offsets.push(offsets);
        }
    }

    fn outcome(&self, errors: &Errors, calibrated: bool) -> Outcome {
        let summary = Summary::of(&errors.windows[usize::from(calibrated)]);
        let ([error_100ms, error_500ms, error_1s], [p90_100ms, p90_500ms, p90_1s]) =
            (summary.medians, summary.percentiles);
        Outcome {
            machine: self.data.machine.name(),
            model: self.entry.model,
            default: self.entry.is_default,
            test: self.split.tested(),
            calibrated,
            error_100ms,
            error_500ms,
            error_1s,
            p90_100ms,
            p90_500ms,
            p90_1s,
            windows: summary.windows,
            zero_offsets: if calibrated { errors.offsets.clone() } else { Vec::new() },
            parameters: errors.parameters,
            train_seconds: errors.seconds,
            seed: self.seed,
        }
    }

    fn record(&self, row: &Outcome) -> Result<Record, serde_json::Error> {
        let measures = [
            ("0.1 s", row.error_100ms),
            ("0.5 s", row.error_500ms),
            ("1 s", row.error_1s),
            ("90% 0.1 s", row.p90_100ms),
            ("90% 0.5 s", row.p90_500ms),
            ("90% 1 s", row.p90_1s),
        ];
        let calibrated = if row.calibrated { "calibrated" } else { "as is" };
        let table = format!("{}, {}", self.data.machine.name(), self.split.name);
        Ok(Record {
            model: row.model.to_owned(),
            is_ours: self.entry.is_ours,
            parameters: row.parameters,
            seed: row.seed,
            train_seconds: row.train_seconds,
            measures: measures.map(|(name, error)| Measure::error(name, error, None)).into(),
            note: (row.windows == 0).then(|| "no window of the tested logs counts".to_owned()),
            ..Record::of(&table, [(ZEROS, calibrated.to_owned())], row)?
        })
    }
}
