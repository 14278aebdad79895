//! The model file: one postcard document with the weights as an aligned block that is borrowed where it lies.
//!
//! `core/FORMAT.md` has the byte table. Loading validates everything once; after that, evaluation cannot fail except
//! numerically.

mod document;
mod error;
mod graph;
mod modular;
mod rigid;

pub use crate::energy::MAX_HIDDEN;
pub use document::{
    Discretisation, Document, FORMAT_VERSION, Family, Header, MAGIC, MAX_TREES, ModularHeader, RigidHeader,
    TreeHeader,
};
pub use error::ModelError;
pub use graph::{GraphHeader, GraphLayout, GraphModel, MAX_GRAPHS, ORIGIN, Rod};
pub use modular::ModularModel;
pub use rigid::RigidModel;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// CRC-32/ISO-HDLC without a table: 0 bytes of RAM, no table in flash.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
const CRC_BYTES: usize = 4;
/// Bytes that bring the weights to a multiple of 4.
const MAX_PADDING: usize = 3;
const PREFIX_BYTES: usize = MAGIC.len() + 1;

/// The checksum that closes a file whose other bytes are `body`.
pub fn checksum(body: &[u8]) -> u32 {
    CRC.checksum(body)
}

/// A validated file: its header and its weights, in place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parsed<'a> {
    /// What the model is.
    pub header: Header<'a>,
    /// The weight block.
    pub weights: &'a [f32],
}

/// Reads and validates a model file: magic, version, checksum, structure, shape, lengths, alignment, finite numbers.
///
/// `bytes` must be 4-aligned (as `#[repr(align(4))]` or a linker section gives it) and is borrowed, not copied.
pub fn parse(bytes: &[u8]) -> Result<Parsed<'_>, ModelError> {
    check_prefix(bytes)?;
    check_sum(bytes)?;
    let (document, rest) = postcard::take_from_bytes::<Document>(bytes).map_err(|_| ModelError::Malformed)?;
    if !rest.is_empty() {
        return Err(ModelError::TrailingBytes { bytes: rest.len() });
    }
    if document.padding.len() > MAX_PADDING || document.padding.iter().any(|byte| *byte != 0) {
        return Err(ModelError::OutOfRange { what: "padding" });
    }
    let needed = document.header.family.parameters()?;
    let weights =
        bytemuck::try_cast_slice::<u8, f32>(document.weights).map_err(|_| unaligned(document.weights))?;
    if cfg!(target_endian = "big") {
        return Err(ModelError::BigEndian);
    }
    if weights.len() != needed {
        return Err(ModelError::WeightCount { found: weights.len(), needed });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
        return Err(ModelError::NotFinite { index });
    }
    document.header.validate(weights)?;
    Ok(Parsed { header: document.header, weights })
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

/// Why a block cannot be read as f32 in place.
fn unaligned(block: &[u8]) -> ModelError {
    if block.len().is_multiple_of(4) {
        ModelError::Unaligned { offset: (block.as_ptr() as usize % 4) as u8 }
    } else {
        ModelError::Malformed
    }
}
