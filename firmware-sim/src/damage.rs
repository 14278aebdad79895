//! Answers of loaders to damaged model files, on any target: every changed bit and every truncation, counted by reason.

use leastaction_core::model::{CATALOGUE, Entry, ModelError, checksum};

/// Numbers of refused and of accepted files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refusals {
    /// Damaged files that were accepted.
    pub accepted: u32,
    /// Number of refusals for each reason, in the order of [`CATALOGUE`].
    by_reason: [u32; CATALOGUE.len()],
}

/// A kind of damage to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// Every bit is changed, one at a time.
    Bit,
    /// Every bit before the checksum is changed and the checksum corrected, so only the other checks can find it.
    BitUnderChecksum,
    /// The end is missing, from one byte to all.
    Truncation,
}

impl Damage {
    /// All kinds of damage.
    pub const ALL: [Self; 3] = [Self::Bit, Self::BitUnderChecksum, Self::Truncation];

    /// Name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bit => "bit",
            Self::BitUnderChecksum => "bit_under_checksum",
            Self::Truncation => "truncation",
        }
    }

    /// Counts a loader's answers to a file with every such damage in turn; the file is whole again at the end.
    pub fn refusals(
        self,
        file: &mut [u8],
        mut load: impl FnMut(&[u8]) -> Result<(), ModelError>,
    ) -> Refusals {
        let mut refusals = Refusals { accepted: 0, by_reason: [0; CATALOGUE.len()] };
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
    /// Counts one answer of a loader.
    pub fn count(&mut self, outcome: Result<(), ModelError>) {
        let counter = match outcome {
            Ok(()) => Some(&mut self.accepted),
            Err(error) => {
                let code = error.coded().code;
                let mut reasons = CATALOGUE.iter().zip(&mut self.by_reason);
                reasons.find(|(entry, _)| entry.code == code).map(|(_, counter)| counter)
            }
        };
        debug_assert!(counter.is_some(), "every reason is in the catalogue");
        if let Some(counter) = counter {
            *counter += 1;
        }
    }

    /// Reasons that occurred, with their counts.
    pub fn occurred(&self) -> impl Iterator<Item = (&'static Entry, u32)> {
        CATALOGUE.iter().zip(self.by_reason).filter(|(_, count)| *count > 0)
    }

    /// Count of the reason with the given name.
    pub fn of(&self, name: &str) -> u32 {
        self.occurred().find(|(entry, _)| entry.name == name).map_or(0, |(_, count)| count)
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
