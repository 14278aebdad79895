//! Sections of a file: number, length and bytes of each.

use super::ModelError;

/// Kind of a section; its number precedes the section in the file.
///
/// A reader refuses an unknown section with a number below [`Section::OPTIONAL`], because the section may change the
/// physics. It skips unknown sections from that number on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Section {
    /// The family of the Lagrangian and its shape.
    Energies = 1,
    /// The laws of force in addition to the Lagrangian.
    Forces = 2,
    /// Gain, offset, delay and lag between command and force.
    Actuator = 3,
    /// Step, order and kind of control that the model was trained with.
    Step = 4,
    /// The weight block.
    Weights = 5,
    /// Units of the coordinates.
    Units = 128,
    /// The range of the training data.
    Range = 129,
    /// Provenance of the model.
    Provenance = 130,
}

impl Section {
    /// First number of the optional sections, which a reader may skip if it does not know them.
    pub const OPTIONAL: u8 = 128;
    /// All sections that this version knows, in the order of a file.
    pub const ALL: [Self; 8] = [
        Self::Energies,
        Self::Forces,
        Self::Actuator,
        Self::Step,
        Self::Weights,
        Self::Units,
        Self::Range,
        Self::Provenance,
    ];

    /// Name of the section.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Energies => "energies",
            Self::Forces => "forces",
            Self::Actuator => "actuator",
            Self::Step => "step",
            Self::Weights => "weights",
            Self::Units => "units",
            Self::Range => "range",
            Self::Provenance => "provenance",
        }
    }
}

/// The sections of a file, checked: numbers ascend, lengths fit, and no mandatory section is unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sections<'a>(&'a [u8]);

/// Length of a section's head, bytes: its number, then its length in four bytes, little-endian.
pub(super) const SECTION_HEAD: usize = 5;

impl<'a> Sections<'a> {
    /// No sections.
    pub(super) const NONE: Self = Self(&[]);

    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let (mut rest, mut before) = (bytes, 0);
        while !rest.is_empty() {
            let (number, _, after) = split(rest).ok_or(ModelError::Malformed)?;
            if number <= before {
                return Err(ModelError::Malformed);
            }
            let known = Section::ALL.iter().any(|section| *section as u8 == number);
            if number < Section::OPTIONAL && !known {
                return Err(ModelError::Section { number });
            }
            (rest, before) = (after, number);
        }
        Ok(Self(bytes))
    }

    /// Returns the content of a section, if the file has it.
    // Not generic: a loader asks for every section, and one copy of the code serves all calls.
    #[inline(never)]
    pub fn get(&self, section: Section) -> Option<&'a [u8]> {
        let mut rest = self.0;
        while let Some((number, content, after)) = split(rest) {
            if number == section as u8 {
                return Some(content);
            }
            rest = after;
        }
        None
    }

    /// Returns the content of a section that every file must have.
    pub(super) fn required(&self, section: Section) -> Result<&'a [u8], ModelError> {
        self.get(section).ok_or(ModelError::MissingSection { what: section.name() })
    }
}

/// Splits off the first section: its number, its content, and the rest.
fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let ([number, length @ ..], rest) = bytes.split_first_chunk::<SECTION_HEAD>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (content, rest) = rest.split_at_checked(length)?;
    Some((*number, content, rest))
}

/// Takes a number of four bytes, little-endian, from the front.
pub(super) fn take_f32(bytes: &mut &[u8]) -> Result<f32, ModelError> {
    let (number, rest) = bytes.split_first_chunk().ok_or(ModelError::Malformed)?;
    *bytes = rest;
    Ok(f32::from_le_bytes(*number))
}
