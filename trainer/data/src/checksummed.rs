//! Files of what a program was doing: what they are, the content as postcard, and a checksum over both.

use std::io;
use std::path::Path;

use crc::{CRC_64_XZ, Crc, Digest, Table};
use serde::Serialize;
use serde::de::DeserializeOwned;

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Writes a file that begins with `magic`, in one step.
///
/// # Errors
/// Where the content cannot be put in order as bytes, and as [`crate::atomic::write`].
pub fn write(file: &Path, magic: &[u8], content: &impl Serialize) -> io::Result<()> {
    let mut bytes = postcard::to_extend(content, magic.to_vec()).map_err(io::Error::other)?;
    let sum = CRC.checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    crate::atomic::write(file, &bytes)
}

/// The content; `None` where the bytes begin otherwise, or were damaged.
#[must_use]
pub fn decode<T: DeserializeOwned>(bytes: &[u8], magic: &[u8]) -> Option<T> {
    let (body, sum) = bytes.split_last_chunk::<8>()?;
    let intact = CRC.checksum(body) == u64::from_le_bytes(*sum);
    postcard::from_bytes(body.strip_prefix(magic).filter(|_| intact)?).ok()
}

/// A fingerprint in the making: CRC-64/XZ, which tells one input from another by accident, not by malice.
pub struct Fingerprint(Digest<'static, u64, Table<16>>);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(CRC.digest())
    }
}

impl Fingerprint {
    /// Takes more of the input.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// That of all that was taken.
    #[must_use]
    pub fn finish(self) -> u64 {
        self.0.finalize()
    }
}
