use super::{BodyInertia, INERTIAL_PARAMETERS, Rotation, Vector};

/// Number of components of the acceleration of gravity γ, m/s², which come first in the weight block.
pub const ARM_GRAVITY_PARAMETERS: usize = 3;
/// Number of [`ArmParameters`] of a body.
pub const ARM_PARAMETERS: usize = 16 + INERTIAL_PARAMETERS;

/// The numbers of a body, in the order of the weight block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmParameters<S> {
    /// Rotation R of the joint's frame in the parent's frame, x_parent = Rx + p; its columns are the axes of the joint's frame. Orthonormal
    /// to rounding: the derivatives rely on it.
    pub rotation: Rotation<S>,
    /// Origin p of the joint's frame in the parent's frame, m.
    pub place: Vector<S>,
    /// Unit axis of the joint in the joint's frame.
    pub axis: Vector<S>,
    /// Inertia of the body about the origin of its frame, in its frame.
    pub inertia: BodyInertia<S>,
    /// Rotor inertia J ≥ 0 of the drive, reflected to the joint (times the square of the gear ratio), kg m²; kg for a prismatic joint.
    pub rotor: S,
}

impl<S> ArmParameters<S> {
    /// Creates the parameters from the weight block's order: R row by row, p, axis, the ten of [`BodyInertia::from_array`], J.
    pub fn from_array(numbers: [S; ARM_PARAMETERS]) -> Self {
        let [a, b, c, d, e, f, g, h, i, x, y, z, along_x, along_y, along_z, rest @ ..] = numbers;
        let [m, mx, my, mz, xx, xy, yy, xz, yz, zz, rotor] = rest;
        Self {
            rotation: [[a, b, c], [d, e, f], [g, h, i]],
            place: [x, y, z],
            axis: [along_x, along_y, along_z],
            inertia: BodyInertia::from_array([m, mx, my, mz, xx, xy, yy, xz, yz, zz]),
            rotor,
        }
    }

    /// Returns the parameters in the order of the weight block.
    pub fn into_array(self) -> [S; ARM_PARAMETERS] {
        let Self { rotation: [[a, b, c], [d, e, f], [g, h, i]], place, axis, inertia, rotor } = self;
        let ([x, y, z], [along_x, along_y, along_z]) = (place, axis);
        let [m, mx, my, mz, xx, xy, yy, xz, yz, zz] = inertia.into_array();
        [
            a, b, c, d, e, f, g, h, i, x, y, z, along_x, along_y, along_z, m, mx, my, mz, xx, xy, yy, xz, yz,
            zz, rotor,
        ]
    }
}
