use crate::error::SetupError;
use core::fmt;
use leastaction_core::adapt::SettingsError;
use leastaction_core::model::{Coded, ModelError, entry_of};
use leastaction_core::plan::PlanError;
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
    /// The processor has no plan in its flash.
    NoPlan,
    /// The plan in the processor's flash is refused.
    Plan(PlanFault),
    /// The processor has no settings of an adapter in its flash.
    NoSettings,
    /// The settings in the processor's flash are refused.
    Settings(SettingsFault),
    /// No numbers follow the machine, so none can be saved.
    NotAdapting,
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

/// Kinds of [`SetupError`] without a plan, without their details.
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
    /// The program decides at every tick, and the image does not.
    NoMpc,
    /// Numbers of models of this family cannot follow.
    NoAdaptation,
}

/// Kinds of reasons against a plan, without their details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PlanFault {
    /// The bytes are not a whole plan of a format that the image reads.
    Unreadable,
    /// The plan was made for another model.
    OtherModel,
    /// The plan has another number of coordinates, or more driven ones than coordinates.
    Shape,
    /// The plan was made for ticks of another length.
    Tick,
    /// The plan takes a coordinate as an angle, but the coordinate's encoder does not.
    Angle,
}

/// Kinds of reasons against settings, without their details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SettingsFault {
    /// The bytes are not a whole file of settings of a format that the image reads, or there are more numbers than its places.
    Unreadable,
    /// The settings were made for another model.
    OtherModel,
    /// The settings have another number of coordinates, or numbers that cannot follow together.
    Shape,
    /// The settings were made for ticks of another length.
    Tick,
    /// A setting is out of range.
    OutOfRange,
}

impl From<SettingsError> for Refusal {
    fn from(error: SettingsError) -> Self {
        Self::Settings(match error {
            SettingsError::OtherModel { .. } => SettingsFault::OtherModel,
            SettingsError::Coordinates { .. } | SettingsError::Unfit(_) => SettingsFault::Shape,
            SettingsError::OtherTick { .. } => SettingsFault::Tick,
            SettingsError::OutOfRange | SettingsError::Number { .. } => SettingsFault::OutOfRange,
            _ => SettingsFault::Unreadable,
        })
    }
}

impl From<PlanError> for PlanFault {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::OtherModel { .. } => Self::OtherModel,
            PlanError::Shape { .. } => Self::Shape,
            _ => Self::Unreadable,
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
        match error {
            SetupError::OutOfRange { .. } => Self::Program(ProgramFault::OutOfRange),
            SetupError::SingularInertia => Self::Program(ProgramFault::SingularInertia),
            SetupError::NotStabilisable => Self::Program(ProgramFault::NotStabilisable),
            SetupError::NoSwingUp => Self::Program(ProgramFault::NoSwingUp),
            SetupError::NoMpc => Self::Program(ProgramFault::NoMpc),
            SetupError::NoPlan => Self::NoPlan,
            SetupError::Plan(error) => Self::Plan(error.into()),
            SetupError::PlanTick { .. } => Self::Plan(PlanFault::Tick),
            SetupError::PlanAngle { .. } => Self::Plan(PlanFault::Angle),
        }
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
            Self::NoPlan => write!(f, "there is no plan in its flash"),
            Self::Plan(fault) => write!(f, "the plan in its flash: {fault}"),
            Self::NoSettings => write!(f, "there are no settings of an adapter in its flash"),
            Self::Settings(fault) => write!(f, "the settings in its flash: {fault}"),
            Self::NotAdapting => write!(f, "no numbers follow the machine"),
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
            Self::NoMpc => "its image has no memory for decisions at every tick",
            Self::NoAdaptation => "only numbers of rigid bodies follow the machine",
        })
    }
}

impl fmt::Display for SettingsFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Unreadable => "not a whole file of settings, of a format that its image does not read, or of too many numbers",
            Self::OtherModel => "made for another model: measure anew",
            Self::Shape => "not of the model's coordinates, or numbers that cannot follow together",
            Self::Tick => "made for ticks of another length than the program's",
            Self::OutOfRange => "a setting is out of range",
        })
    }
}

impl fmt::Display for PlanFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Unreadable => "not a whole plan, or of a format that its image does not read",
            Self::OtherModel => "made for another model: plan anew",
            Self::Shape => "not of the model's coordinates",
            Self::Tick => "made for ticks of another length than the program's",
            Self::Angle => "it takes a coordinate as an angle whose encoder does not",
        })
    }
}
