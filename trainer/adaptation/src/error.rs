use leastaction_core::adapt::{PatchError, SettingsError};
use leastaction_core::model::ModelError;
use leastaction_replica::ReplicaError;
use thiserror::Error;

/// Reason why no number of a model can follow a log.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AdaptationError {
    /// The model has neither bodies nor friction of its coordinates.
    #[error(
        "a model of this family has no number that can follow the machine: it has neither bodies nor friction of single coordinates"
    )]
    Nothing,
    /// A body that the model does not have.
    #[error("there is no body {found}; the model has {count}, counted from 0")]
    NoSuchBody {
        /// The body that was asked for.
        found: usize,
        /// Number of bodies of the model.
        count: usize,
    },
    /// The model cannot be written as a file.
    #[error("{0}")]
    Encoding(String),
    /// The model's file is invalid.
    #[error("{0}")]
    Model(ModelError),
    /// The patch is damaged, or of another model.
    #[error("{0}")]
    Patch(#[from] PatchError),
    /// The settings are damaged, or of another model or loop.
    #[error("{0}")]
    Settings(#[from] SettingsError),
    /// The chip's arithmetic refused the model or the numbers.
    #[error("{0}")]
    Replica(#[from] ReplicaError),
    /// The log has no commands.
    #[error("trajectory {id} has no commands u, and without forces no mass can be told")]
    NoCommands {
        /// Number of the trajectory.
        id: i64,
    },
    /// The log and the model differ in size.
    #[error("the log has {found} coordinates, the model {expected}")]
    Coordinates {
        /// Number of coordinates of the log.
        found: usize,
        /// Number of coordinates of the model.
        expected: usize,
    },
    /// No window is whole.
    #[error("no trajectory is as long as a window of {window} s: {longest} s at most")]
    TooShort {
        /// Length of a window, s.
        window: f64,
        /// Length of the longest trajectory, s.
        longest: f64,
    },
}

impl From<ModelError> for AdaptationError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}
