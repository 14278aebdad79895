//! Storage format of weights in a file.

use leastaction_core::scalar::f16;

/// Storage format of the weights in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Two bytes per number, `f16`.
    Half,
    /// Four bytes per number, `f32`.
    #[default]
    Single,
}

impl Precision {
    /// Number of bits of a number.
    pub fn bits(self) -> u8 {
        match self {
            Self::Half => 16,
            Self::Single => 32,
        }
    }

    pub(crate) fn way_out(self) -> &'static str {
        match self {
            Self::Half => "keep single precision",
            Self::Single => "train again, with a smaller step or another seed",
        }
    }

    /// Appends the nearest representable number in little-endian order; `None` if it would be infinite.
    pub(crate) fn append(self, value: f64, block: &mut Vec<u8>) -> Option<()> {
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
