//! The model file of a small arm in space.

use super::file;
use leastaction_core::energy::arm::ARM_PARAMETERS;
use leastaction_core::model::{ArmHeader, Family, Header, Laws};

/// A column that turns, an upper arm that swings on it, and a forearm that slides along the upper arm.
pub const TREE: ArmHeader<'static> = ArmHeader { bodies: &[0, 0, 0, 1, 1, 2] };

pub const HEADER: Header<'static> = Header { family: Family::Arm(TREE), ..file::HEADER };

/// Gravity downwards along z.
pub const GRAVITY: [f32; 3] = [0.0, 0.0, -9.75];

/// The numbers of its bodies: rotation row by row, place, axis; mass, first moments, inertia, rotor.
#[rustfmt::skip]
pub const NUMBERS: [[f32; ARM_PARAMETERS]; 3] = [
    [
        1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.375, 0.0, 0.0, 1.0,
        2.0, 0.0625, 0.0, -0.25, 0.25, 0.0, 0.25, 0.015625, 0.0, 0.125, 0.5,
    ],
    [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.125, 0.0, 0.0, 0.0, 0.0, 1.0,
        1.5, 0.0, -0.375, 0.0625, 0.25, 0.0, 0.0625, 0.0, 0.015625, 0.25, 0.25,
    ],
    [
        0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -0.5, 0.0, 0.0, 1.0, 0.0,
        0.5, 0.0, 0.125, 0.0, 0.0625, 0.0, 0.03125, 0.0, 0.0, 0.0625, 0.0,
    ],
];

/// The damping of its joints.
pub const DAMPING: [f32; 3] = [0.5, 0.125, 0.0];

/// The dry friction of its joints: c, c_load, τ_s, ε.
pub const FRICTION: [[f32; 4]; 3] =
    [[0.5, 0.25, 0.75, 0.0625], [0.125, 0.0, 1.0, 0.125], [0.0, 0.5, 0.25, 0.5]];

pub fn weights() -> Vec<f32> {
    [&GRAVITY, NUMBERS.as_flattened(), &DAMPING].concat()
}

/// The valid file of an arm.
pub fn golden() -> Vec<u8> {
    file::write(HEADER, &weights())
}

/// The arm with dry friction.
pub fn with_friction() -> Vec<u8> {
    let header = Header { laws: Laws::FRICTION, ..HEADER };
    file::write(header, &[&weights(), FRICTION.as_flattened()].concat())
}
