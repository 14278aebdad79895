use crate::{Phase, Variable};
use leastaction_core::model::ModelError;
use leastaction_replica::ReplicaError;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a call of an importer was refused; the instance is then unchanged.
#[derive(Debug, Error)]
pub enum FmuError {
    /// The model file cannot be read.
    #[error("{}: {error}; the unit's resources must be where the importer says", file.display())]
    Resource {
        /// The file.
        file: PathBuf,
        /// Reason.
        error: std::io::Error,
    },
    /// The importer named no folder of resources, or not as the standard demands.
    #[error(
        "{0:?} is not a folder of resources: FMI 3.0 demands a path, FMI 2.0 an URI that begins with file:"
    )]
    Resources(String),
    /// The model file is damaged.
    #[error("the model in the unit's resources: {0}")]
    Model(ModelError),
    /// The description is not that of the model file.
    #[error(
        "the instantiation token is {found:?}, but the model in the unit's resources has {expected:?}: description and resources are not of the same unit"
    )]
    Token {
        /// Token of the model file.
        expected: String,
        /// Token of the description.
        found: String,
    },
    /// The model has particles instead of coordinates.
    #[error("a graph has particles instead of coordinates, so no unit can be made of it")]
    OfGraph,
    /// Core refuses to evaluate or to step.
    #[error("{0}")]
    Core(#[from] ReplicaError),
    /// A step could not be solved.
    #[error(
        "the step from t = {time} s: {error}; the state is still that at the beginning of the communication step"
    )]
    Step {
        /// Time at the start of the step, s.
        time: f64,
        /// Reason.
        error: ReplicaError,
    },
    /// A call does not fit the phase.
    #[error("{call} is not allowed {phase}")]
    Order {
        /// Refused call, in words.
        call: &'static str,
        /// Present phase.
        phase: Phase,
    },
    /// A function belongs to the other interface.
    #[error("{call} belongs to {belongs}, but this instance is of {own}")]
    OtherInterface {
        /// Function.
        call: &'static str,
        /// Interface of the function.
        belongs: &'static str,
        /// Interface of the instance.
        own: &'static str,
    },
    /// No variable has this value reference.
    #[error("no variable has the value reference {0}")]
    Reference(u32),
    /// A variable must not be set, or not now.
    #[error("{} must not be set {phase}{}", variable.name(), remedy(*variable))]
    Set {
        /// The variable.
        variable: Variable,
        /// Present phase.
        phase: Phase,
    },
    /// There are no variables of a type.
    #[error("the unit has no variable of type {0}; all its variables are real numbers (FMI 3.0: Float64)")]
    Type(&'static str),
    /// A list has another length.
    #[error("{what} needs {expected} numbers, not {found}")]
    Length {
        /// Name of the list.
        what: &'static str,
        /// Number of numbers that it needs.
        expected: usize,
        /// Number of numbers given.
        found: usize,
    },
    /// A number is infinite or NaN, also in single precision, in which the model computes.
    #[error("{what} is {value}, which is no number of single precision")]
    NotFinite {
        /// Name of the number.
        what: String,
        /// The number.
        value: f64,
    },
    /// The step is not positive.
    #[error("h is {0} s; a step must be longer than 0 and at most 3600 s")]
    StepSize(f64),
    /// The communication step does not begin where the last one ended.
    #[error("the communication step begins at {found} s, but the unit is at {expected} s")]
    Point {
        /// Time of the unit, s.
        expected: f64,
        /// Time given, s.
        found: f64,
    },
    /// The communication step is no multiple of the model's step.
    #[error(
        "the communication step of {size} s is no whole multiple of the model's step, h = {h} s; a model is stepped as it was trained, so choose a multiple"
    )]
    Remainder {
        /// Communication step, s.
        size: f64,
        /// Step of the model, s.
        h: f64,
    },
    /// The communication step is too long, or negative.
    #[error(
        "the communication step is {0} s; it must be 0 or longer, and at most a thousand million steps of the model"
    )]
    CommunicationStep(f64),
    /// A state to be restored is of something else.
    #[error("the state is not that of an instance of this unit and this interface")]
    OtherState,
    /// The bytes of a state are damaged.
    #[error("the bytes are no undamaged state of a unit: {0}")]
    Bytes(postcard::Error),
    /// A pointer is null.
    #[error("{0} is a null pointer")]
    Null(&'static str),
    /// A string is not UTF-8.
    #[error("{0} is not UTF-8")]
    Text(&'static str),
    /// The unit lacks an optional part of the standard.
    #[error("the unit has no {0}, as its description says")]
    Missing(&'static str),
    /// The library contains a mistake.
    #[error("a mistake in the library: {0}; please report it")]
    Mistake(String),
}

impl FmuError {
    /// Returns an error unless a list has `expected` numbers.
    pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self::Length { what, expected, found }) }
    }
}

/// The way to set a variable after all.
const fn remedy(variable: Variable) -> &'static str {
    use crate::Kind;
    match variable.kind {
        Kind::Position | Kind::Velocity => "; q_start and v_start set the state before the start",
        Kind::StartPosition | Kind::StartVelocity => "; it acts before the end of initialisation",
        _ => "",
    }
}
