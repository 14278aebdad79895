//! Known and learned numbers of a weight block.

use serde::{Deserialize, Serialize};

/// A number of a weight block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Value of the number, or its start if it is learned.
    pub value: f64,
    /// Whether training changes it.
    pub learned: bool,
    /// Part of the log's own scale that replaces the value before training ([`Scales`](crate::Scales)); `None` for a value that stays, because
    /// it was given or has no unit.
    pub part: Option<f64>,
}

impl Number {
    /// Creates a known number.
    pub const fn known(value: f64) -> Self {
        Self::new(value, false)
    }

    /// Creates a number that is learned, starting at `value`.
    pub const fn learned(value: f64) -> Self {
        Self::new(value, true)
    }

    /// Creates a number that is learned, starting at `value`, or known.
    pub const fn new(value: f64, learned: bool) -> Self {
        Self { value, learned, part: None }
    }

    /// Replaces the value by the part of this scale that the number follows, if it follows any and the scale is above 0.
    pub(crate) fn follow(&mut self, scale: f64) {
        if let Some(part) = self.part.filter(|_| scale > 0.0 && scale.is_finite()) {
            *self = Self::new(part * scale, self.learned);
        }
    }

    /// Replaces the value by one that was given.
    pub(crate) fn give(&mut self, value: f64) {
        *self = Self::new(value, self.learned);
    }
}

/// Positions of the known numbers, counted from `start`.
pub(crate) fn known_positions(start: usize, numbers: impl Iterator<Item = Number>) -> Vec<usize> {
    (start..).zip(numbers).filter(|(_, number)| !number.learned).map(|(position, _)| position).collect()
}
