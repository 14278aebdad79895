//! Description of an arm in words.

use crate::bodies::space::ArmArchitecture;
use crate::family::Family;
use crate::words::{self, Describe, vector};
use leastaction_core::energy::arm::ArmParameters;
use leastaction_core::energy::bodies::TreeBody;
use serde::Serialize;

/// Gravity and bodies.
#[derive(Serialize)]
pub struct ArmDescription {
    /// γ, m/s².
    gravity: [f64; 3],
    /// Bodies, in the order of the coordinates.
    bodies: Vec<ArmBody>,
}

/// A rigid body in space on its joint.
#[derive(Serialize)]
struct ArmBody {
    joint: &'static str,
    on: Option<u8>,
    at: [f64; 3],
    axis: [f64; 3],
    mass: f64,
    centre: [f64; 3],
    inertia: [f64; 3],
    rotor: f64,
}

impl From<&ArmArchitecture> for ArmDescription {
    fn from(arm: &ArmArchitecture) -> Self {
        let weights = arm.initial_weights(0);
        let numbers = |k: usize| ArmArchitecture::body_of(&weights, k);
        let each = arm.tree_bodies().enumerate().filter_map(|(k, body)| Some((body, numbers(k)?)));
        Self {
            gravity: arm.gravity,
            bodies: each.map(|(body, numbers)| ArmBody::new(body, numbers)).collect(),
        }
    }
}

impl Describe for ArmDescription {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let gravity = [("gravity", format!("{} m/s²", vector(&self.gravity)))].into_iter();
        gravity.chain(self.bodies.iter().map(|body| ("body", body.line()))).collect()
    }
}

impl ArmBody {
    fn new(body: TreeBody, numbers: ArmParameters<f64>) -> Self {
        let [m, x, y, z, xx, _, yy, _, _, zz] = numbers.inertia.into_array();
        let centre = if m > 0.0 { [x / m, y / m, z / m] } else { [0.0; 3] };
        Self {
            joint: words::joint(body.joint),
            on: body.parent,
            at: numbers.place,
            axis: numbers.axis,
            mass: m,
            centre,
            inertia: [xx, yy, zz],
            rotor: numbers.rotor,
        }
    }

    fn line(&self) -> String {
        let Self { joint, on, at, axis, mass, centre, inertia, rotor } = self;
        let on = on.map_or_else(|| "the base".to_owned(), |on| format!("body {on}"));
        format!(
            "{joint} on {on} at {} m about {}, {mass:.4} kg, centre {} m, moments of inertia about the joint {} kg m², rotor {rotor:.4} kg m²",
            vector(at),
            vector(axis),
            vector(centre),
            vector(inertia)
        )
    }
}
