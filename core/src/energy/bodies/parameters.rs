//! The numbers of a body.

use super::Vector;

/// Components of the acceleration of gravity γ, m/s², which come first in the weight block.
pub const GRAVITY_PARAMETERS: usize = 2;
/// Number of [`BodyParameters`] of a body.
pub const BODY_PARAMETERS: usize = 9;

/// The numbers of a body, in the order of the weight block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyParameters<S> {
    /// Place of the joint in the parent's frame, m.
    pub place: Vector<S>,
    /// How far the joint's frame is turned from the parent's, rad.
    pub angle: S,
    /// m > 0, kg.
    pub mass: S,
    /// The centre of mass in the body's frame, m.
    pub centre: Vector<S>,
    /// I > 0 about the centre of mass, kg m².
    pub inertia: S,
    /// J ≥ 0 of the rotor that drives the joint and sits on the parent, kg m².
    pub rotor: S,
    /// g: the rotor turns g q̇ against the parent; 1, or 1/m of a prismatic joint.
    pub gear: S,
}

impl<S> BodyParameters<S> {
    /// Parameters from the order of the weight block.
    pub fn from_array(numbers: [S; BODY_PARAMETERS]) -> Self {
        let [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear] = numbers;
        Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear }
    }

    /// Parameters in the order of the weight block.
    pub fn into_array(self) -> [S; BODY_PARAMETERS] {
        let Self { place: [x, y], angle, mass, centre: [centre_x, centre_y], inertia, rotor, gear } = self;
        [x, y, angle, mass, centre_x, centre_y, inertia, rotor, gear]
    }
}
