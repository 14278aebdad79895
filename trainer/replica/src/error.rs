use crate::COORDINATES;
use leastaction_core::adapt::{SettingsError, Unfit};
use leastaction_core::constraints::ConstraintError;
use leastaction_core::discrete::StepError;
use leastaction_core::linear::SolveError;
use leastaction_core::model::ModelError;
use thiserror::Error;

/// Reason why a model was refused, or could not be evaluated or stepped.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReplicaError {
    /// The file is damaged, or needs more layers, units or types than this program is compiled for.
    #[error("{0}")]
    Model(ModelError),
    /// The model has a number of coordinates that core is not compiled for in this program.
    #[error(
        "the model has {found} coordinates; the chip's arithmetic, in which sizes are types, is compiled here for {}",
        COORDINATES.map(|n| n.to_string()).join(", ")
    )]
    Coordinates {
        /// Number of coordinates of the model.
        found: usize,
    },
    /// The length of a slice differs from the number of coordinates.
    #[error("{what} has {found} numbers, the model {expected} coordinates")]
    Length {
        /// Name of the slice.
        what: &'static str,
        /// Number of coordinates.
        expected: usize,
        /// Length of the slice.
        found: usize,
    },
    /// Numbers are not those of a motion of the model.
    #[error("a motion of this model is saved as {expected} numbers, not {found}")]
    Saved {
        /// Number of numbers of a motion of the model.
        expected: usize,
        /// Number of numbers given.
        found: usize,
    },
    /// A system of particles was asked for something that only systems in generalised coordinates have.
    #[error("a graph has no {what}")]
    OfGraph {
        /// Name of the missing feature.
        what: &'static str,
    },
    /// Settings of an adapter do not fit the model, or are out of range.
    #[error("{0}")]
    Settings(SettingsError),
    /// Numbers cannot follow a machine together.
    #[error("{0}")]
    Unfit(Unfit),
    /// An acceleration does not exist, or a step cannot be solved.
    #[error("{0}")]
    Step(StepError<f32>),
    /// An acceleration of particles does not exist, a step cannot be solved, or positions are not on their rods.
    #[error("{0}")]
    Constraint(ConstraintError<f32>),
}

impl From<ModelError> for ReplicaError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl From<StepError<f32>> for ReplicaError {
    fn from(error: StepError<f32>) -> Self {
        Self::Step(error)
    }
}

impl From<SolveError> for ReplicaError {
    fn from(error: SolveError) -> Self {
        Self::Step(error.into())
    }
}

impl From<ConstraintError<f32>> for ReplicaError {
    fn from(error: ConstraintError<f32>) -> Self {
        Self::Constraint(error)
    }
}

impl ReplicaError {
    /// Returns an error unless a slice has `expected` numbers.
    pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Length { what, expected, found }) }
    }
}
