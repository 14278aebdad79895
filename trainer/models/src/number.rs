//! Known and learned numbers of a weight block.

use serde::{Deserialize, Serialize};

/// A number of a weight block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Value of the number, or its start if it is learned.
    pub value: f64,
    /// Whether training changes it.
    pub learned: bool,
}

impl Number {
    /// Creates a known number.
    pub const fn known(value: f64) -> Self {
        Self { value, learned: false }
    }

    /// Creates a number that is learned, starting at `value`.
    pub const fn learned(value: f64) -> Self {
        Self { value, learned: true }
    }
}

/// Positions of the known numbers, counted from `start`.
pub(crate) fn known_positions(start: usize, numbers: impl Iterator<Item = Number>) -> Vec<usize> {
    (start..).zip(numbers).filter(|(_, number)| !number.learned).map(|(position, _)| position).collect()
}
