//! Checkpoints of runs.

use crate::CHECKPOINT;
use crc::{CRC_64_XZ, Crc, Table};
use leastaction_learning::checkpoint::Trained;
use leastaction_models::file::{Precision, encode_in};

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Reads a checkpoint with this content, and exports its model if it has one.
pub fn checkpoint(content: &[u8]) {
    let mut bytes = [CHECKPOINT, content].concat();
    bytes.extend(CRC.checksum(&bytes).to_le_bytes());
    let Some(trained) = Trained::decode(&bytes) else { return };
    if trained.best.is_a_model() {
        drop(encode_in(Precision::Single, &trained.architecture, &trained.best.weights, &trained.facts()));
    }
}
