//! How loaders answer damaged model files, on any target: every changed bit and every truncation, counted by kind of error.

use crate::link::ModelFault;
use leastaction_core::model::{ModelError, checksum};

/// How often a loader refused, and how often it did not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    /// Damaged files that were accepted.
    pub accepted: u32,
    /// Refusals by the code of their kind.
    pub by_fault: [u32; ModelFault::ALL.len()],
}

/// A kind of damage to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Every bit is changed, one at a time.
    Bit,
    /// Every bit before the checksum is changed, and the checksum corrected: the other checks have to find it alone.
    BitUnderChecksum,
    /// The end is missing, from one byte to all.
    Truncation,
}

impl Damage {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Bit, Self::BitUnderChecksum, Self::Truncation];

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bit => "bit",
            Self::BitUnderChecksum => "bit_under_checksum",
            Self::Truncation => "truncation",
        }
    }

    /// Counts the answers of a loader to a file with every such damage in turn; the file is whole again at the end.
    pub fn refusals(
        self,
        file: &mut [u8],
        mut load: impl FnMut(&[u8]) -> Result<(), ModelError>,
    ) -> Refusals {
        let mut refusals = Refusals::default();
        match self {
            Self::Bit => every_bit(file, |damaged| refusals.count(load(damaged))),
            Self::BitUnderChecksum => every_bit_under_checksum(file, |damaged| refusals.count(load(damaged))),
            Self::Truncation => {
                (0..file.len())
                    .filter_map(|length| file.get(..length))
                    .for_each(|cut| refusals.count(load(cut)));
            }
        }
        refusals
    }
}

impl Refusals {
    /// Counts what a loader said.
    pub fn count(&mut self, outcome: Result<(), ModelError>) {
        let counter = match outcome {
            Ok(()) => Some(&mut self.accepted),
            Err(error) => self.by_fault.get_mut(ModelFault::from(error) as usize),
        };
        debug_assert!(counter.is_some(), "every kind has its counter");
        if let Some(counter) = counter {
            *counter += 1;
        }
    }

    /// The kinds that occurred, and how often.
    pub fn occurred(&self) -> impl Iterator<Item = (ModelFault, u32)> {
        ModelFault::ALL.into_iter().zip(self.by_fault).filter(|(_, count)| *count > 0)
    }
}

fn every_bit(file: &mut [u8], mut visit: impl FnMut(&[u8])) {
    for bit in 0..8 * file.len() {
        flip(file, bit);
        visit(file);
        flip(file, bit);
    }
}

fn every_bit_under_checksum(file: &mut [u8], mut visit: impl FnMut(&[u8])) {
    let Some((body, _)) = file.split_last_chunk::<4>() else { return };
    for bit in 0..8 * body.len() {
        flip(file, bit);
        correct_checksum(file);
        visit(file);
        flip(file, bit);
    }
    correct_checksum(file);
}

fn flip(file: &mut [u8], bit: usize) {
    if let Some(byte) = file.get_mut(bit / 8) {
        *byte ^= 1 << (bit % 8);
    }
}

fn correct_checksum(file: &mut [u8]) {
    if let Some((body, sum)) = file.split_last_chunk_mut() {
        *sum = checksum(body).to_le_bytes();
    }
}
