use crate::COORDINATES;
use leastaction_core::constraints::ConstraintError;
use leastaction_core::discrete::StepError;
use leastaction_core::linear::SolveError;
use leastaction_core::model::ModelError;
use thiserror::Error;

/// Why a model was refused, or could not be evaluated or stepped.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReplicaError {
    /// The file is damaged, or asks for layers, units or types beyond those that are compiled here.
    #[error("{0}")]
    Model(ModelError),
    /// The model has a number of coordinates that core is not compiled for here.
    #[error(
        "the model has {found} coordinates; the chip's arithmetic, in which sizes are types, is compiled here for {}",
        COORDINATES.map(|n| n.to_string()).join(", ")
    )]
    Coordinates {
        /// Its number.
        found: usize,
    },
    /// A slice has not as many numbers as the model has coordinates.
    #[error("{what} has {found} numbers, the model {expected} coordinates")]
    Length {
        /// Which slice.
        what: &'static str,
        /// The number of coordinates.
        expected: usize,
        /// Of the slice.
        found: usize,
    },
    /// Particles are asked for what only systems in generalised coordinates have.
    #[error("a graph has no {what}")]
    OfGraph {
        /// What it has not.
        what: &'static str,
    },
    /// An acceleration does not exist, or a step cannot be solved.
    #[error("{0}")]
    Step(StepError<f32>),
    /// The same of particles, or positions that are not on their rods.
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
    /// An error unless a slice has `expected` numbers.
    pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Length { what, expected, found }) }
    }
}
