//! Trees of random bodies.

use leastaction_models::tree::{Body, Inertia, Joint, Limits, Pose, Tree};
use nalgebra::{Matrix3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A branching tree of five bodies on revolute and prismatic joints with arbitrary axes, with rotors and an arbitrary direction of gravity.
/// One joint follows another: 5 bodies, 4 coordinates.
pub fn tree(seed: u64) -> Tree {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut number = move |size: f64| random.random_range(-size..size);
    let mut bodies = Vec::new();
    for (i, parent) in [None, Some(0), Some(1), Some(0), Some(3)].into_iter().enumerate() {
        let axis = Unit::new_normalize(Vector3::new(number(1.0), number(1.0), 1.1 + number(1.0)));
        let joint = if i == 2 { Joint::Prismatic(axis) } else { Joint::Revolute(axis) };
        let pose = Pose::of_rpy([0; 3].map(|_| number(0.5)), [0; 3].map(|_| number(3.0)));
        let centre = Vector3::from([0; 3].map(|_| number(0.2)));
        let root = Matrix3::from_fn(|_, _| number(0.2));
        let second = root * root.transpose() + Matrix3::identity() * 1e-3;
        let inertia =
            Inertia::of_centre(1.5 + number(1.0), centre, Matrix3::identity() * second.trace() - second);
        let (coordinate, ratio, offset) = if i == 4 { (1, -0.7, 0.3) } else { (i, 1.0, 0.0) };
        let (name, joint_name) = (format!("link{i}"), format!("joint{i}"));
        let limits = Limits::none();
        bodies.push(Body {
            name,
            joint_name,
            parent,
            joint,
            pose,
            coordinate,
            ratio,
            offset,
            inertia,
            limits,
        });
    }
    let mut tree = Tree::new(bodies).unwrap();
    tree.rotors = vec![0.1, 0.2, 0.3, 0.4];
    tree.gravity = Vector3::new(1.0, -2.0, -9.0);
    tree
}
