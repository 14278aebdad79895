//! How a file stores weights.

use leastaction_core::scalar::f16;

/// How a file stores its weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Two bytes a number, `f16`.
    Half,
    /// Four bytes a number, `f32`.
    #[default]
    Single,
}

impl Precision {
    /// Bits of a number.
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

    /// Appends the nearest number, little-endian; `None` where it would be infinite.
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
