//! Reading a model file: parts that all families share, and the shape of the one family that the caller asks for, so a firmware of one
//! family holds no code for the others.

use super::header::sum;
use super::{
    ActuatorBytes, CRC_BYTES, FORMAT_VERSION, Family, Header, Law, Laws, MAGIC, MAX_PADDING, ModelError,
    Section, Sections, TrainedStep, TrainingRange,
};
use crate::expected::expected;
use crate::frame::Framed;
use crate::scalar::{FileWeightFormat, Weights, f16};
use serde::Deserialize;

/// The shape of one family in its file form.
pub trait ShapeHeader<'a>: Deserialize<'a> {
    /// Number of the family in a file, and its name.
    const FAMILY: (u32, &'static str);

    /// Length of the energies' part of the weight block, in numbers.
    fn parameters(&self) -> Result<usize, ModelError>;
    /// Number of groups of coordinates; every law of friction has separate parameters for each group.
    fn groups(&self) -> usize;
    /// Number of coordinates that every mechanism of the file has and laws may name; 0 if laws may name none.
    fn coordinates(&self) -> usize;
    /// Checks everything that the lengths do not imply.
    fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError>;
}

/// A validated file: its header, and its weights in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parsed<'a> {
    /// Description of the model.
    pub header: Header<'a>,
    /// The weight block.
    pub weights: Weights<'a>,
}

/// A validated file of one family: its shape, and its weights in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParsedAs<'a, H, W> {
    /// The shape of the model.
    pub shape: H,
    /// The laws of force.
    pub laws: Laws<'a>,
    /// The step that the model was trained with, if any.
    pub trained_step: Option<TrainedStep>,
    /// The weight block: numbers of the energies, then of the laws.
    pub weights: &'a [W],
    /// All sections.
    pub sections: Sections<'a>,
}

impl<'a, H: ShapeHeader<'a>, W: FileWeightFormat> ParsedAs<'a, H, W> {
    /// Reads the sections that a program may leave unread, and completes the header with them.
    fn whole(self, family: impl Fn(H) -> Family<'a>) -> Result<Parsed<'a>, ModelError> {
        let Self { shape, laws, trained_step, weights, sections } = self;
        let header = Header {
            family: family(shape),
            laws,
            actuator: sections.actuator()?,
            trained_step,
            units: text(&sections, Section::Units)?,
            range: sections.range()?,
            provenance: text(&sections, Section::Provenance)?,
        };
        Ok(Parsed { header, weights: W::weights(weights) })
    }
}

fn text<'a>(sections: &Sections<'a>, section: Section) -> Result<&'a str, ModelError> {
    core::str::from_utf8(sections.get(section).unwrap_or(&[])).map_err(|_| ModelError::Malformed)
}

impl<'a> Sections<'a> {
    /// Actuator between command and force, if the file has one.
    ///
    /// # Errors
    /// See [`ActuatorBytes::new`].
    pub fn actuator(&self) -> Result<Option<ActuatorBytes<'a>>, ModelError> {
        self.get(Section::Actuator).map(ActuatorBytes::new).transpose()
    }

    /// Range of the training data, if the file has one.
    ///
    /// # Errors
    /// See [`TrainingRange::new`].
    pub fn range(&self) -> Result<Option<TrainingRange<'a>>, ModelError> {
        self.get(Section::Range).map(TrainingRange::new).transpose()
    }
}

/// The parts of a file that all families share.
struct Begun<'a> {
    sections: Sections<'a>,
    family: u32,
    /// Bytes of the family's shape.
    shape: &'a [u8],
}

/// Reads and validates a model file of any family: magic, version, checksum, sections, shape, lengths, alignment, finite
/// numbers, and everything that a program may leave unread.
///
/// `bytes` must be 4-aligned (as `#[repr(align(4))]` or a linker section gives it) and is borrowed, not copied.
pub fn parse(bytes: &[u8]) -> Result<Parsed<'_>, ModelError> {
    any(begin(bytes)?)
}

macro_rules! any {
    ($($(#[$doc:meta])* $variant:ident($header:ident): $number:literal, $name:literal;)*) => {
        /// Finishes reading a file of any family.
        fn any(begun: Begun) -> Result<Parsed, ModelError> {
            match begun.family {
                $($number => either(begun, Family::$variant),)*
                _ => Err(ModelError::Malformed),
            }
        }
    };
}

with_families!(any);

/// Finishes reading a file with weights of either precision.
fn either<'a, H: ShapeHeader<'a>>(
    begun: Begun<'a>,
    family: impl Fn(H) -> Family<'a>,
) -> Result<Parsed<'a>, ModelError> {
    match finish::<H, f32>(&begun, |_| true) {
        Err(ModelError::Precision { .. }) => finish::<H, f16>(&begun, |_| true)?.whole(family),
        single => single?.whole(family),
    }
}

/// [`parse`] of a file that must hold the family of `H` with weights of type `W`; optional sections are left unread.
///
/// # Errors
/// [`ModelError::OtherFamily`] for a file of another family, which is checked no further; [`ModelError::Precision`] if its weights are of
/// the other type.
pub fn parse_as<'a, H: ShapeHeader<'a>, W: FileWeightFormat>(
    bytes: &'a [u8],
) -> Result<ParsedAs<'a, H, W>, ModelError> {
    parse_knowing(bytes, |_| true)
}

