//! Files with a signature, content as postcard, and a checksum over both; they hold the state of a program.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crc::{CRC_64_XZ, Crc, Digest, Table};
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Writes a file that begins with `magic`, atomically.
///
/// # Errors
/// An error if the content cannot be serialised; otherwise see [`crate::atomic::write`].
pub fn write(file: &Path, magic: &[u8], content: &impl Serialize) -> io::Result<()> {
    let mut bytes = postcard::to_extend(content, magic.to_vec()).map_err(io::Error::other)?;
    let sum = CRC.checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    crate::atomic::write(file, &bytes)
}

/// The reason why a file cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The operating system reported an error.
    #[error("{}: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The file has another signature or is damaged.
    #[error("{}: not an undamaged file of this version of leastaction", file.display())]
    Damaged {
        /// The file.
        file: PathBuf,
    },
}

impl ReadError {
    /// Whether there is no file of that name.
    #[must_use]
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::File { error, .. } if error.kind() == io::ErrorKind::NotFound)
    }
}

/// Reads the content of a file that begins with `magic`.
///
/// # Errors
/// [`ReadError`].
pub fn read<T: DeserializeOwned>(file: &Path, magic: &[u8]) -> Result<T, ReadError> {
    let bytes = fs::read(file).map_err(|error| ReadError::File { file: file.to_owned(), error })?;
    decode(&bytes, magic).ok_or_else(|| ReadError::Damaged { file: file.to_owned() })
}

/// Decodes the bytes of such a file; `None` if they begin differently or are damaged.
pub fn decode<T: DeserializeOwned>(bytes: &[u8], magic: &[u8]) -> Option<T> {
    let (body, sum) = bytes.split_last_chunk::<8>()?;
    let intact = CRC.checksum(body) == u64::from_le_bytes(*sum);
    postcard::from_bytes(body.strip_prefix(magic).filter(|_| intact)?).ok()
}

/// A fingerprint under construction: a CRC-64/XZ, which guards against accidental changes, not against malicious ones.
pub struct Fingerprint(Digest<'static, u64, Table<16>>);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(CRC.digest())
    }
}

impl Fingerprint {
    /// Adds more of the input.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// The checksum of all bytes added so far.
    #[must_use]
    pub fn finish(self) -> u64 {
        self.0.finalize()
    }
}
