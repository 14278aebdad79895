//! Mechanisms as planar rigid bodies on joints, whose masses, lengths, centres and moments of inertia are learned.
//!
//! The known numbers are those that an engineer sees at a glance: which joints there are, that gravity is 9.81 m/s² and
//! its direction at q = 0, and that the centres of mass lie on the links. All other numbers are learned, from initial
//! values that are not those of any of the mechanisms.

use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_ground_truth::Mechanism;
use leastaction_models::{Architecture, BodiesArchitecture, Number};
use std::f64::consts::FRAC_PI_2;

/// Gravity, m/s².
const GRAVITY: f64 = 9.81;
/// Initial values of a mass, kg, the distance of a centre of mass from its joint, m, and a moment of inertia about the centre, kg m².
const START: [f64; 3] = [0.6, 0.2, 0.05];
/// Initial value of a length, m.
const LENGTH: f64 = 0.4;

/// Returns the bodies of a mechanism; `None` if they do not form a tree.
pub(super) fn bodies(mechanism: Mechanism) -> Option<Architecture> {
    let (gravity, bodies) = match mechanism {
        // The link is upright at 0.
        Mechanism::Pendulum => ([-GRAVITY, 0.0], vec![link(None, 0.0, None)]),
        // The cart slides along x, and the pole on it is upright at 0.
        Mechanism::Cartpole => ([0.0, GRAVITY], vec![cart(), link(Some(0), -FRAC_PI_2, None)]),
        // Both links hang at 0.
        Mechanism::Acrobot => ([GRAVITY, 0.0], vec![link(None, 0.0, None), link(Some(0), 0.0, Some(LENGTH))]),
    };
    BodiesArchitecture::new(gravity.map(Number::known), bodies).map(Architecture::from)
}

fn learned(value: f64) -> Number {
    Number::learned(value)
}

/// Returns a link whose joint is turned by `angle` and sits at the distance `length` along the parent.
fn link(parent: Option<u8>, angle: f64, length: Option<f64>) -> (TreeBody, BodyParameters<Number>) {
    let ([mass, centre, inertia], zero) = (START.map(learned), Number::known(0.0));
    let parameters = BodyParameters {
        place: [length.map_or(zero, learned), zero],
        angle: Number::known(angle),
        mass,
        centre: [centre, zero],
        inertia,
        rotor: zero,
        gear: Number::known(1.0),
    };
    (TreeBody { joint: Joint::Revolute, parent }, parameters)
}

/// Returns a cart on a rail, which never turns.
fn cart() -> (TreeBody, BodyParameters<Number>) {
    let (joint, (_, link)) = (Joint::Prismatic, link(None, 0.0, None));
    let [zero, one] = [0.0, 1.0].map(Number::known);
    (TreeBody { joint, parent: None }, BodyParameters { centre: [zero; 2], inertia: one, ..link })
}
