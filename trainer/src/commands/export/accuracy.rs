//! Loss of accuracy caused by rounding the weights, measured on the log that they were learned from.

use super::Precision;
use leastaction::cli::{Failure, Output};
use leastaction::evaluation::LogReading;
use leastaction_core::model::ModelError;
use leastaction_learning::data::Dataset;
use leastaction_learning::evaluate::{acceleration_mse, integration_errors, one_step_mse};
use leastaction_learning::training::Solved;
use leastaction_models::{Beginning, Model};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Root-mean-square errors on a log, with weights as trained and as shipped.
#[derive(Serialize)]
pub struct Accuracy {
    /// The log.
    data: PathBuf,
    /// Bits of a shipped weight.
    bits: u8,
    /// Errors with the weights as trained, in double precision.
    trained: Errors,
    /// Errors with the weights as shipped in the file.
    shipped: Errors,
}

/// Root-mean-square errors, in SI units.
#[derive(Clone, Copy, Serialize)]
struct Errors {
    /// Error of accelerations, if the log has v and a.
    acceleration: Option<f64>,
    /// Error of positions one step ahead, if the model can be stepped.
    one_step: Option<f64>,
    /// Median error of positions over whole trajectories.
    trajectory: Option<f64>,
}

/// A model before and after rounding its weights.
pub struct Compared {
    /// Model as trained.
    pub trained: Model,
    /// Model as shipped.
    pub shipped: Model,
}

impl Compared {
    /// Measures on `data`, or else on the log that the run's configuration names; if that log no longer exists, prints a note.
    pub fn measure(
        &self,
        (run, data): (&Path, Option<&Path>),
        precision: Precision,
        output: Output,
    ) -> Result<Option<Accuracy>, Failure> {
        let own = run.join("config.toml");
        let reading = LogReading::new(data.is_none().then_some(&own), data.map(Into::into), run)?;
        let log = reading.file();
        let trained = self.trained.facts.trained_step.map(|step| step.control);
        let mut said = Vec::new();
        let mut set = match reading.read((None, trained), &mut |sentence| said.push(sentence)) {
            Ok(set) => set,
            Err(Failure::Input(error)) if data.is_none() => {
                output.note(&format!(
                    "note: what 16 bits cost is not known: {error}; name the log with --data"
                ));
                return Ok(None);
            }
            Err(failure) => return Err(failure),
        };
        // Training has already reported on its own log.
        said.iter().filter(|_| data.is_some()).for_each(|sentence| output.note(&format!("note: {sentence}")));
        if set.n != self.trained.n() {
            let message = format!("q has {} coordinates, the model {}", set.n, self.trained.n());
            return Err(Failure::input(&log, message));
        }
        // Training has already reported the seams.
        let _ = set.unwrap_angles(&self.trained.architecture.coordinates());
        let failed = |error: ModelError| Failure::input(run, error);
        let trained = errors(&self.trained, &set).map_err(failed)?;
        let shipped = errors(&self.shipped, &set).map_err(failed)?;
        Ok(Some(Accuracy { data: log, bits: precision.bits(), trained, shipped }))
    }
}

fn errors(model: &Model, log: &Dataset) -> Result<Errors, ModelError> {
    let order = model.facts.trained_step.map_or(4, |step| step.order.number());
    let steps = model.architecture.has_steps();
    let runs = steps.then(|| model.rollout(order, (log, Beginning::Velocity))).transpose()?;
    Ok(Errors {
        acceleration: acceleration_mse(model, log)?.and_then(|(error, _)| root(error)),
        one_step: steps.then(|| one_step_mse(model, order, log)).transpose()?.and_then(root),
        trajectory: runs.map(|runs| integration_errors(&runs, log).median.sqrt()),
    })
}

/// The root of the mean square over the samples that could be computed.
fn root(error: Solved) -> Option<f64> {
    error.mean_square.map(f64::sqrt)
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { data, bits, trained, shipped } = self;
        let bits = format!("{bits} bits");
        writeln!(f, "error on {} (root mean square, SI):", data.display())?;
        writeln!(f, "{:<34} {:>11} {bits:>11} {:>9}", "", "as trained", "times")?;
        let rows = [
            ("accelerations", trained.acceleration, shipped.acceleration),
            ("positions one step ahead", trained.one_step, shipped.one_step),
            ("positions over whole trajectories", trained.trajectory, shipped.trajectory),
        ];
        for (what, trained, shipped) in rows {
            if let (Some(trained), Some(shipped)) = (trained, shipped) {
                writeln!(f, "{what:<34} {trained:>11.2e} {shipped:>11.2e} {:>9.3}", shipped / trained)?;
            }
        }
        Ok(())
    }
}
