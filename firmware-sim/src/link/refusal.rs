use crate::error::SetupError;
use core::fmt;
use leastaction_core::model::ModelError;
use serde::{Deserialize, Serialize};

/// Why a processor refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The frame was damaged, or is no request.
    Frame,
    /// The messages are of another version.
    Version {
        /// The one that it speaks.
        supported: u8,
    },
    /// It has no program for so many coordinates.
    Coordinates {
        /// At most.
        supported: u8,
    },
    /// A tick before a program was begun.
    NotBegun,
    /// There is no model in its flash.
    NoModel,
    /// The model in its flash is refused.
    Model(ModelFault),
    /// The program is refused.
    Program(ProgramFault),
}

/// The kinds of [`ModelError`], without their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ModelFault {
    /// Fewer bytes than the smallest file has.
    TooShort,
    /// It does not begin with the magic letters.
    Magic,
    /// A format version that the image does not read.
    Version,
    /// The file was damaged.
    Checksum,
    /// The header is not a document of the format.
    Malformed,
    /// Bytes after the end of the document.
    TrailingBytes,
    /// The weights do not begin at a multiple of 4.
    Unaligned,
    /// The processor is big-endian.
    BigEndian,
    /// Another number of weights than the shape needs.
    WeightCount,
    /// A weight is infinite or not a number.
    NotFinite,
    /// A number of the header is out of range.
    OutOfRange,
    /// A tree of elements is none.
    Tree,
    /// A graph is none.
    Graph,
    /// Names are missing, empty or the same.
    Names,
    /// No tree of the name asked for.
    NoSuchTree,
    /// No graph of the name asked for.
    NoSuchGraph,
    /// A model of another family.
    OtherFamily,
    /// Another shape than the image was compiled for.
    Shape,
    /// None that this version knows.
    Other,
    /// Weights of another precision than the image was compiled for.
    Precision,
}

impl ModelFault {
    /// All of them; the place of each is its code.
    pub const ALL: [Self; 20] = [
        Self::TooShort,
        Self::Magic,
        Self::Version,
        Self::Checksum,
        Self::Malformed,
        Self::TrailingBytes,
        Self::Unaligned,
        Self::BigEndian,
        Self::WeightCount,
        Self::NotFinite,
        Self::OutOfRange,
        Self::Tree,
        Self::Graph,
        Self::Names,
        Self::NoSuchTree,
        Self::NoSuchGraph,
        Self::OtherFamily,
        Self::Shape,
        Self::Other,
        Self::Precision,
    ];

    /// In a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::TooShort => "too_short",
            Self::Magic => "magic",
            Self::Version => "version",
            Self::Checksum => "checksum",
            Self::Malformed => "malformed",
            Self::TrailingBytes => "trailing_bytes",
            Self::Unaligned => "unaligned",
            Self::BigEndian => "big_endian",
            Self::WeightCount => "weight_count",
            Self::NotFinite => "not_finite",
            Self::OutOfRange => "out_of_range",
            Self::Tree => "tree",
            Self::Graph => "graph",
            Self::Names => "names",
            Self::NoSuchTree => "no_such_tree",
            Self::NoSuchGraph => "no_such_graph",
            Self::OtherFamily => "other_family",
            Self::Shape => "shape",
            Self::Other => "other",
            Self::Precision => "precision",
        }
    }
}

impl From<ModelError> for ModelFault {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::TooShort { .. } => Self::TooShort,
            ModelError::Magic => Self::Magic,
            ModelError::Version { .. } => Self::Version,
            ModelError::Checksum { .. } => Self::Checksum,
            ModelError::Malformed => Self::Malformed,
            ModelError::TrailingBytes { .. } => Self::TrailingBytes,
            ModelError::Unaligned { .. } => Self::Unaligned,
            ModelError::BigEndian => Self::BigEndian,
            ModelError::WeightCount { .. } => Self::WeightCount,
            ModelError::NotFinite { .. } => Self::NotFinite,
            ModelError::OutOfRange { .. } => Self::OutOfRange,
            ModelError::Tree(_) => Self::Tree,
            ModelError::Graph(_) => Self::Graph,
            ModelError::Names { .. } => Self::Names,
            ModelError::NoSuchTree { .. } => Self::NoSuchTree,
            ModelError::NoSuchGraph { .. } => Self::NoSuchGraph,
            ModelError::OtherFamily { .. } => Self::OtherFamily,
            ModelError::Shape { .. } => Self::Shape,
            ModelError::Precision { .. } => Self::Precision,
            _ => Self::Other,
        }
    }
}

/// The kinds of [`SetupError`], without their words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProgramFault {
    /// A number is out of its range, or the model's upright position is not above the hanging one.
    OutOfRange,
    /// The model's inertia matrix cannot be inverted.
    SingularInertia,
    /// No feedback holds the model upright.
    NotStabilisable,
}

impl From<SetupError> for ProgramFault {
    fn from(error: SetupError) -> Self {
        match error {
            SetupError::OutOfRange { .. } => Self::OutOfRange,
            SetupError::SingularInertia => Self::SingularInertia,
            SetupError::NotStabilisable => Self::NotStabilisable,
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
                write!(f, "its image runs models of at most {supported} coordinates")
            }
            Self::NotBegun => write!(f, "no program was begun"),
            Self::NoModel => write!(f, "there is no model in its flash"),
            Self::Model(fault) => write!(f, "the model in its flash: {fault}"),
            Self::Program(fault) => write!(f, "the program: {fault}"),
        }
    }
}

impl fmt::Display for ModelFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let words = match self {
            Self::TooShort => "not a whole file",
            Self::Magic => "not a leastaction model file",
            Self::Version => "a format version that it does not read",
            Self::Checksum => "damaged",
            Self::Malformed => "the header is malformed",
            Self::TrailingBytes => "bytes after its end",
            Self::Unaligned => "not at a multiple of 4",
            Self::BigEndian => "little-endian weights cannot be read in place there",
            Self::WeightCount => "another number of weights than its shape needs",
            Self::NotFinite => "a weight is infinite or not a number",
            Self::OutOfRange => "a number of the header is out of range",
            Self::Tree => "a tree of elements is none",
            Self::Graph => "a graph is none",
            Self::Names => "names are missing, empty or the same",
            Self::NoSuchTree => "no tree of that name",
            Self::NoSuchGraph => "no graph of that name",
            Self::OtherFamily => "a model of another family than rigid",
            Self::Shape => "another shape than its image was compiled for",
            Self::Other => "of an unknown kind",
            Self::Precision => "weights of another precision than its image was compiled for",
        };
        write!(f, "{words} (code {})", *self as u8)
    }
}

impl fmt::Display for ProgramFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::OutOfRange => "a number is out of range, or the model is no higher upright than hanging",
            Self::SingularInertia => "the model's inertia matrix at the upright position is singular",
            Self::NotStabilisable => "no feedback holds the model upright",
        })
    }
}
