//! Numbers of a weight block that are known or learned, and where learned ones may be.

use serde::{Deserialize, Serialize};

/// A number of a weight block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Its value, where training begins if it is learned.
    pub value: f64,
    /// Whether training changes it.
    pub learned: bool,
}

impl Number {
    /// A known number.
    pub const fn known(value: f64) -> Self {
        Self { value, learned: false }
    }

    /// A number that is learned from there.
    pub const fn learned(value: f64) -> Self {
        Self { value, learned: true }
    }
}

/// Positions, from `start` on, of the numbers that are known.
pub(crate) fn known_positions(start: usize, numbers: impl Iterator<Item = Number>) -> Vec<usize> {
    (start..).zip(numbers).filter(|(_, number)| !number.learned).map(|(position, _)| position).collect()
}
