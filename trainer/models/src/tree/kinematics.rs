//! Forward kinematics.

use super::{Pose, Tree};

impl Tree {
    /// Poses of all bodies' frames in the frame of the base, at the position q.
    ///
    /// # Panics
    /// If the length of q differs from the number of coordinates.
    #[must_use]
    pub fn poses(&self, q: &[f64]) -> Vec<Pose> {
        assert_eq!(q.len(), self.coordinates(), "a position of another number of coordinates");
        let mut poses: Vec<Pose> = Vec::with_capacity(self.bodies().len());
        for body in self.bodies() {
            let frame = body.parent.map_or(body.pose, |parent| poses[parent].then(&body.pose));
            poses.push(frame.then(&body.joint.pose(body.ratio * q[body.coordinate] + body.offset)));
        }
        poses
    }
}

#[cfg(test)]
mod tests {
    use crate::bodies::space::ArmArchitecture;
    use crate::number::Number;
    use crate::tree::{Body, Pose, Tree, branched};

    /// Potential energy of the bodies where the poses place them.
    fn potential(tree: &Tree, q: &[f64]) -> f64 {
        let each = tree.bodies().iter().zip(tree.poses(q));
        let of = |(body, pose): (&Body, Pose)| {
            let (mass, moment) = (body.inertia.mass(), body.inertia.moment());
            -tree.gravity.dot(&(pose.translation * mass + pose.rotation * moment))
        };
        each.map(of).sum()
    }

    #[test]
    fn forces_at_rest_are_slopes_of_the_potential_energy_of_the_poses() {
        let (tree, q, rest, h) = (branched(), [0.4, -0.7, 1.9, -2.3], [0.0; 4], 1e-6);
        let forces = tree.inverse_dynamics(&q, &rest, &rest);
        for (k, force) in forces.iter().enumerate() {
            let at = |h: f64| {
                potential(&tree, &std::array::from_fn::<_, 4, _>(|i| q[i] + if i == k { h } else { 0.0 }))
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            assert!(force.abs() > 0.1 && (slope - force).abs() < 1e-7, "{k}: {slope} {force}");
        }
        assert!((potential(&tree, &q) - tree.energies(&q, &rest)[1]).abs() < 1e-12);
    }

    #[test]
    fn a_model_file_keeps_the_poses() {
        let (tree, q) = (branched(), [0.4, -0.7, 1.9, -2.3]);
        let arm = ArmArchitecture::new(&tree, |_| false, |_| Number::known(0.0)).unwrap();
        let weights = crate::family::Family::initial_weights(&arm, 0);
        let read = arm.host_tree(&weights).unwrap();
        for (own, other) in read.poses(&q).iter().zip(tree.poses(&q)) {
            assert!((own.translation - other.translation).amax() < 1e-12);
            assert!((own.rotation - other.rotation).amax() < 1e-12);
        }
    }
}
