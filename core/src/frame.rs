//! Frame of all files: magic letters and a version in front, a checksum at the end.

use crate::model::{CRC_BYTES, PREFIX_BYTES, checksum};

/// Fault of a frame.
pub(crate) enum Fault {
    /// Fewer bytes than the smallest file has.
    TooShort {
        /// Bytes given.
        bytes: usize,
    },
    /// Other magic letters.
    Magic,
    /// Another version.
    Version {
        /// The version in the file.
        found: u8,
    },
    /// Another checksum.
    Checksum {
        /// Checksum in the file.
        stored: u32,
        /// Checksum computed from the bytes.
        computed: u32,
    },
}

/// A file whose frame is whole.
pub(crate) struct Framed<'a> {
    /// Bytes between version and checksum.
    pub contents: &'a [u8],
    /// The checksum.
    pub sum: u32,
}

impl<'a> Framed<'a> {
    /// Checks the magic letters, the version and the checksum, in this order.
    pub(crate) fn open(bytes: &'a [u8], magic: [u8; 4], version: u8) -> Result<Self, Fault> {
        let short = Fault::TooShort { bytes: bytes.len() };
        let Some((found, rest)) = bytes.split_first_chunk() else { return Err(short) };
        if *found != magic {
            return Err(Fault::Magic);
        }
        match rest.first() {
            None => return Err(short),
            Some(found) if *found != version => return Err(Fault::Version { found: *found }),
            Some(_) => {}
        }
        let Some((body, stored)) = bytes.split_last_chunk::<CRC_BYTES>() else { return Err(short) };
        let Some(contents) = body.get(PREFIX_BYTES..) else { return Err(short) };
        let (stored, computed) = (u32::from_le_bytes(*stored), checksum(body));
        if stored == computed {
            Ok(Self { contents, sum: stored })
        } else {
            Err(Fault::Checksum { stored, computed })
        }
    }
}

/// Makes the faults of a frame reasons of an error that has variants of their names.
macro_rules! from_fault {
    ($error:ty) => {
        impl From<crate::frame::Fault> for $error {
            fn from(fault: crate::frame::Fault) -> Self {
                use crate::frame::Fault;
                match fault {
                    Fault::TooShort { bytes } => Self::TooShort { bytes },
                    Fault::Magic => Self::Magic,
                    Fault::Version { found } => Self::Version { found },
                    Fault::Checksum { stored, computed } => Self::Checksum { stored, computed },
                }
            }
        }
    };
}
pub(crate) use from_fault;
