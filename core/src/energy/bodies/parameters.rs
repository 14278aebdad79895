//! The numbers of a body.

use super::Vector;

/// Number of components of the acceleration of gravity γ, m/s², which come first in the weight block.
pub const GRAVITY_PARAMETERS: usize = 2;
/// Number of [`BodyParameters`] of a body.
pub const BODY_PARAMETERS: usize = 9;

/// The numbers of a body, in the order of the weight block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParameters<S> {
    /// Origin of the joint in the parent's frame, m.
    pub place: Vector<S>,
    /// Angle of the joint's frame in the parent's frame, rad.
    pub angle: S,
    /// Mass m > 0, kg.
    pub mass: S,
    /// Centre of mass in the body's frame, m.
    pub centre: Vector<S>,
    /// Moment of inertia I > 0 about the centre of mass, kg m².
    pub inertia: S,
    /// Moment of inertia J ≥ 0 of the rotor that drives the joint and sits on the parent, kg m².
    pub rotor: S,
    /// Gear ratio g: the rotor turns at g q̇ against the parent; unit 1, or 1/m for a prismatic joint.
    pub gear: S,
}

impl<S> BodyParameters<S> {
    /// Creates the parameters from the order of the weight block.
    pub fn from_array(numbers: [S; BODY_PARAMETERS]) -> Self {
        let [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear] = numbers;
        Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear }
    }

    /// Returns the parameters in the order of the weight block.
    pub fn into_array(self) -> [S; BODY_PARAMETERS] {
        let Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear } = self;
        [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear]
    }
}
