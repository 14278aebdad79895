use core::fmt;
use serde::{Deserialize, Serialize};

/// The order of accuracy of an integrator: its error over a fixed time falls with this power of the step h.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Order {
    /// Midpoint paths, or one RATTLE step.
    Two,
    /// Quadratic paths over two Gauss points, or Suzuki's composition of five RATTLE steps, the third of them back in time.
    Four,
}

impl Order {
    /// 2 or 4.
    pub const fn number(self) -> u8 {
        match self {
            Self::Two => 2,
            Self::Four => 4,
        }
    }

    /// The order with the given number, if there is one.
    pub const fn from_number(number: u8) -> Option<Self> {
        match number {
            2 => Some(Self::Two),
            4 => Some(Self::Four),
            _ => None,
        }
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.number().fmt(f)
    }
}
