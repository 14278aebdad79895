//! The checkpoint file.

use super::plan::Plan;
use super::state::{Best, State};
use crate::architecture::Architecture;
use crate::checksummed::{self, ReadError};
use crate::model_file::Facts;
use leastaction_core::model::{CoordinateRange, TrainedStep};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The first bytes of the file: what it is, and the version of its layout.
const MAGIC: &[u8] = b"LARUN\x05";

/// Everything in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Checkpoint {
    /// The configuration without what may change on resuming, as TOML.
    pub identity: String,
    /// Fingerprint of the data.
    pub data: u64,
    /// Of the model.
    pub architecture: Architecture,
    /// Of the model.
    pub trained_step: Option<TrainedStep>,
    /// What the data covered.
    pub range: Vec<CoordinateRange>,
    /// Where the run is.
    pub state: State,
}

/// A checkpoint that cannot be used.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("{error}; {}", way_out(.0), error = .0)]
    File(#[from] ReadError),
    /// The run began with another configuration.
    #[error(
        "this run began with another configuration: {differences}; set it back, or train in another folder"
    )]
    OtherConfiguration {
        /// The keys that differ.
        differences: String,
    },
    /// The run began with other data.
    #[error("this run began with other data than {} now has; bring the data back, or train in another folder", file.display())]
    OtherData {
        /// The data file.
        file: PathBuf,
    },
}

fn way_out(error: &ReadError) -> &'static str {
    match error {
        ReadError::File { .. } => "is this the folder of a training run?",
        ReadError::Damaged { .. } => "train again with --force",
    }
}

impl Checkpoint {
    pub fn new(plan: &Plan, state: &State) -> Self {
        Self {
            identity: plan.config.identity().to_toml(),
            data: plan.data_fingerprint,
            architecture: plan.architecture.clone(),
            trained_step: plan.trained_step,
            range: plan.range.clone(),
            state: state.clone(),
        }
    }

    /// Refuses to go on with another configuration or other data.
    pub fn check(&self, plan: &Plan) -> Result<(), CheckpointError> {
        let now = plan.config.identity().to_toml();
        if self.identity != now {
            return Err(CheckpointError::OtherConfiguration {
                differences: differences(&self.identity, &now),
            });
        }
        if self.architecture != plan.architecture {
            let differences = "the model that [model] from names has changed since".to_owned();
            return Err(CheckpointError::OtherConfiguration { differences });
        }
        if self.data != plan.data_fingerprint {
            return Err(CheckpointError::OtherData { file: plan.config.data.file.clone() });
        }
        Ok(())
    }

    pub fn write(&self, file: &Path) -> io::Result<()> {
        checksummed::write(file, MAGIC, self)
    }

    pub fn read(file: &Path) -> Result<Self, CheckpointError> {
        Ok(checksummed::read(file, MAGIC)?)
    }
}

/// Every line of the old TOML that the new one does not have, with the new value.
fn differences(then: &str, now: &str) -> String {
    let then = then.lines().filter(|line| !now.lines().any(|other| other == *line));
    let key = |line: &str| line.split(" = ").next().unwrap_or_default().to_owned();
    let describe = |line: &str| {
        let new = now.lines().find(|other| key(other) == key(line)).unwrap_or("not set");
        format!("`{line}` then, `{new}` now")
    };
    let list: Vec<_> = then.map(describe).collect();
    if list.is_empty() { "a key was added".to_owned() } else { list.join("; ") }
}

/// A trained model as a run holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Its shape.
    pub architecture: Architecture,
    /// The step that it was trained with, where the loss has one.
    pub trained_step: Option<TrainedStep>,
    /// What the training data covered of every coordinate.
    pub range: Vec<CoordinateRange>,
    /// The best weights and their losses.
    pub best: Best,
    /// Iterations of the run so far.
    pub iterations: u64,
    /// Where it comes from, for people: the same for the same run.
    pub provenance: String,
}

impl Trained {
    /// What a model file says of it beside its shape and weights.
    pub fn facts(&self) -> Facts {
        let Self { trained_step, range, provenance, .. } = self.clone();
        Facts { range, ..Facts::new(trained_step, &provenance) }
    }

    /// The best model of the run in a folder.
    ///
    /// # Errors
    /// [`CheckpointError`] where there is no usable checkpoint.
    pub fn read(folder: &Path) -> Result<Self, CheckpointError> {
        let checkpoint = Checkpoint::read(&folder.join(super::folder::CHECKPOINT))?;
        let provenance = checkpoint.provenance();
        let Checkpoint { architecture, trained_step, range, state, .. } = checkpoint;
        Ok(Self {
            architecture,
            trained_step,
            range,
            best: state.best,
            iterations: state.iteration,
            provenance,
        })
    }
}

impl Checkpoint {
    fn provenance(&self) -> String {
        let Best { iteration, train, validation, .. } = &self.state.best;
        let validation = validation.map_or(String::new(), |loss| format!(", validation loss {loss:.3e}"));
        let config: toml::Table = toml::from_str(&self.identity).unwrap_or_default();
        let setting = |key: &str| config.get("training").and_then(|training| training.get(key)).cloned();
        let name =
            |key: &str| setting(key).and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default();
        let seed = setting("seed").and_then(|seed| seed.as_integer()).unwrap_or_default();
        let (loss, optimiser) = (name("loss"), name("optimiser"));
        format!(
            "leastaction {}; {loss} by {optimiser}, seed {seed}, data {:016x}; iteration {iteration}, training loss {train:.3e}{validation}",
            env!("CARGO_PKG_VERSION"),
            self.data,
        )
    }
}
