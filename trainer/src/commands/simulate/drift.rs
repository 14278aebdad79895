//! Drift of a machine along a log: its errors compared with those along a reference.

use super::replay::Replay;
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::probability;
use leastaction::evaluation::{LogReading, Tell};
use leastaction_adaptation::drift::{Difference, Drift, Windows};
use leastaction_learning::data::Dataset;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Comparison of a replayed log with the machine as it was.
#[derive(Args, Clone)]
#[command(next_help_heading = "Drift of the machine (with --replay)")]
pub struct Comparison {
    /// Log of the machine as it was, whose errors are compared with those of --replay [default: the log that the model was trained on, by
    /// --config or the run].
    #[arg(long, value_name = "LOG", conflicts_with = "scenario")]
    reference: Option<PathBuf>,
    /// False alarms of drift, per log.
    #[arg(long, value_name = "RATE", default_value_t = 1e-3, value_parser = probability, conflicts_with = "scenario")]
    false_alarms: f64,
}

/// A log of the machine as it was.
pub struct Reference {
    /// File of the log.
    pub file: PathBuf,
    /// Contents of the log.
    pub data: Dataset,
}

/// Comparison of the errors along a log with those along a reference.
#[derive(Debug, Serialize)]
pub struct DriftReport {
    /// The reference.
    pub reference: PathBuf,
    /// Rate at which a log without change is beyond the threshold.
    pub false_alarms: f64,
    /// Whether the value is beyond the threshold.
    pub drifted: bool,
    /// Value, threshold, and what they are made of.
    #[serde(flatten)]
    pub drift: Drift,
}

impl Comparison {
    /// Reads the reference for a log that is replayed; tells why there is none.
    pub fn reference(
        &self,
        replay: &Replay,
        log: &Dataset,
        tell: Tell,
    ) -> Result<Option<Reference>, Failure> {
        let Some(reading) = self.reading(replay)? else {
            tell(nothing("name a log of the machine as it was, with --reference"));
            return Ok(None);
        };
        let file = reading.file();
        if is_same(&file, replay.log) {
            tell(nothing("this log is the reference itself"));
            return Ok(None);
        }
        // Notes on it were told when the model was trained.
        let read = reading.at_step(Some(log.h)).read((None, None), &mut |_| ());
        match read.and_then(|data| alike(&file, data, log)) {
            Ok(data) => Ok(Some(Reference { file, data })),
            // A log that nobody named may be gone.
            Err(Failure::Input(why)) if self.reference.is_none() => {
                tell(nothing(&why));
                Ok(None)
            }
            Err(failure) => Err(failure),
        }
    }

    /// Compares the errors of a log with those of the reference, along which the model failed some times; tells why it cannot.
    pub fn compare(
        &self,
        (reference, model_errors): (PathBuf, u32),
        (before, now): (&Windows, &Windows),
        tell: Tell,
    ) -> Option<DriftReport> {
        if model_errors > 0 {
            tell(nothing(&format!("the model could not be stepped along {}", reference.display())));
            return None;
        }
        let drift = Drift::new(before, now, self.false_alarms);
        let drift = drift.map_err(|error| tell(nothing(&error.to_string()))).ok()?;
        let (false_alarms, drifted) = (self.false_alarms, drift.has_drifted());
        Some(DriftReport { reference, false_alarms, drifted, drift })
    }

    /// How the reference is read: as it was named, or by the configuration that names the log of the training.
    fn reading(&self, replay: &Replay) -> Result<Option<LogReading>, Failure> {
        match &self.reference {
            Some(file) => LogReading::new(replay.config, Some(file.clone().into()), replay.file).map(Some),
            None => LogReading::of_training(replay.config, replay.file),
        }
    }
}

fn is_same(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Contents of a reference, if they can be compared with those of a log.
fn alike(file: &Path, data: Dataset, log: &Dataset) -> Result<Dataset, Failure> {
    let ([n, other], [h, step]) = ([data.n, log.n], [data.h, log.h]);
    if n != other || (h - step).abs() > 1e-6 * step {
        let both =
            format!("{n} coordinates and ticks of {h} s, the log that is replayed {other} and {step} s");
        return Err(Failure::input(file, both));
    }
    Ok(data)
}

fn nothing(why: &str) -> String {
    format!("drift is not measured: {why}")
}

impl fmt::Display for DriftReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { reference, false_alarms, drifted, drift } = self;
        let Drift { value, threshold, errors, coordinates, .. } = drift;
        let reference = reference.display();
        writeln!(
            f,
            "{:<32} {value:.2}; {threshold:.2} is exceeded at a rate of {false_alarms} without change",
            "drift"
        )?;
        writeln!(f, "{:<32} {}", "drift by coordinate", list(coordinates, |of| of.value))?;
        writeln!(f, "{:<32} {}", "errors over the reference's", list(coordinates, |of| of.errors))?;
        if *drifted {
            writeln!(
                f,
                "THE MACHINE HAS DRIFTED: errors are {errors:.2} times those of {reference}{}; see `leastaction adapt`",
                most(coordinates)
            )?;
        }
        Ok(())
    }
}

fn list(coordinates: &[Difference], of: fn(&Difference) -> f64) -> String {
    coordinates.iter().map(|one| format!("{:.2}", of(one))).collect::<Vec<_>>().join(", ")
}

/// The greatest difference, in words.
fn most(coordinates: &[Difference]) -> String {
    let signs = coordinates.iter().enumerate().flat_map(|(i, of)| {
        [
            ("the mean error", of.mean),
            ("the error in the direction of motion", of.direction),
            ("the error in the direction of the command", of.command),
            ("the squared error", of.windows),
            ("the squared error of single ticks", of.ticks),
        ]
        .map(|(name, z)| (i, name, z))
    });
    let signs = signs.filter_map(|(i, name, z)| Some((i, name, z?)));
    let greatest = signs.max_by(|(.., a), (.., b)| a.abs().total_cmp(&b.abs()));
    greatest.map_or(String::new(), |(i, name, z)| {
        format!(", most of all {name} of q{i} ({z:+.1} standard errors)")
    })
}
