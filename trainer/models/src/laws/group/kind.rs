//! Meanings of the numbers that a law of force has for every group of coordinates.

use crate::bounds::Range;
use crate::scales::Scales;
use leastaction_core::model::Law;

/// Bounds of a learned width ε where no log is read, m/s or rad/s.
pub const WIDTHS: [f64; 2] = [0.02, 1.0];
/// Bounds of a learned width ε as parts of the log's speed. Below the lower one, a log has hardly a sample within the change of sign, which
/// then cannot be told from a jump: of samples spread evenly over the speeds, three in a thousand. Above the upper one dry friction never comes
/// near its full value (tanh 2 = 0.96 at that speed), and the law can hardly be told from viscous damping.
pub const WIDTH_PARTS: [f64; 2] = [0.003, 0.5];
/// Distance of a width's start from the bounds, as a factor: they make way for a start beyond them.
const START_FACTOR: f64 = 2.0;
/// Upper bound of a learned c_load.
pub const MOST_LOAD: f64 = 0.95;

/// Meaning of a number of a law, from which its unit, its range, and the scale of a log that it follows, are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberKind {
    /// Damping b ≥ 0, N s/m or N m s/rad.
    Damping,
    /// Asymmetry β of damping, −1 ≤ β ≤ 1.
    DampingAsymmetry,
    /// Coulomb friction c ≥ 0, N or N m.
    Friction,
    /// Asymmetry δ of Coulomb friction, −1 ≤ δ ≤ 1.
    FrictionAsymmetry,
    /// Growth of friction with the load, 0 ≤ c_load < 1.
    Load,
    /// Smoothing load τ_s > 0, N or N m.
    Smoothing,
    /// Breakaway ratio s ≥ 1.
    Breakaway,
    /// Width ε > 0 of the change of sign, m/s or rad/s.
    Width,
    /// Stiffness k ≥ 0 of a servo, N/m or N m/rad.
    Stiffness,
    /// Middle between two end stops, m or rad.
    Centre,
    /// Half the distance between two end stops, above 0, m or rad.
    HalfDistance,
    /// Restitution of a stop, 0 ≤ e ≤ 1.
    Restitution,
}

