//! Numbers that a law of force has for every group of coordinates, with their ranges.

use super::{Law, ModelError};
use crate::scalar::FileWeightFormat;

/// Valid values of a number of a law.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberRange {
    /// x ≥ 0.
    NotNegative,
    /// x > 0.
    Positive,
    /// 0 ≤ x < 1.
    Share,
    /// x ≥ 1.
    NotBelowOne,
    /// −1 ≤ x ≤ 1.
    Signed,
    /// 0 ≤ x ≤ 1.
    Fraction,
    /// Any finite number.
    Finite,
}

impl NumberRange {
    /// Whether the range contains a value.
    pub fn contains(self, value: f32) -> bool {
        match self {
            Self::NotNegative => value >= 0.0,
            Self::Positive => value > 0.0,
            Self::Share => (0.0..1.0).contains(&value),
            Self::NotBelowOne => value >= 1.0,
            Self::Signed => (-1.0..=1.0).contains(&value),
            Self::Fraction => (0.0..=1.0).contains(&value),
            Self::Finite => value.is_finite(),
        }
    }

    /// The range in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::NotNegative => "0 or more",
            Self::Positive => "above 0",
            Self::Share => "0 or more and below 1",
            Self::NotBelowOne => "1 or more",
            Self::Signed => "between -1 and 1",
            Self::Fraction => "between 0 and 1",
            Self::Finite => "finite",
        }
    }
}

/// Position of a number of [`Coulomb`](crate::forces::Coulomb) among those of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrictionNumber {
    /// c ≥ 0, N or N m.
    Constant,
    /// 0 ≤ c_load < 1.
    Load,
    /// τ_s > 0, N or N m.
    Smoothing,
    /// ε > 0, m/s or rad/s.
    Width,
}

impl FrictionNumber {
    /// All numbers, in the order of a file.
    pub const ALL: [Self; 4] = [Self::Constant, Self::Load, Self::Smoothing, Self::Width];
}

/// Position of a number of [`Directional`](crate::forces::Directional) among those of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionalNumber {
    /// b ≥ 0, N s/m or N m s/rad.
    Viscous,
    /// −1 ≤ β ≤ 1.
    ViscousAsymmetry,
    /// c ≥ 0, N or N m.
    Constant,
    /// −1 ≤ δ ≤ 1.
    Asymmetry,
    /// ε > 0, m/s or rad/s.
    Width,
}

/// Position of a number of [`Sticking`](crate::forces::Sticking) among those of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StickingNumber {
    /// c ≥ 0, N or N m.
    Constant,
    /// −1 ≤ δ ≤ 1.
    Asymmetry,
    /// 0 ≤ c_load < 1.
    Load,
    /// τ_s > 0, N or N m.
    Smoothing,
    /// s ≥ 1.
    Breakaway,
    /// ε > 0, m/s or rad/s.
    Width,
}

/// Position of a number of [`Stops`](crate::forces::Stops) among those of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopsNumber {
    /// Middle between the stops, m or rad.
    Centre,
    /// Half the distance between them, above 0, m or rad.
    Half,
    /// 0 ≤ e ≤ 1.
    Restitution,
}

impl Law {
    /// Valid values of the numbers that the law has for every group of coordinates, in the order of a file; none for a law with a network.
    pub const fn ranges(self) -> &'static [NumberRange] {
        use NumberRange::{Finite, Fraction, NotBelowOne, NotNegative, Positive, Share, Signed};
        match self {
            Self::Viscous | Self::Servo => &[NotNegative],
            Self::Coulomb => &[NotNegative, Share, Positive, Positive],
            Self::Dissipation | Self::Potential => &[],
            Self::Directional => &[NotNegative, Signed, NotNegative, Signed, Positive],
            Self::Sticking => &[NotNegative, Signed, Share, Positive, NotBelowOne, Positive],
            Self::Stops => &[Finite, Positive, Fraction],
        }
    }

    /// Symbols of these numbers in the equation of the law. Apart from their ranges, so that a program without messages has no texts.
    pub const fn symbols(self) -> &'static [&'static str] {
        match self {
            Self::Viscous => &["b"],
            Self::Coulomb => &["c", "c_load", "tau_s", "epsilon"],
            Self::Dissipation | Self::Potential => &[],
            Self::Servo => &["k"],
            Self::Directional => &["b", "beta", "c", "delta", "epsilon"],
            Self::Sticking => &["c", "delta", "c_load", "tau_s", "s", "epsilon"],
            Self::Stops => &["centre", "half", "e"],
        }
    }

    /// Checks the numbers of all groups.
    pub(super) fn validate<W: FileWeightFormat>(self, numbers: &[W]) -> Result<(), ModelError> {
        for (group, own) in numbers.chunks(self.ranges().len().max(1)).enumerate() {
            for (number, (value, range)) in own.iter().zip(self.ranges()).enumerate() {
                let value = value.wide();
                if !range.contains(value) {
                    return Err(ModelError::LawNumber {
                        law: self,
                        number: number as u8,
                        group: group as u16,
                        value,
                    });
                }
            }
        }
        Ok(())
    }
}
