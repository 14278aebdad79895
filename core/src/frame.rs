//! Frame of all files: magic letters and a version in front, a checksum at the end.

use crate::model::{CRC_BYTES, PREFIX_BYTES, checksum};
use core::fmt;

/// Fault of a file's frame.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFault {
    /// Fewer bytes than the smallest file has.
    TooShort {
        /// Bytes given.
        bytes: usize,
    },
    /// The file does not begin with the magic letters.
    Magic {
        /// The letters of such files.
        expected: [u8; 4],
    },
    /// A format version that this build does not read.
    Version {
        /// The version in the file.
        found: u8,
        /// The version that is read.
        supported: u8,
    },
    /// The checksum does not match: the file was damaged.
    Checksum {
        /// Checksum in the file.
        stored: u32,
        /// Checksum computed from the bytes.
        computed: u32,
    },
}

impl fmt::Display for FrameFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooShort { bytes } => write!(f, "only {bytes} bytes: not a whole file"),
            Self::Magic { expected } => {
                let letters = str::from_utf8(expected).unwrap_or("its letters");
                write!(f, "another kind of file (it does not begin with {letters})")
            }
            Self::Version { found, supported } => {
                write!(f, "format version {found} is not {supported}, which this build reads")
            }
            Self::Checksum { stored, computed } => {
                write!(f, "damaged: checksum {computed:08x}, but the file says {stored:08x}")
            }
        }
    }
}

impl core::error::Error for FrameFault {}

/// A file whose frame is whole.
pub(crate) struct Framed<'a> {
    /// Bytes between version and checksum.
    pub contents: &'a [u8],
    /// The checksum.
    pub sum: u32,
}

impl<'a> Framed<'a> {
    /// Checks the magic letters, the version and the checksum, in this order.
    pub(crate) fn open(bytes: &'a [u8], magic: [u8; 4], version: u8) -> Result<Self, FrameFault> {
        let short = FrameFault::TooShort { bytes: bytes.len() };
        let Some((found, rest)) = bytes.split_first_chunk() else { return Err(short) };
        if *found != magic {
            return Err(FrameFault::Magic { expected: magic });
        }
        match rest.first() {
            None => return Err(short),
            Some(found) if *found != version => {
                return Err(FrameFault::Version { found: *found, supported: version });
            }
            Some(_) => {}
        }
        let Some((body, stored)) = bytes.split_last_chunk::<CRC_BYTES>() else { return Err(short) };
        let Some(contents) = body.get(PREFIX_BYTES..) else { return Err(short) };
        let (stored, computed) = (u32::from_le_bytes(*stored), checksum(body));
        if stored == computed {
            Ok(Self { contents, sum: stored })
        } else {
            Err(FrameFault::Checksum { stored, computed })
        }
    }
}

/// Makes the faults of a frame reasons of an error that has variants of their names.
macro_rules! from_fault {
    ($error:ty) => {
        impl From<crate::frame::FrameFault> for $error {
            fn from(fault: crate::frame::FrameFault) -> Self {
                use crate::frame::FrameFault;
                match fault {
                    FrameFault::TooShort { bytes } => Self::TooShort { bytes },
                    FrameFault::Magic { .. } => Self::Magic,
                    FrameFault::Version { found, .. } => Self::Version { found },
                    FrameFault::Checksum { stored, computed } => Self::Checksum { stored, computed },
                }
            }
        }
    };
}
pub(crate) use from_fault;
