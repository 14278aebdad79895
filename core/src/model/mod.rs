//! The model file: one postcard document with the weights as an aligned block that is borrowed where it lies.
//!
//! `core/FORMAT.md` has the byte table. Loading validates everything once; after that, evaluation cannot fail except
//! numerically.

mod document;
mod error;
mod graph;
mod modular;
mod parse;
mod rigid;

pub use crate::energy::MAX_HIDDEN;
pub use document::{
    Document, FORMAT_VERSION, Family, Header, MAGIC, MAX_TREES, ModularHeader, RigidHeader, TrainedStep,
    TreeHeader,
};
pub use error::ModelError;
pub use graph::{GraphHeader, GraphLayout, GraphModel, MAX_GRAPHS, ORIGIN, Rod};
pub use modular::ModularModel;
pub use parse::{Parsed, ParsedAs, ShapeHeader, parse, parse_as};
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
