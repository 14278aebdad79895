//! Model files on the host: written from weights in double precision, read back into them, and as Rust source.

mod rust_source;

pub use rust_source::rust_source;

use crate::architecture::Architecture;
use leastaction_core::model::{
    Document, FORMAT_VERSION, Header, MAGIC, ModelError, TrainedStep, checksum, parse,
};
use leastaction_core::scalar::{Weights, f16};
use thiserror::Error;

/// Bytes of the checksum that closes a file.
const CHECKSUM: usize = 4;
/// What the weights' offset is a multiple of.
const ALIGNMENT: usize = 4;

/// A model that cannot be written.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EncodeError {
    /// A weight is not a number of the precision asked for.
    #[error(
        "weight {index} is {value}, which {} bits cannot hold; {}", precision.bits(), precision.way_out()
    )]
    Weight {
        /// Its position in the block.
        index: usize,
        /// Its value.
        value: f64,
        /// Asked for.
        precision: Precision,
    },
    /// The format does not allow the shape or a number.
    #[error("the model does not fit the file format: {0}")]
    Model(ModelError),
    /// The header cannot be serialised.
    #[error("the header cannot be written: {0}")]
    Header(postcard::Error),
}

/// How a file stores its weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Two bytes a number, `f16`.
    Half,
    /// Four bytes a number, `f32`.
    #[default]
    Single,
}

impl Precision {
    /// Bits of a number.
    pub fn bits(self) -> u8 {
        match self {
            Self::Half => 16,
            Self::Single => 32,
        }
    }

    fn way_out(self) -> &'static str {
        match self {
            Self::Half => "keep single precision",
            Self::Single => "train again, with a smaller step or another seed",
        }
    }

    /// Appends the nearest number, little-endian; `None` where it would be infinite.
    fn append(self, value: f64, block: &mut Vec<u8>) -> Option<()> {
        match self {
            Self::Half => {
                let half = Some(f16::from_f64(value)).filter(|half| half.is_finite())?;
                block.extend(half.to_le_bytes());
            }
            Self::Single => {
                let single = Some(value as f32).filter(|single| single.is_finite())?;
                block.extend(single.to_le_bytes());
            }
        }
        Some(())
    }
}

/// A model as read on the host.
#[derive(Clone, Debug, PartialEq)]
pub struct HostModel {
    /// Its shape.
    pub architecture: Architecture,
    /// The weight block; every number is one of `precision`.
    pub weights: Vec<f64>,
    /// That the file stores its weights in.
    pub precision: Precision,
    /// The step and order it was trained with, where it was.
    pub trained_step: Option<TrainedStep>,
    /// Where it comes from.
    pub provenance: String,
}

impl HostModel {
    /// The weights as shipped.
    pub fn weights_f32(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }
}

/// The bytes of the model file with weights in single precision: see [`encode_in`].
///
/// # Errors
/// As there.
pub fn encode(
    architecture: &Architecture,
    weights: &[f64],
    trained_step: Option<TrainedStep>,
    provenance: &str,
) -> Result<Vec<u8>, EncodeError> {
    encode_in(Precision::Single, architecture, weights, trained_step, provenance)
}

/// The bytes of the model file: weights rounded to a precision, aligned, checksummed, and read back once.
///
/// # Errors
/// [`EncodeError`]: nothing is written that [`decode`] or the chip would refuse.
pub fn encode_in(
    precision: Precision,
    architecture: &Architecture,
    weights: &[f64],
    trained_step: Option<TrainedStep>,
    provenance: &str,
) -> Result<Vec<u8>, EncodeError> {
    let block = rounded(weights, precision)?;
    let assembled =
        architecture.with_header(|family| assemble(Header { family, trained_step, provenance }, &block));
    let bytes = assembled.map_err(EncodeError::Header)?;
    decode(&bytes).map_err(EncodeError::Model)?;
    Ok(bytes)
}

/// Reads a model file.
///
/// # Errors
/// [`ModelError`]: what is wrong with the bytes.
pub fn decode(bytes: &[u8]) -> Result<HostModel, ModelError> {
    let aligned = Aligned::new(bytes);
    let parsed = parse(aligned.bytes())?;
    let Header { family, trained_step, provenance } = parsed.header;
    let weights: Vec<f64> = parsed.weights.iter().map(f64::from).collect();
    let precision = match parsed.weights {
        Weights::Half(_) => Precision::Half,
        Weights::Single(_) => Precision::Single,
    };
    Ok(HostModel {
        precision,
        architecture: Architecture::from_header(&family, &weights)?,
        weights,
        trained_step,
        provenance: provenance.to_owned(),
    })
}

/// The weight block, little-endian.
fn rounded(weights: &[f64], precision: Precision) -> Result<Vec<u8>, EncodeError> {
    let mut block = Vec::with_capacity(weights.len() * size_of::<f32>());
    for (index, value) in weights.iter().enumerate() {
        let cannot = EncodeError::Weight { index, value: *value, precision };
        precision.append(*value, &mut block).ok_or(cannot)?;
    }
    Ok(block)
}

fn assemble(header: Header, weights: &[u8]) -> postcard::Result<Vec<u8>> {
    let unpadded = document(header, &[], weights)?;
    let offset = unpadded.len() - CHECKSUM - weights.len();
    let padding = [0; ALIGNMENT];
    let padding = padding.get(..offset.next_multiple_of(ALIGNMENT) - offset).unwrap_or_default();
    let mut bytes = document(header, padding, weights)?;
    let body = bytes.len() - CHECKSUM;
    let sum = checksum(bytes.get(..body).unwrap_or_default());
    bytes.truncate(body);
    bytes.extend(sum.to_le_bytes());
    Ok(bytes)
}

/// The file but for its checksum.
fn document(header: Header, padding: &[u8], weights: &[u8]) -> postcard::Result<Vec<u8>> {
    let checksum = [0; CHECKSUM];
    postcard::to_stdvec(&Document {
        magic: MAGIC,
        version: FORMAT_VERSION,
        header,
        padding,
        weights,
        checksum,
    })
}

/// A copy of some bytes that begins at a multiple of 4.
struct Aligned {
    words: Vec<u32>,
    length: usize,
}

impl Aligned {
    fn new(bytes: &[u8]) -> Self {
        let mut words = vec![0_u32; bytes.len().div_ceil(size_of::<u32>())];
        let workspace = bytemuck::cast_slice_mut::<u32, u8>(&mut words);
        workspace.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
        Self { words, length: bytes.len() }
    }

    fn bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.words).get(..self.length).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
