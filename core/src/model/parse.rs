//! Reading a file: what all families share, and of the shape only what the caller asks for, so that a firmware of one family
//! holds no code for the others.

use super::{
    CRC_BYTES, FORMAT_VERSION, Family, GraphHeader, Header, MAGIC, MAX_PADDING, ModelError, ModularHeader,
    PREFIX_BYTES, RigidHeader, TrainedStep, checksum,
};
use crate::scalar::{Shipped, Weights, f16};
use serde::Deserialize;

/// The shape of one family, as it stands in a file: [`RigidHeader`], [`ModularHeader`] or [`GraphHeader`].
pub trait ShapeHeader<'a>: Deserialize<'a> {
    /// What the family is in a file, and what it is called.
    const FAMILY: (u32, &'static str);

    /// Numbers in the weight block.
    fn parameters(&self) -> Result<usize, ModelError>;
    /// Checks what the lengths do not say.
    fn validate<W: Shipped>(&self, weights: &[W]) -> Result<(), ModelError>;
}

macro_rules! shape_header {
    ($header:ident, $number:literal, $name:literal) => {
        impl<'a> ShapeHeader<'a> for $header<'a> {
            const FAMILY: (u32, &'static str) = ($number, $name);

            fn parameters(&self) -> Result<usize, ModelError> {
                self.parameters()
            }

            fn validate<W: Shipped>(&self, weights: &[W]) -> Result<(), ModelError> {
                self.validate(weights)
            }
        }
    };
}
shape_header!(RigidHeader, 0, "rigid");
shape_header!(ModularHeader, 1, "modular");
shape_header!(GraphHeader, 2, "graph");

/// A validated file: its header and its weights, in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parsed<'a> {
    /// What the model is.
    pub header: Header<'a>,
    /// The weight block.
    pub weights: Weights<'a>,
}

/// A validated file of one family: its shape and its weights, in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParsedAs<'a, H, W> {
    /// The shape of the model.
    pub shape: H,
    /// The step and order the model was trained for, where it was.
    pub trained_step: Option<TrainedStep>,
    /// Where the model comes from: free text for people.
    pub provenance: &'a str,
    /// The weight block.
    pub weights: &'a [W],
}

impl<'a, H, W: Shipped> ParsedAs<'a, H, W> {
    fn of(self, family: impl Fn(H) -> Family<'a>) -> Parsed<'a> {
        let Self { shape, trained_step, provenance, weights } = self;
        let header = Header { family: family(shape), trained_step, provenance };
        Parsed { header, weights: W::weights(weights) }
    }
}

/// What stands before the shape: magic, format version, family. A postcard document is its parts, one after the other.
type Beginning = ([u8; MAGIC.len()], u8, u32);

/// What stands after the shape; see [`super::Document`].
#[derive(Deserialize)]
struct End<'a> {
    trained_step: Option<TrainedStep>,
    provenance: &'a str,
    padding: &'a [u8],
    weights: &'a [u8],
    #[allow(dead_code, reason = "checked before anything is decoded")]
    checksum: [u8; CRC_BYTES],
}

/// Reads and validates a model file of any family: magic, version, checksum, structure, shape, lengths, alignment, finite
/// numbers.
///
/// `bytes` must be 4-aligned (as `#[repr(align(4))]` or a linker section gives it) and is borrowed, not copied.
pub fn parse(bytes: &[u8]) -> Result<Parsed<'_>, ModelError> {
    let (family, rest) = begin(bytes)?;
    match family {
        0 => either(rest, Family::Rigid),
        1 => either(rest, Family::Modular),
        2 => either(rest, Family::Graph),
        _ => Err(ModelError::Malformed),
    }
}

/// With weights of whichever precision the block has.
fn either<'a, H: ShapeHeader<'a>>(
    bytes: &'a [u8],
    family: impl Fn(H) -> Family<'a>,
) -> Result<Parsed<'a>, ModelError> {
    match finish::<H, f32>(bytes) {
        Err(ModelError::Precision { .. }) => Ok(finish::<H, f16>(bytes)?.of(family)),
        single => Ok(single?.of(family)),
    }
}

/// [`parse`] of a file that must hold the family of `H` with weights of type `W`.
///
/// # Errors
/// [`ModelError::OtherFamily`] where it is a file of another one, of which no more is checked; [`ModelError::Precision`] where
/// its weights are of the other type.
pub fn parse_as<'a, H: ShapeHeader<'a>, W: Shipped>(
    bytes: &'a [u8],
) -> Result<ParsedAs<'a, H, W>, ModelError> {
    let (family, rest) = begin(bytes)?;
    if family == H::FAMILY.0 {
        return finish(rest);
    }
    let names = [RigidHeader::FAMILY, ModularHeader::FAMILY, GraphHeader::FAMILY];
    let found = names.iter().find(|(number, _)| *number == family).ok_or(ModelError::Malformed)?;
    Err(ModelError::OtherFamily { found: found.1 })
}

/// The family, and the bytes from the shape on.
fn begin(bytes: &[u8]) -> Result<(u32, &[u8]), ModelError> {
    check_prefix(bytes)?;
    check_sum(bytes)?;
    let ((_, _, family), rest) = take::<Beginning>(bytes)?;
    Ok((family, rest))
}

fn take<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<(T, &'a [u8]), ModelError> {
    postcard::take_from_bytes(bytes).map_err(|_| ModelError::Malformed)
}

fn finish<'a, H: ShapeHeader<'a>, W: Shipped>(bytes: &'a [u8]) -> Result<ParsedAs<'a, H, W>, ModelError> {
    let (shape, rest) = take::<H>(bytes)?;
    let (end, rest) = take::<End>(rest)?;
    if !rest.is_empty() {
        return Err(ModelError::TrailingBytes { bytes: rest.len() });
    }
    if end.padding.len() > MAX_PADDING || end.padding.iter().any(|byte| *byte != 0) {
        return Err(ModelError::OutOfRange { what: "padding" });
    }
    let weights = numbers(end.weights, shape.parameters()?)?;
    let End { trained_step, provenance, .. } = end;
    trained_step.map_or(Ok(()), TrainedStep::validate)?;
    shape.validate(weights)?;
    Ok(ParsedAs { shape, trained_step, provenance, weights })
}

/// Where the weight block begins in memory: at a multiple of so many bytes, in either precision.
const ALIGNMENT: usize = 4;

/// The weight block in place: as many numbers as are needed, all finite.
fn numbers<W: Shipped>(block: &[u8], needed: usize) -> Result<&[W], ModelError> {
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

fn check_prefix(bytes: &[u8]) -> Result<(), ModelError> {
    let short = ModelError::TooShort { bytes: bytes.len() };
    let magic = bytes.get(..MAGIC.len()).ok_or(short)?;
    if magic != MAGIC {
        return Err(ModelError::Magic);
    }
    match bytes.get(MAGIC.len()) {
        None => Err(short),
        Some(&FORMAT_VERSION) => Ok(()),
        Some(&found) => Err(ModelError::Version { found }),
    }
}

fn check_sum(bytes: &[u8]) -> Result<(), ModelError> {
    let short = ModelError::TooShort { bytes: bytes.len() };
    let (body, stored) = bytes.split_last_chunk::<CRC_BYTES>().ok_or(short)?;
    if body.len() < PREFIX_BYTES {
        return Err(short);
    }
    let (stored, computed) = (u32::from_le_bytes(*stored), checksum(body));
    if stored == computed { Ok(()) } else { Err(ModelError::Checksum { stored, computed }) }
}
