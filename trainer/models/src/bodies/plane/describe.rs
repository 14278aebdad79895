//! Description of planar bodies in words.

use crate::bodies::plane::BodiesArchitecture;
use crate::words::{self, Describe};
use leastaction_core::energy::bodies::{BodyParameters, TreeBody};
use serde::Serialize;

/// Gravity and bodies.
#[derive(Serialize)]
pub struct BodiesDescription {
    /// γ, m/s².
    gravity: [f64; 2],
    /// Bodies, in the order of the coordinates.
    bodies: Vec<Body>,
}

/// A rigid body on its joint.
#[derive(Serialize)]
struct Body {
    joint: &'static str,
    on: Option<u8>,
    at: [f64; 2],
    angle: f64,
    mass: f64,
    centre: [f64; 2],
    inertia: f64,
    rotor: f64,
    gear: f64,
}

impl From<&BodiesArchitecture> for BodiesDescription {
    fn from(bodies: &BodiesArchitecture) -> Self {
        let each = bodies.bodies().zip(&bodies.numbers);
        Self {
            gravity: bodies.gravity.map(|number| number.value),
            bodies: each.map(|(body, numbers)| Body::new(body, numbers.map(|number| number.value))).collect(),
        }
    }
}

impl Describe for BodiesDescription {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let [x, y] = self.gravity;
        let gravity = [("gravity", format!("({x:.4}, {y:.4}) m/s²"))].into_iter();
        gravity.chain(self.bodies.iter().map(|body| ("body", body.line()))).collect()
    }
}

impl Body {
    fn new(TreeBody { joint, parent }: TreeBody, numbers: [f64; 9]) -> Self {
        let BodyParameters { place, angle, mass, centre, inertia, rotor, gear } =
            BodyParameters::from_array(numbers);
        let joint = words::joint(joint);
        Self { joint, on: parent, at: place, angle, mass, centre, inertia, rotor, gear }
    }

    fn line(&self) -> String {
        let Self { joint, on, at: [x, y], angle, mass, centre: [cx, cy], inertia, rotor, gear } = self;
        let on = on.map_or("the ground".to_owned(), |body| format!("body {body}"));
        let drive =
            if *rotor > 0.0 { format!(", rotor {rotor:.3e} kg m² by {gear:.4}") } else { String::new() };
        format!(
            "{joint} on {on} at ({x:.4}, {y:.4}) m, {angle:.4} rad: mass {mass:.4} kg, centre ({cx:.4}, {cy:.4}) m, \
             inertia {inertia:.3e} kg m²{drive}"
        )
    }
}