/// [`parse_as`] for a program that knows only some laws and refuses a file with others.
#[inline(always)]
pub(super) fn parse_knowing<'a, H: ShapeHeader<'a>, W: FileWeightFormat>(
    bytes: &'a [u8],
    knows: impl Fn(Law) -> bool,
) -> Result<ParsedAs<'a, H, W>, ModelError> {
    let begun = begin(bytes)?;
    if begun.family == H::FAMILY.0 {
        return finish(&begun, knows);
    }
    let found =
        Family::ALL.iter().find(|(number, _)| *number == begun.family).ok_or(ModelError::Malformed)?;
    Err(ModelError::OtherFamily { found: found.1 })
}

/// Fingerprint of a model, by which a [plan](crate::plan) knows it: the checksum at the end of the model's file, after a check of the whole
/// file against it.
///
/// # Errors
/// [`ModelError`] if the bytes are no undamaged model file.
pub fn fingerprint(bytes: &[u8]) -> Result<u32, ModelError> {
    Ok(Framed::open(bytes, MAGIC, FORMAT_VERSION)?.sum)
}

/// Fingerprint of a model whose file was read without an error: the checksum is not computed again. `None` if the file is too short for one.
pub fn stored_fingerprint(bytes: &[u8]) -> Option<u32> {
    bytes.last_chunk::<CRC_BYTES>().map(|stored| u32::from_le_bytes(*stored))
}

/// Reads everything before the shape.
fn begin(bytes: &[u8]) -> Result<Begun<'_>, ModelError> {
    let sections = Sections::new(Framed::open(bytes, MAGIC, FORMAT_VERSION)?.contents)?;
    let (family, shape) = take(sections.required(Section::Energies)?)?;
    Ok(Begun { sections, family, shape })
}

fn take<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<(T, &'a [u8]), ModelError> {
    postcard::take_from_bytes(bytes).map_err(|_| ModelError::Malformed)
}

fn finish<'a, H: ShapeHeader<'a>, W: FileWeightFormat>(
    begun: &Begun<'a>,
    knows: impl Fn(Law) -> bool,
) -> Result<ParsedAs<'a, H, W>, ModelError> {
    let Begun { sections, shape, .. } = *begun;
    let (shape, rest) = take::<H>(shape)?;
    if !rest.is_empty() {
        return Err(ModelError::TrailingBytes { bytes: rest.len() });
    }
    let laws = Laws::known(sections.get(Section::Forces).unwrap_or(&[]), &knows)?;
    let (energies, groups) = (shape.parameters()?, shape.groups());
    laws.validate_networks(|| shape.coordinates(), &knows)?;
    let needed = sum(energies, laws.parameters_knowing(groups, &knows))?;
    let weights: &[W] = numbers(unpadded(sections.required(Section::Weights)?)?, needed)?;
    let (of_energies, of_laws) = expected(weights.split_at_checked(energies), (weights, &[]));
    shape.validate(of_energies)?;
    laws.validate(groups, of_laws, knows)?;
    let trained_step = sections.get(Section::Step).map(TrainedStep::from_bytes).transpose()?;
    Ok(ParsedAs { shape, laws, trained_step, weights, sections })
}

/// Strips the padding off the weight section: one byte with the number of zeros, then the zeros.
pub(crate) fn unpadded(section: &[u8]) -> Result<&[u8], ModelError> {
    let padding = || section.split_first().and_then(|(n, rest)| rest.split_at_checked(usize::from(*n)));
    let (zeros, numbers) = padding().ok_or(ModelError::Malformed)?;
    let valid = zeros.len() <= MAX_PADDING && zeros.iter().all(|byte| *byte == 0);
    if valid { Ok(numbers) } else { Err(ModelError::OutOfRange { what: "padding" }) }
}

/// Alignment of the weight block in memory in either precision, bytes.
const ALIGNMENT: usize = 4;

/// The weight block in place: exactly `needed` numbers, all finite.
fn numbers<W: FileWeightFormat>(block: &[u8], needed: usize) -> Result<&[W], ModelError> {
    let offset = (block.as_ptr() as usize % ALIGNMENT) as u8;
    if offset != 0 {
        return Err(ModelError::Unaligned { offset });
    }
    if cfg!(target_endian = "big") {
        return Err(ModelError::BigEndian);
    }
    if block.len() == needed.saturating_mul(usize::from(W::OTHER_BITS / 8)) {
        return Err(ModelError::Precision { found: W::OTHER_BITS, compiled: W::BITS });
    }
    let weights = bytemuck::try_cast_slice::<u8, W>(block).map_err(|_| ModelError::Malformed)?;
    if weights.len() != needed {
        return Err(ModelError::WeightCount { found: weights.len(), needed });
    }
    match weights.iter().position(|w| !w.wide().is_finite()) {
        Some(index) => Err(ModelError::NotFinite { index }),
        None => Ok(weights),
    }
}
