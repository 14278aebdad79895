//! The model file of a small tree of bodies.

use super::file;
use leastaction_core::energy::bodies::BODY_PARAMETERS;
use leastaction_core::model::{BodiesHeader, Family, Header, Laws};

/// The tree of a crane: a cart on a rail, a jib that turns on it, a trolley that slides along the jib.
pub const CRANE: BodiesHeader<'static> = BodiesHeader::planar(&[1, 0, 0, 1, 1, 2]);

pub const HEADER: Header<'static> = Header { family: Family::Bodies(CRANE), ..file::HEADER };

/// Gravity downwards along y.
pub const GRAVITY: [f32; 2] = [0.0, -9.75];

/// The numbers of its bodies: place, angle, mass, centre, inertia, rotor, gear.
pub const NUMBERS: [[f32; BODY_PARAMETERS]; 3] = [
    [0.0, 0.0, 0.0, 2.0, 0.0, 0.125, 0.25, 0.0, 1.0],
    [0.0, 0.25, -1.5, 0.75, 0.5, 0.0, 0.0625, 0.00390625, 6.0],
    [0.125, 0.0, 0.0, 0.5, 0.0, -0.125, 0.015625, 0.0, 1.0],
];

/// The damping of its joints.
pub const DAMPING: [f32; 3] = [0.5, 0.125, 0.0];

pub fn weights(numbers: [[f32; BODY_PARAMETERS]; 3]) -> Vec<f32> {
    [&GRAVITY, numbers.as_flattened(), &DAMPING].concat()
}

/// The dry friction of its joints: c, c_load, τ_s, ε.
pub const FRICTION: [[f32; 4]; 3] =
    [[0.5, 0.25, 0.75, 0.0625], [0.125, 0.0, 1.0, 0.125], [0.0, 0.5, 0.25, 0.5]];

/// The crane with dry friction.
pub fn with_friction() -> Vec<u8> {
    let header = Header { laws: Laws::FRICTION, ..HEADER };
    file::write(header, &[&weights(NUMBERS), FRICTION.as_flattened()].concat())
}

/// The valid file of bodies that the tests damage.
pub fn golden() -> Vec<u8> {
    file::write(HEADER, &weights(NUMBERS))
}
