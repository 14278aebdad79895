//! Resuming a run from a checkpoint.

use super::plan::Plan;
use crate::checkpoint::{Checkpoint, CheckpointError, State};
use crate::config::LogFiles;
use thiserror::Error;

/// A checkpoint from which a run cannot resume.
#[derive(Debug, Error)]
pub enum ResumeError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] CheckpointError),
    /// The run began with another configuration.
    #[error(
        "this run began with another configuration: {differences}; set it back, or train in another folder"
    )]
    OtherConfiguration {
        /// The keys that differ.
        differences: String,
    },
    /// The run began with other data.
    #[error(
        "this run began with other data than {file} now has; bring the data back, or train in another folder"
    )]
    OtherData {
        /// The data file.
        file: LogFiles,
    },
}

impl Checkpoint {
    /// The checkpoint of a run of this plan in this state.
    pub fn new(plan: &Plan, state: &State) -> Self {
        Self {
            identity: plan.config.identity().to_toml(),
            data: plan.data_fingerprint,
            architecture: plan.architecture.clone(),
            trained_step: plan.trained_step,
            range: plan.range.clone(),
            calibration: plan.calibration(),
            state: state.clone(),
        }
    }

    /// Refuses a plan with another configuration or other data.
    pub fn check(&self, plan: &Plan) -> Result<(), ResumeError> {
        let now = plan.config.identity().to_toml();
        if self.identity != now {
            return Err(ResumeError::OtherConfiguration { differences: differences(&self.identity, &now) });
        }
        if self.architecture != plan.architecture {
            let differences = "the model that [model] from names has changed since".to_owned();
            return Err(ResumeError::OtherConfiguration { differences });
        }
        if self.data != plan.data_fingerprint {
            return Err(ResumeError::OtherData { file: plan.config.data.file.clone() });
        }
        Ok(())
    }
}

/// Lists every line of the old TOML that the new TOML lacks, with the new value.
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