impl NumberKind {
    /// Meanings of the numbers of a law, in the order of a file; none for a law with a network.
    pub const fn of(law: Law) -> &'static [Self] {
        use NumberKind::{
            Breakaway, Centre, Damping, DampingAsymmetry, Friction, FrictionAsymmetry, HalfDistance, Load,
            Restitution, Smoothing, Stiffness, Width,
        };
        match law {
            Law::Viscous => &[Damping],
            Law::Coulomb => &[Friction, Load, Smoothing, Width],
            Law::Dissipation | Law::Potential => &[],
            Law::Servo => &[Stiffness],
            Law::Directional => &[Damping, DampingAsymmetry, Friction, FrictionAsymmetry, Width],
            Law::Sticking => &[Friction, FrictionAsymmetry, Load, Smoothing, Breakaway, Width],
            Law::Stops => &[Centre, HalfDistance, Restitution],
        }
    }

    /// The meaning in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Damping => "viscous friction",
            Self::DampingAsymmetry => "viscous friction, asymmetry",
            Self::Friction => "Coulomb friction",
            Self::FrictionAsymmetry => "Coulomb friction, asymmetry",
            Self::Load => "Coulomb friction, growth with the load",
            Self::Smoothing => "Coulomb friction, load from which it grows",
            Self::Breakaway => "Coulomb friction, at rest over in motion",
            Self::Width => "Coulomb friction, width of the change of sign",
            Self::Stiffness => "stiffness of the servo",
            Self::Centre => "middle between the end stops",
            Self::HalfDistance => "half the distance between the end stops",
            Self::Restitution => "restitution of the end stops",
        }
    }

    /// Unit for a coordinate that is a length, or an angle; empty for a number without one.
    pub const fn unit(self, is_length: bool) -> &'static str {
        match (self, is_length) {
            (Self::Damping, true) => "N s/m",
            (Self::Damping, false) => "N m s/rad",
            (Self::Friction | Self::Smoothing, true) => "N",
            (Self::Friction | Self::Smoothing, false) => "N m",
            (Self::Width, true) => "m/s",
            (Self::Width, false) => "rad/s",
            (Self::Stiffness, true) => "N/m",
            (Self::Stiffness, false) => "N m/rad",
            (Self::Centre | Self::HalfDistance, true) => "m",
            (Self::Centre | Self::HalfDistance, false) => "rad",
            (
                Self::DampingAsymmetry
                | Self::FrictionAsymmetry
                | Self::Load
                | Self::Breakaway
                | Self::Restitution,
                _,
            ) => "",
        }
    }

    /// Scale of a log that the number follows; `None` for a number without a unit.
    pub(super) fn scale(self, scales: &Scales) -> Option<f64> {
        match self {
            Self::Damping => Some(scales.damping()),
            Self::Friction | Self::Smoothing => Some(scales.force),
            Self::Width => Some(scales.speed),
            Self::Stiffness => Some(scales.stiffness()),
            _ => None,
        }
    }

    /// Whether the law's force is the sum of such numbers times what does not depend on them, the asymmetries held.
    pub const fn is_linear(self) -> bool {
        matches!(self, Self::Damping | Self::Friction | Self::Load | Self::Stiffness)
    }

    /// Whether the law's friction is in proportion to such numbers.
    pub const fn is_of_friction(self) -> bool {
        matches!(self, Self::Damping | Self::Friction | Self::Load)
    }

    /// Whether a law has numbers of friction for every group of coordinates.
    pub(crate) fn are_of_friction(law: Law) -> bool {
        Self::of(law).iter().any(|kind| matches!(kind, Self::Damping | Self::Friction))
    }

    /// Whether a known value, unless it is 0, shows the scale of L without a logged force.
    pub(super) const fn shows_scale(self) -> bool {
        matches!(self, Self::Damping | Self::Friction | Self::Stiffness)
    }

    /// Value that has no effect, or for a number that shapes others, any valid one.
    pub(super) const fn neutral(self) -> f64 {
        match self {
            Self::Smoothing | Self::Breakaway | Self::Width => 1.0,
            // Out of reach.
            Self::HalfDistance => f32::MAX as f64,
            _ => 0.0,
        }
    }

    /// Range of a learned number; `widths` are the bounds of a width.
    pub(super) fn range(self, widths: [f64; 2]) -> Range {
        match self {
            Self::Damping | Self::Friction | Self::Smoothing | Self::Stiffness => Range::Positive,
            Self::DampingAsymmetry | Self::FrictionAsymmetry => Range::Between(-1.0, 1.0),
            Self::Load => Range::Between(0.0, MOST_LOAD),
            // The smooth law, which gradients see, has no breakaway and no stops: such a number is never learned.
            Self::Breakaway | Self::Centre | Self::HalfDistance | Self::Restitution => Range::Any,
            Self::Width => Range::Between(widths[0], widths[1]),
        }
    }
}

/// Bounds of a width that starts at this value, given the log's speed, if there is one.
pub(super) fn width_bounds(speed: Option<f64>, start: f64) -> [f64; 2] {
    let of_speed = |speed: f64| WIDTH_PARTS.map(|part| part * speed);
    let [least, most] = speed.filter(|speed| *speed > 0.0).map_or(WIDTHS, of_speed);
    [least.min(start / START_FACTOR), most.max(start * START_FACTOR)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_law_has_a_meaning() {
        for law in Law::ALL {
            assert_eq!(NumberKind::of(law).len(), law.ranges().len(), "{law:?}");
            for (kind, range) in NumberKind::of(law).iter().zip(law.ranges()) {
                assert!(range.contains(kind.neutral() as f32), "{kind:?}");
            }
        }
    }
}
