//! A tree for tests.

use super::{Body, Inertia, Joint, Limits, Pose, Tree};
use nalgebra::{Matrix3, Unit, Vector3};

fn body(k: usize, parent: Option<usize>, joint: fn(Unit<Vector3<f64>>) -> Joint) -> Body {
    let x = k as f64;
    let centre = Vector3::new(0.1 + 0.1 * x, -0.2, 0.3 * x);
    Body {
        name: format!("body {k}"),
        joint_name: format!("joint {k}"),
        parent,
        joint: joint(Unit::new_normalize(Vector3::new(1.0, 0.5 - x, 0.3 * x))),
        pose: Pose::of_rpy([0.4, 0.1 * x, -0.3], [0.3 * x, 0.7, -0.2 * x]),
        coordinate: k,
        ratio: 1.0,
        offset: 0.0,
        inertia: Inertia::of_centre(1.0 + x, centre, Matrix3::identity() * 0.02),
        limits: Limits::none(),
    }
}

/// A branched tree with a slide.
pub fn branched() -> Tree {
    let bodies = [
        body(0, None, Joint::Revolute),
        body(1, Some(0), Joint::Prismatic),
        body(2, Some(1), Joint::Revolute),
        body(3, Some(0), Joint::Revolute),
    ];
    let mut tree = Tree::new(bodies.to_vec()).unwrap();
    tree.gravity = Vector3::new(1.0, -2.0, -9.0);
    tree
}
