//! The arm of `firmware-sim/chip/models`: the frames of a Franka Panda with bodies of round numbers.

use leastaction_core::energy::arm::ARM_PARAMETERS;
use leastaction_core::model::{ArmHeader, Family, Header, Laws, WriteError, write};

/// Number of joints.
pub const JOINTS: usize = 7;
/// Tree of the bodies: each body sits on the previous one, by a revolute joint.
pub const TREE: [u8; 2 * JOINTS] = [0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6];
/// Quarter turns about x from the previous frame to that of the joint, and a and d of Craig's convention, m.
pub const FRAMES: [(i8, f32, f32); JOINTS] = [
    (0, 0.0, 0.333),
    (-1, 0.0, 0.0),
    (1, 0.0, 0.316),
    (1, 0.0825, 0.0),
    (-1, -0.0825, 0.384),
    (1, 0.0, 0.0),
    (1, 0.088, 0.0),
];
/// Masses, kg.
const MASSES: [f32; JOINTS] = [4.0, 3.5, 3.0, 3.0, 2.5, 1.5, 0.75];
/// Centre of mass of every body relative to its joint, m.
const CENTRE: [f32; 3] = [0.03125, -0.0625, 0.03125];
/// Moments of inertia of a body of 1 kg about its centre of mass, kg m².
const INERTIA: [f32; 3] = [0.015625, 0.0078125, 0.015625];
/// Inertia of the drives' rotors, kg m².
const ROTOR: f32 = 0.125;
/// Damping b of every joint, N m s/rad.
const DAMPING: f32 = 0.5;

/// Returns the model file.
///
/// # Errors
/// If it is longer than 2 KB, which it is not.
pub fn model_file() -> Result<Vec<u8>, WriteError> {
    let header = Header {
        laws: Laws::VISCOUS,
        provenance: "a Panda's frames with bodies of round numbers",
        ..Header::new(Family::Arm(ArmHeader { bodies: &TREE }))
    };
    let mut weights = vec![0.0, 0.0, -9.81];
    weights.extend(FRAMES.iter().zip(MASSES).flat_map(|(frame, mass)| body(*frame, round(mass), ROTOR)));
    weights.extend([DAMPING; JOINTS]);
    let bytes: Vec<u8> = weights.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut memory = [0; 2048];
    write(&header, &bytes, &mut memory).map(<[u8]>::to_vec)
}

/// Mass, first moments and inertia about the joint, for a body of round numbers.
fn round(m: f32) -> [f32; 10] {
    let [x, y, z] = CENTRE;
    let [xx, yy, zz] = INERTIA;
    [
        m,
        m * x,
        m * y,
        m * z,
        m * (xx + y * y + z * z),
        -m * x * y,
        m * (yy + x * x + z * z),
        -m * x * z,
        -m * y * z,
        m * (zz + x * x + y * y),
    ]
}

/// Numbers of a body in a model file: R, p, axis, inertia about the joint and rotor.
pub fn body((turn, a, d): (i8, f32, f32), inertia: [f32; 10], rotor: f32) -> [f32; ARM_PARAMETERS] {
    let s = f32::from(turn);
    let c = 1.0 - s.abs();
    // Rotation Rx of the quarter turn, position of the joint, and the axis z.
    let frame = [1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c, a, -s * d, c * d, 0.0, 0.0, 1.0];
    let numbers = frame.into_iter().chain(inertia).chain([rotor]);
    let mut body = [0.0; ARM_PARAMETERS];
    body.iter_mut().zip(numbers).for_each(|(entry, number)| *entry = number);
    body
}
