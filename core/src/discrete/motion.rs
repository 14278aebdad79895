//! Motion of one coordinate under dry friction that sticks: the law that all steps solve, with and without constraints.

use crate::forces::Grip;
use crate::scalar::Real;

/// Motion of a coordinate during a step or at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Sticks,
    Forward,
    Backward,
    /// Moves without dry friction, and cannot stick.
    Free,
    /// Ends on the lower stop.
    AtLower,
    /// Ends on the upper stop.
    AtUpper,
}

impl Motion {
    /// The motion that a velocity shows away from the stops.
    #[inline(always)]
    pub fn shown<R: Real>(grip: &Grip<R>, v: R) -> Self {
        if grip.forward + grip.backward == R::zero() {
            Self::Free
        } else if v > R::zero() {
            Self::Forward
        } else if v < R::zero() {
            Self::Backward
        } else {
            Self::Sticks
        }
    }

    /// Impulse of sliding friction from the largest impulses in both directions; 0 for other motions.
    #[inline(always)]
    pub fn sliding<R: Real>(self, grip: &Grip<R>) -> R {
        match self {
            Self::Forward => -grip.forward,
            Self::Backward => grip.backward,
            _ => R::zero(),
        }
    }

    /// The motion that agrees with the velocity where friction slides, and where it sticks with the impulse that this needs, known to
    /// `slack`.
    #[inline(always)]
    pub fn agreeing<R: Real>(self, grip: &Grip<R>, v: R, needed: R, slack: R) -> Self {
        let holds = |level: R| grip.breakaway * level + slack;
        match self {
            Self::Sticks if needed < -holds(grip.forward) => Self::shown(grip, R::one()),
            Self::Sticks if needed > holds(grip.backward) => Self::shown(grip, -R::one()),
            Self::Forward if v < R::zero() => Self::Sticks,
            Self::Backward if v > R::zero() => Self::Sticks,
            same => same,
        }
    }
}
