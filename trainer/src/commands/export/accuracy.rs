//! What rounding the weights costs, on the log that they were learned from.

use super::Precision;
use leastaction::cli::{Failure, Output};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::ModelError;
use leastaction_learning::architecture::Architecture;
use leastaction_learning::config::{Config, DataConfig};
use leastaction_learning::data::Dataset;
use leastaction_learning::evaluate::{
    Beginning, acceleration_mse, integration_errors, one_step_mse, rollout,
};
use leastaction_learning::training::Solved;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Root-mean-square errors on a log, of the weights as trained and as shipped.
#[derive(Serialize)]
pub struct Accuracy {
    /// The log.
    data: PathBuf,
    /// Bits of a shipped weight.
    bits: u8,
    /// As trained, in double precision.
    trained: Errors,
    /// As the file has them.
    shipped: Errors,
}

/// Root-mean-square errors in metres and radians, and seconds.
#[derive(Clone, Copy, Serialize)]
struct Errors {
    /// Of accelerations, where the log has v and a.
    acceleration: Option<f64>,
    /// Of positions one step ahead, where the model is stepped.
    one_step: Option<f64>,
    /// Of positions over whole trajectories, their median.
    trajectory: Option<f64>,
}

/// The model whose weights are compared.
pub struct Compared<'a> {
    /// Its shape.
    pub architecture: &'a Architecture,
    /// The order of its steps.
    pub order: u8,
    /// What the control did between samples in training.
    pub control: Option<ControlKind>,
    /// As trained.
    pub trained: &'a [f64],
    /// As shipped.
    pub shipped: &'a [f64],
}

impl Compared<'_> {
    /// Measures on `data`, or else on the log that the run's configuration names; where that is not there any more, says so.
    pub fn measure(
        &self,
        (run, data): (&Path, Option<&Path>),
        precision: Precision,
        output: Output,
    ) -> Result<Option<Accuracy>, Failure> {
        let config = match data {
            Some(file) => DataConfig::new(file),
            None => Config::read(&run.join("config.toml"))?.data,
        };
        let log = PathBuf::from(config.file.to_string());
        let mut set = match config.read() {
            Ok((set, _)) => set,
            Err(error) if data.is_some() => return Err(Failure::Input(error.to_string())),
            Err(error) => {
                output.note(&format!(
                    "note: what 16 bits cost is not known: {error}; name the log with --data"
                ));
                return Ok(None);
            }
        };
        if set.n != self.architecture.n() {
            let message = format!("q has {} coordinates, the model {}", set.n, self.architecture.n());
            return Err(Failure::input(&log, message));
        }
        set.control = set.control.or(self.control);
        // Training told of the seams.
        let _ = set.unwrap_angles(&self.architecture.coordinates());
        let failed = |error: ModelError| Failure::input(run, error);
        let trained = self.errors(self.trained, &set).map_err(failed)?;
        let shipped = self.errors(self.shipped, &set).map_err(failed)?;
        Ok(Some(Accuracy { data: log, bits: precision.bits(), trained, shipped }))
    }

    fn errors(&self, weights: &[f64], log: &Dataset) -> Result<Errors, ModelError> {
        let (architecture, order) = (self.architecture, self.order);
        let steps = architecture.has_steps();
        let one_step = || one_step_mse(architecture, weights, order, log);
        let rollout = || rollout(architecture, weights, order, (log, Beginning::Velocity));
        let runs = steps.then(rollout).transpose()?;
        Ok(Errors {
            acceleration: acceleration_mse(architecture, weights, log)?.and_then(|(error, _)| root(error)),
            one_step: steps.then(one_step).transpose()?.and_then(root),
            trajectory: runs.map(|runs| integration_errors(&runs, log).median.sqrt()),
        })
    }
}

/// The root of the mean square, of what could be computed.
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
