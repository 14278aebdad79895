//! Model files on the host: written from weights in double precision, read back, and exported as Rust or C source.

mod c_source;
mod rust_constants;
mod rust_source;
mod rust_stepper;
mod version_1;

pub use c_source::{C_HEAD, c_source};
pub use rust_constants::{ConstantsError, rust_constants};
pub use rust_source::{RUST_HEAD, rust_source};

use crate::model::{Facts, Model};
pub use crate::precision::Precision;
use crate::{Actuator, Architecture};
use leastaction_core::model::{
    ActuatorBytes, FORMAT_VERSION, Header, ModelError, Parsed, TrainedStep, TrainingRange, WriteError, parse,
    write,
};
use leastaction_core::scalar::Weights;
use thiserror::Error;

/// Reason why a model cannot be written.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EncodeError {
    /// A weight cannot be represented in the requested precision.
    #[error(
        "weight {index} is {value}, which {} bits cannot hold; {}", precision.bits(), precision.way_out()
    )]
    Weight {
        /// Position of the weight in the block.
        index: usize,
        /// Value of the weight.
        value: f64,
        /// Precision asked for.
        precision: Precision,
    },
    /// The format does not allow the shape or a number.
    #[error("the model does not fit the file format: {0}")]
    Model(ModelError),
    /// The writer failed.
    #[error("the model cannot be written: {0}")]
    Write(WriteError),
}

impl Model {
    /// Returns the bytes of the model file in the current version of the format.
    ///
    /// # Errors
    /// See [`encode_in`]; there is no error for an unchanged model that was read from a file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, EncodeError> {
        encode_in(self.precision, &self.architecture, &self.weights, &self.facts)
    }
}

/// Returns the bytes of the model file with weights in single precision, a trained step and a provenance text: see [`encode_in`].
///
/// # Errors
/// See [`encode_in`].
pub fn encode(
    architecture: &Architecture,
    weights: &[f64],
    trained_step: Option<TrainedStep>,
    provenance: &str,
) -> Result<Vec<u8>, EncodeError> {
    encode_in(Precision::Single, architecture, weights, &Facts::new(trained_step, provenance))
}

/// Returns the bytes of the model file. The weights are rounded to the given precision; the result is aligned,
/// checksummed, and read back once as a check.
///
/// # Errors
/// [`EncodeError`] for anything that [`decode`] or the chip would refuse.
pub fn encode_in(
    precision: Precision,
    architecture: &Architecture,
    weights: &[f64],
    facts: &Facts,
) -> Result<Vec<u8>, EncodeError> {
    let block = rounded(weights, precision)?;
    let range: Vec<u8> = facts.range.iter().flat_map(|range| range.to_bytes()).collect();
    let present = |bytes: &[u8]| !bytes.is_empty();
    let range = Some(range.as_slice()).filter(|range| present(range)).map(TrainingRange::new).transpose();
    let actuator = facts.actuator.to_bytes();
    let actuator = Some(actuator.as_slice()).filter(|actuator| present(actuator));
    let actuator = actuator.map(ActuatorBytes::new).transpose().map_err(EncodeError::Model)?;
    let (range, units) = (range.map_err(EncodeError::Model)?, architecture.units());
    let written = architecture.with_header(|family| {
        let header = Header {
            laws: architecture.laws(),
            actuator,
            trained_step: facts.trained_step,
            units: &units,
            range,
            provenance: &facts.provenance,
            ..Header::new(family)
        };
        assemble(&header, &block)
    });
    let bytes = written.map_err(EncodeError::Write)?;
    decode(&bytes).map_err(EncodeError::Model)?;
    Ok(bytes)
}

/// Reads a model file of the current version or of version 1.
///
/// # Errors
/// [`ModelError`] for invalid bytes.
pub fn decode(bytes: &[u8]) -> Result<Model, ModelError> {
    if version_1::is(bytes) {
        return Ok(Model { version: 1, ..decode_current(&version_1::converted(bytes)?)? });
    }
    decode_current(bytes)
}

fn decode_current(bytes: &[u8]) -> Result<Model, ModelError> {
    let aligned = Aligned::new(bytes);
    let Parsed { header, weights } = parse(aligned.bytes())?;
    let precision = match weights {
        Weights::Half(_) => Precision::Half,
        Weights::Single(_) => Precision::Single,
    };
    let weights: Vec<f64> = weights.iter().map(f64::from).collect();
    let architecture = Architecture::from_header(&header.family, header.laws, &weights)?;
    let actuator = header.actuator.map_or(Ok(Actuator::ideal(architecture.n())), |bytes| {
        Actuator::from_bytes(bytes.bytes(), bytes.n())
    })?;
    let range = header.range.iter().flat_map(|range| range.coordinates());
    let facts = Facts {
        trained_step: header.trained_step,
        range: range.collect::<Result<_, _>>()?,
        actuator,
        provenance: header.provenance.to_owned(),
    };
    Ok(Model { precision, architecture, weights, facts, version: FORMAT_VERSION })
}

/// The weight block in little-endian order.
fn rounded(weights: &[f64], precision: Precision) -> Result<Vec<u8>, EncodeError> {
    let mut block = Vec::with_capacity(weights.len() * size_of::<f32>());
    for (index, value) in weights.iter().enumerate() {
        let cannot = EncodeError::Weight { index, value: *value, precision };
        precision.append(*value, &mut block).ok_or(cannot)?;
    }
    Ok(block)
}

/// Writes the file into a buffer that grows until it is long enough.
fn assemble(header: &Header, weights: &[u8]) -> Result<Vec<u8>, WriteError> {
    let mut memory = vec![0; 4096 + weights.len()];
    loop {
        match write(header, weights, &mut memory).map(<[u8]>::len) {
            Err(WriteError::TooShort) => memory.resize(2 * memory.len(), 0),
            Err(error) => return Err(error),
            Ok(length) => {
                memory.truncate(length);
                return Ok(memory);
            }
        }
    }
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
