//! Files of what a program was doing: what they are, the content as postcard, and a checksum over both.

use crc::{CRC_64_XZ, Crc, Table};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io;
use std::path::Path;

/// CRC-64/XZ, which tells one input from another by accident, not by malice.
pub(crate) static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Writes a file that begins with `magic`, in one step.
pub(crate) fn write(file: &Path, magic: &[u8], content: &impl Serialize) -> io::Result<()> {
    let mut bytes = postcard::to_extend(content, magic.to_vec()).map_err(io::Error::other)?;
    let sum = CRC.checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    crate::atomic::write(file, &bytes)
}

/// The content; `None` where the bytes begin otherwise, or were damaged.
pub(crate) fn decode<T: DeserializeOwned>(bytes: &[u8], magic: &[u8]) -> Option<T> {
    let (body, sum) = bytes.split_last_chunk::<8>()?;
    let intact = CRC.checksum(body) == u64::from_le_bytes(*sum);
    postcard::from_bytes(body.strip_prefix(magic).filter(|_| intact)?).ok()
}
