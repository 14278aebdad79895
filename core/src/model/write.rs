//! Writing a model file on the host, into the caller's memory, so writing needs no allocator either.

use super::section::{SECTION_HEAD, Section};
use super::{CRC_BYTES, FORMAT_VERSION, Family, Header, Laws, MAGIC, PREFIX_BYTES, ShapeHeader, checksum};
use core::fmt;
use serde::Serialize;

/// Error of writing a file that does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteError {
    /// The memory is too short for the file.
    TooShort,
    /// A section is longer than its length field can express.
    TooLong,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::TooShort => "the memory is too short for the file",
            Self::TooLong => "a section of the file has more than 4,294,967,295 bytes",
        })
    }
}

impl core::error::Error for WriteError {}

/// Writes a model file to the front of `memory` and returns that part. `weights` is the weight block as little-endian bytes. Nothing is
/// validated; [`parse`](super::parse) does that.
///
/// # Errors
/// See [`WriteError`].
pub fn write<'m>(header: &Header, weights: &[u8], memory: &'m mut [u8]) -> Result<&'m [u8], WriteError> {
    let mut file = File::begin(memory, MAGIC, FORMAT_VERSION)?;
    file.family(&header.family)?;
    if header.laws != Laws::NONE {
        file.section(Section::Forces, |file| file.laws(&header.laws))?;
    }
    file.optional(Section::Actuator, header.actuator.map_or(&[], |actuator| actuator.bytes()))?;
    if let Some(step) = header.trained_step {
        file.section(Section::Step, |file| file.append(&step.to_bytes()))?;
    }
    file.section(Section::Weights, |file| {
        file.pad()?;
        file.append(weights)
    })?;
    file.optional(Section::Units, header.units.as_bytes())?;
    file.optional(Section::Range, header.range.map_or(&[], |range| range.bytes()))?;
    file.optional(Section::Provenance, header.provenance.as_bytes())?;
    file.close()
}

/// Alignment of the weight block in a file, bytes.
const ALIGNMENT: usize = 4;

/// A partly written file.
pub(crate) struct File<'m> {
    memory: &'m mut [u8],
    length: usize,
}

macro_rules! write_any {
    ($($(#[$doc:meta])* $variant:ident($header:ident): $number:literal, $name:literal;)*) => {
        impl File<'_> {
            fn family(&mut self, family: &Family) -> Result<(), WriteError> {
                match family {
                    $(Family::$variant(shape) => self.energies(shape),)*
                }
            }
        }
    };
}

with_families!(write_any);

impl<'m> File<'m> {
    /// Begins a file with its magic letters and its version.
    pub(crate) fn begin(memory: &'m mut [u8], magic: [u8; 4], version: u8) -> Result<Self, WriteError> {
        let mut file = Self { memory, length: 0 };
        file.append(&magic)?;
        file.append(&[version])?;
        Ok(file)
    }

    /// Appends these bytes.
    pub(crate) fn append(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        let end = self.length + bytes.len();
        self.memory.get_mut(self.length..end).ok_or(WriteError::TooShort)?.copy_from_slice(bytes);
        self.length = end;
        Ok(())
    }

    /// Appends a section: its number, its length and the bytes that `content` appends.
    fn section(
        &mut self,
        section: Section,
        content: impl FnOnce(&mut Self) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let start = self.length;
        self.append(&[section as u8, 0, 0, 0, 0])?;
        content(self)?;
        let length = u32::try_from(self.length - start - SECTION_HEAD).map_err(|_| WriteError::TooLong)?;
        let slot = self.memory.get_mut(start + 1..start + SECTION_HEAD).ok_or(WriteError::TooShort)?;
        slot.copy_from_slice(&length.to_le_bytes());
        Ok(())
    }

    /// Appends a section unless its content is empty.
    fn optional(&mut self, section: Section, content: &[u8]) -> Result<(), WriteError> {
        if content.is_empty() { Ok(()) } else { self.section(section, |file| file.append(content)) }
    }

    /// Appends the section with the number of the family and its shape.
    fn energies<'a, H: ShapeHeader<'a> + Serialize>(&mut self, shape: &H) -> Result<(), WriteError> {
        self.section(Section::Energies, |file| file.document(&(H::FAMILY.0, shape)))
    }

    /// Appends the number of every law, followed by the shape of its network if it has one.
    fn laws(&mut self, laws: &Laws) -> Result<(), WriteError> {
        laws.iter().try_for_each(|law| {
            self.append(&[law as u8])?;
            laws.network(law).map_or(Ok(()), |network| self.document(&network))
        })
    }

    /// Appends a postcard document.
    pub(crate) fn document(&mut self, document: &impl Serialize) -> Result<(), WriteError> {
        let rest = self.memory.get_mut(self.length..).ok_or(WriteError::TooShort)?;
        self.length += postcard::to_slice(document, rest).map_err(|_| WriteError::TooShort)?.len();
        Ok(())
    }

    /// Appends the padding: the number of zeros, then the zeros, after which numbers lie at a multiple of 4 bytes from the start of the file.
    pub(crate) fn pad(&mut self) -> Result<(), WriteError> {
        let first = self.length + 1;
        let padding = first.next_multiple_of(ALIGNMENT) - first;
        self.append(&[padding as u8])?;
        (0..padding).try_for_each(|_| self.append(&[0]))
    }

    /// Closes the file with its checksum, and returns it.
    pub(crate) fn close(mut self) -> Result<&'m [u8], WriteError> {
        debug_assert!(self.length >= PREFIX_BYTES, "a file begins with magic and version");
        let sum = checksum(self.memory.get(..self.length).unwrap_or_default());
        self.append(&sum.to_le_bytes())?;
        let Self { memory, length } = self;
        debug_assert!(length >= PREFIX_BYTES + CRC_BYTES, "a file ends with its checksum");
        memory.get(..length).ok_or(WriteError::TooShort)
    }
}
