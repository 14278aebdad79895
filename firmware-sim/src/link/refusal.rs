use crate::error::SetupError;
use core::fmt;
use leastaction_core::model::{Coded, ModelError, entry_of};
use serde::{Deserialize, Serialize};

/// Reason why a processor refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The frame was damaged, or is no request.
    Frame,
    /// The messages have another version.
    Version {
        /// Version that the processor speaks.
        supported: u8,
    },
    /// The processor has no program for this number of coordinates.
    Coordinates {
        /// Largest number of coordinates for which it has a program.
        supported: u8,
    },
    /// A tick came before a program was begun.
    NotBegun,
    /// The processor has no model in its flash.
    NoModel,
    /// The model in the processor's flash is refused.
    Model(ModelRefusal),
    /// The program is refused.
    Program(ProgramFault),
}

/// Refusal of a model file: a reason of core's [catalogue](leastaction_core::model::CATALOGUE).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelRefusal {
    /// Number of the reason in the catalogue.
    pub code: u8,
    /// Numbers of the error; those beyond 32 bits are cut to `u32::MAX`.
    pub numbers: [u32; 3],
}

impl From<ModelError> for ModelRefusal {
    fn from(error: ModelError) -> Self {
        let Coded { code, numbers, .. } = error.coded();
        Self { code, numbers: numbers.map(|number| u32::try_from(number).unwrap_or(u32::MAX)) }
    }
}

/// Kinds of [`SetupError`], without their details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProgramFault {
    /// A number is out of its range, or the model's upright position is not above the hanging one.
    OutOfRange,
    /// The model's inertia matrix cannot be inverted.
    SingularInertia,
    /// No feedback holds the model upright.
    NotStabilisable,
    /// The program needs a swing-up, which exists only for mechanisms of one and two coordinates.
    NoSwingUp,
}

impl From<SetupError> for ProgramFault {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::OutOfRange { .. } => Self::OutOfRange,
            SetupError::SingularInertia => Self::SingularInertia,
            SetupError::NotStabilisable => Self::NotStabilisable,
            SetupError::NoSwingUp => Self::NoSwingUp,
        }
    }
}

impl From<ModelError> for Refusal {
    fn from(error: ModelError) -> Self {
        Self::Model(error.into())
    }
}

impl From<SetupError> for Refusal {
    fn from(error: SetupError) -> Self {
        Self::Program(error.into())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Frame => write!(f, "a frame was damaged, or is of another version of the link"),
            Self::Version { supported } => {
                write!(f, "its image speaks version {supported} of the link, not {}", super::VERSION)
            }
            Self::Coordinates { supported } => {
                write!(f, "its image has no program for so many coordinates ({supported} at most)")
            }
            Self::NotBegun => write!(f, "no program was begun"),
            Self::NoModel => write!(f, "there is no model in its flash"),
            Self::Model(refusal) => write!(f, "the model in its flash: {refusal}"),
            Self::Program(fault) => write!(f, "the program: {fault}"),
        }
    }
}

impl fmt::Display for ModelRefusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let message = entry_of(self.code).and_then(|entry| entry.message.to_str().ok());
        let [a, b, c] = self.numbers;
        write!(f, "{} (code {}: {a}, {b}, {c})", message.unwrap_or("refused"), self.code)
    }
}

impl fmt::Display for ProgramFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::OutOfRange => "a number is out of range, or the model is no higher upright than hanging",
            Self::SingularInertia => "the model's inertia matrix at the upright position is singular",
            Self::NotStabilisable => "no feedback holds the model upright",
            Self::NoSwingUp => "only a pendulum and a pole on a cart are brought upright",
        })
    }
}
