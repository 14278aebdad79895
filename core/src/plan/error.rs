use crate::frame::from_fault;
use core::fmt;

/// Reason for refusing a plan.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanError {
    /// Fewer bytes than the smallest file has.
    TooShort {
        /// Bytes given.
        bytes: usize,
    },
    /// The file does not begin with the magic letters.
    Magic,
    /// A format version that this build does not read.
    Version {
        /// The version in the file.
        found: u8,
    },
    /// The checksum does not match: the file was damaged.
    Checksum {
        /// Checksum in the file.
        stored: u32,
        /// Checksum computed from the bytes.
        computed: u32,
    },
    /// The header is not a postcard document of this format.
    Malformed,
    /// The numbers do not begin at a multiple of 4: align the array that holds the file.
    Unaligned {
        /// Address of the numbers modulo 4.
        offset: u8,
    },
    /// Numbers are little-endian and borrowed in place, which this processor cannot read.
    BigEndian,
    /// The file does not have the number of numbers that its header needs.
    NumberCount {
        /// Bytes of numbers in the file.
        found: usize,
        /// Bytes that the header needs.
        needed: usize,
    },
    /// A number is infinite or not a number.
    NotFinite {
        /// Position among the numbers: limits, then records.
        index: usize,
    },
    /// A value of the header is not one that the format allows.
    OutOfRange {
        /// Name of the value.
        what: &'static str,
    },
    /// A driven coordinate is not among the coordinates, or not above the driven coordinate before it.
    Driven {
        /// The coordinate, from 0.
        coordinate: u8,
    },
    /// The largest command of a driven coordinate is below its least.
    Limits {
        /// The coordinate, from 0.
        coordinate: u8,
        /// Least command.
        least: f32,
        /// Largest command.
        most: f32,
    },
    /// The plan's size is not the one the program was compiled for.
    Shape {
        /// Quantity: coordinates or driven coordinates.
        what: &'static str,
        /// Size in the file.
        found: usize,
        /// Compiled size.
        compiled: usize,
    },
    /// The plan was made for another model.
    OtherModel {
        /// Fingerprint of the model that the plan was made for.
        planned: u32,
        /// Fingerprint of the model given.
        given: u32,
    },
}

from_fault!(PlanError);

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooShort { bytes } => write!(f, "only {bytes} bytes: not a whole plan"),
            Self::Magic => write!(f, "not a plan of leastaction (it does not begin with LAPN)"),
            Self::Version { found } => {
                write!(
                    f,
                    "format version {found} is not {}, which this build reads: plan anew with this build",
                    super::FORMAT_VERSION
                )
            }
            Self::Checksum { stored, computed } => {
                write!(f, "damaged: checksum {computed:08x}, but the file says {stored:08x}")
            }
            Self::Malformed => write!(f, "the header is malformed"),
            Self::Unaligned { offset } => {
                write!(
                    f,
                    "the numbers lie {offset} bytes off a multiple of 4: align the array that holds the plan"
                )
            }
            Self::BigEndian => write!(f, "numbers are little-endian and cannot be read in place here"),
            Self::NumberCount { found, needed } => {
                write!(f, "{found} bytes of limits and records where the header needs {needed}")
            }
            Self::NotFinite { index } => {
                write!(f, "number {index} of the limits and records is infinite or not a number")
            }
            Self::OutOfRange { what } => write!(f, "{what} is out of range"),
            Self::Driven { coordinate } => {
                write!(
                    f,
                    "driven coordinate {coordinate} is not above the one before and below the number of coordinates"
                )
            }
            Self::Limits { coordinate, least, most } => {
                write!(
                    f,
                    "the largest command of coordinate {coordinate} is {most}, below its least, {least}"
                )
            }
            Self::Shape { what, found, compiled } => {
                write!(f, "{found} {what}, but this program was compiled for {compiled}")
            }
            Self::OtherModel { planned, given } => {
                write!(
                    f,
                    "made for the model with fingerprint {planned:08x}, but the model has {given:08x}: plan anew"
                )
            }
        }
    }
}

impl core::error::Error for PlanError {}

/// Reason for the lack of a command.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommandError {
    /// A measured position or velocity is infinite or not a number.
    NotFinite {
        /// `q` or `v`.
        quantity: char,
        /// The coordinate, from 0.
        coordinate: usize,
        /// The measured value.
        value: f32,
    },
    /// The state is so far from the plan, or its gains are so large, that single precision does not hold the command.
    Overflow {
        /// The driven coordinate.
        coordinate: u8,
    },
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NotFinite { quantity, coordinate, value } => {
                write!(
                    f,
                    "the measured {quantity} of coordinate {coordinate} is {value}: a command needs a number"
                )
            }
            Self::Overflow { coordinate } => {
                write!(
                    f,
                    "the command of coordinate {coordinate} is not a number: the state is too far from the plan"
                )
            }
        }
    }
}

impl core::error::Error for CommandError {}
