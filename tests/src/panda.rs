//! A Franka Panda for simulations: its frames and limits, bodies as identified, and drives and friction of realistic size.

use crate::arm::{FRAMES, JOINTS, TREE, body};
use leastaction_core::model::{ArmHeader, Family, Header, Laws, WriteError, write};
use std::fmt::Write;

/// Mass (kg), centre of mass (m), and inertia xx, xy, xz, yy, yz, zz about the centre (kg m²).
///
/// Source: Gaz et al., "Dynamic identification of the Franka Emika Panda robot with retrieval of feasible parameters", 2019.
pub const BODIES: [[f64; 10]; JOINTS] = [
    [4.970684, 3.875e-3, 2.081e-3, -0.1750, 0.70337, -1.39e-4, 6.772e-3, 0.70661, 1.9169e-2, 9.117e-3],
    [0.646926, -3.141e-3, -2.872e-2, 3.495e-3, 7.962e-3, -3.925e-3, 1.0254e-2, 2.811e-2, 7.04e-4, 2.5995e-2],
    [
        3.228604, 2.7518e-2, 3.9252e-2, -6.6502e-2, 3.7242e-2, -4.761e-3, -1.1396e-2, 3.6155e-2, -1.2805e-2,
        1.083e-2,
    ],
    [
        3.587895, -5.317e-2, 0.104419, 2.7454e-2, 2.5853e-2, 7.796e-3, -1.332e-3, 1.9552e-2, 8.641e-3,
        2.8323e-2,
    ],
    [
        1.225946, -1.1953e-2, 4.1065e-2, -3.8437e-2, 3.5549e-2, -2.117e-3, -4.037e-3, 2.9474e-2, 2.29e-4,
        8.627e-3,
    ],
    [1.666555, 6.0149e-2, -1.4117e-2, -1.0517e-2, 1.964e-3, 1.09e-4, -1.158e-3, 4.354e-3, 3.41e-4, 5.433e-3],
    [
        0.735522, 1.0517e-2, -4.252e-3, 6.1597e-2, 1.2516e-2, -4.28e-4, -1.196e-3, 1.0027e-2, -7.41e-4,
        4.815e-3,
    ],
];
/// Inertia of the rotor (kg m²), viscous friction (N m s/rad), Coulomb friction (N m) and its width (rad/s), of the size found in fits of
/// the real arm's log.
const DRIVES: [[f32; 4]; JOINTS] = [
    [0.2, 0.25, 0.45, 0.05],
    [0.2, 0.30, 0.50, 0.06],
    [0.15, 0.20, 0.40, 0.05],
    [0.15, 0.25, 0.45, 0.06],
    [0.05, 0.10, 0.30, 0.08],
    [0.05, 0.10, 0.25, 0.07],
    [0.05, 0.08, 0.20, 0.08],
];
/// Lowest and highest position (rad), velocity (rad/s) and effort (N m), from the maker's description.
pub const LIMITS: [[f64; 4]; JOINTS] = [
    [-2.8973, 2.8973, 2.175, 87.0],
    [-1.7628, 1.7628, 2.175, 87.0],
    [-2.8973, 2.8973, 2.175, 87.0],
    [-3.0718, -0.0698, 2.175, 87.0],
    [-2.8973, 2.8973, 2.61, 12.0],
    [-0.0175, 3.7525, 2.61, 12.0],
    [-2.8973, 2.8973, 2.61, 12.0],
];

/// Returns a model file of the true arm.
///
/// # Errors
/// If it is longer than 2 KB, which it is not.
pub fn model_file() -> Result<Vec<u8>, WriteError> {
    let header = Header {
        laws: Laws::FRICTION,
        provenance: "a Panda's frames, bodies as identified by Gaz et al. 2019, drives and friction of their size",
        ..Header::new(Family::Arm(ArmHeader { bodies: &TREE }))
    };
    let mut weights = vec![0.0, 0.0, -9.81];
    for (k, [rotor, ..]) in DRIVES.into_iter().enumerate() {
        weights.extend(body(FRAMES[k], about_joint(BODIES[k]).map(|x| x as f32), rotor));
    }
    weights.extend(DRIVES.map(|[_, viscous, ..]| viscous));
    // Friction without a part that grows with the load.
    weights.extend(DRIVES.iter().flat_map(|[.., coulomb, width]| [*coulomb, 0.0, 1.0, *width]));
    let bytes: Vec<u8> = weights.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut memory = [0; 2048];
    write(&header, &bytes, &mut memory).map(<[u8]>::to_vec)
}

/// Mass m, first moment m c, and inertia about the joint.
fn about_joint([m, x, y, z, xx, xy, xz, yy, yz, zz]: [f64; 10]) -> [f64; 10] {
    [
        m,
        m * x,
        m * y,
        m * z,
        xx + m * (y * y + z * z),
        xy - m * x * y,
        yy + m * (x * x + z * z),
        xz - m * x * z,
        yz - m * y * z,
        zz + m * (x * x + y * y),
    ]
}

/// Returns the maker's robot description (URDF): frames and limits, no masses.
#[must_use]
pub fn description() -> String {
    let mut text = "<robot name=\"panda\">\n<link name=\"link0\"/>\n".to_owned();
    for (k, ((turn, a, d), [from, to, velocity, effort])) in FRAMES.into_iter().zip(LIMITS).enumerate() {
        let angle = f64::from(turn) * std::f64::consts::FRAC_PI_2;
        let (s, c) = (f32::from(turn), 1.0 - f32::from(turn).abs());
        let (y, z) = (-s * d, c * d);
        let next = k + 1;
        // Writing to a string cannot fail.
        let _infallible = writeln!(
            text,
            "<link name=\"link{next}\"/>\n<joint name=\"joint{next}\" type=\"revolute\"><parent link=\"link{k}\"/><child link=\"link{next}\"/>\
             <origin xyz=\"{a} {y} {z}\" rpy=\"{angle} 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"{from}\" upper=\"{to}\" velocity=\"{velocity}\" effort=\"{effort}\"/></joint>"
        );
    }
    text + "</robot>\n"
}
