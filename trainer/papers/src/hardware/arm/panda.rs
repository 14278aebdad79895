//! Kinematics of the Franka Panda.

use leastaction_models::tree::Tree;
use leastaction_models::urdf::{Inertias, UrdfError, parse};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Modified Denavit–Hartenberg parameters α (rad), a and d (m) of the joints.
const NUMBERS: [[f64; 3]; 7] = [
    [0.0, 0.0, 0.333],
    [-FRAC_PI_2, 0.0, 0.0],
    [FRAC_PI_2, 0.0, 0.316],
    [FRAC_PI_2, 0.0825, 0.0],
    [-FRAC_PI_2, -0.0825, 0.384],
    [FRAC_PI_2, 0.0, 0.0],
    [FRAC_PI_2, 0.088, 0.0],
];

/// Returns a robot description with the kinematics alone: seven joints about z.
pub fn panda_urdf() -> String {
    let mut text = "<robot name=\"panda\">\n<link name=\"link0\"/>\n".to_owned();
    for (k, [alpha, a, d]) in NUMBERS.into_iter().enumerate() {
        let (next, [y, z]) = (k + 1, [-d * alpha.sin(), d * alpha.cos()]);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "<link name=\"link{next}\"/>\n<joint name=\"joint{next}\" type=\"continuous\"><parent link=\"link{k}\"/>\
             <child link=\"link{next}\"/><origin xyz=\"{a} {y} {z}\" rpy=\"{alpha} 0 0\"/><axis xyz=\"0 0 1\"/></joint>"
        );
    }
    text + "</robot>\n"
}

/// Returns the kinematics as a tree, without inertias.
pub fn panda() -> Result<Tree, UrdfError> {
    parse(&panda_urdf(), Inertias::Optional)
}
