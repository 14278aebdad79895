//! Writing a plan on the host, into the caller's memory.

use super::{FORMAT_VERSION, MAGIC, PlanHeader};
use crate::model::{File, WriteError};

/// Writes a plan to the front of `memory` and returns that part. `records` has the numbers of all records: positions, velocities, commands,
/// gains row by row, of every record in order. Nothing is validated; [`PlanFile::parse`](super::PlanFile::parse) does that.
///
/// # Errors
/// [`WriteError::TooShort`] if the memory is too short.
pub fn write<'m>(header: &PlanHeader, records: &[f32], memory: &'m mut [u8]) -> Result<&'m [u8], WriteError> {
    let mut file = File::begin(memory, MAGIC, FORMAT_VERSION)?;
    file.document(header)?;
    file.pad()?;
    let numbers = header.limits.as_flattened().iter().chain(records);
    numbers.copied().try_for_each(|number| file.append(&number.to_le_bytes()))?;
    file.close()
}
