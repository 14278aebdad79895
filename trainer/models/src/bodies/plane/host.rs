//! The tree of a planar model in space.

use super::BodiesArchitecture;
use crate::tree::{Body, Inertia, Joint as HostJoint, Limits, Pose, Tree};
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, Joint, TreeBody,
};
use nalgebra::{Matrix3, Vector3};

impl BodiesArchitecture {
    /// Returns the tree of this shape in the plane of x and y, with the numbers of a weight block. Rotors are left out: a [`Tree`] has none
    /// with gears. `None` if the block is too short.
    pub fn host_tree(&self, weights: &[f64]) -> Option<Tree> {
        let (gravity, numbers) = weights.split_at_checked(GRAVITY_PARAMETERS)?;
        let numbers = numbers.as_chunks::<BODY_PARAMETERS>().0;
        let each = self.bodies().enumerate();
        let bodies =
            each.map(|(k, body)| Some(host_body(k, body, BodyParameters::from_array(*numbers.get(k)?))));
        let mut tree = Tree::new(bodies.collect::<Option<_>>()?).ok()?;
        tree.gravity = Vector3::new(gravity[0], gravity[1], 0.0);
        Some(tree)
    }
}

fn host_body(k: usize, body: TreeBody, numbers: BodyParameters<f64>) -> Body {
    let ([x, y], [centre_x, centre_y]) = (numbers.place, numbers.centre);
    let about_z = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, numbers.inertia));
    Body {
        name: format!("body {k}"),
        joint_name: String::new(),
        parent: body.parent.map(usize::from),
        joint: match body.joint {
            Joint::Revolute => HostJoint::Revolute(Vector3::z_axis()),
            Joint::Prismatic => HostJoint::Prismatic(Vector3::x_axis()),
        },
        pose: Pose::of_rpy([x, y, 0.0], [0.0, 0.0, numbers.angle]),
        coordinate: k,
        ratio: 1.0,
        offset: 0.0,
        inertia: Inertia::of_centre(numbers.mass, Vector3::new(centre_x, centre_y, 0.0), about_z),
        limits: Limits::none(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use crate::number::Number;

    #[test]
    fn forces_in_space_are_those_in_the_plane() {
        let gravity = [1.0, -9.0].map(Number::known);
        let numbers = |k: f64| [0.3, 0.1 * k, 0.4 - k, 1.0 + k, 0.2, -0.1, 0.05, 0.0, 1.0].map(Number::known);
        let kinds = [(Joint::Prismatic, None), (Joint::Revolute, Some(0)), (Joint::Revolute, Some(1))];
        let bodies = kinds
            .into_iter()
            .zip([0.0, 1.0, 2.0])
            .map(|((joint, parent), k)| (TreeBody { joint, parent }, BodyParameters::from_array(numbers(k))));
        let shape = BodiesArchitecture::new(gravity, bodies).unwrap();
        let weights: Vec<f64> = shape.all_numbers().map(|number| number.value).collect();
        let tree = shape.host_tree(&weights).unwrap();
        assert!(shape.host_tree(&weights[..weights.len() - 1]).is_none());
        let (q, v, a) = ([0.7, -0.8, 2.1], [0.3, -1.1, 0.6], [-0.5, 0.9, 1.3]);
        let model = Model::new(shape, weights);
        let planar = model.inverse_dynamics([&q, &v, &a]).unwrap();
        for (planar, spatial) in planar.iter().zip(tree.inverse_dynamics(&q, &v, &a)) {
            assert!(spatial.abs() > 0.1 && (planar - spatial).abs() < 1e-9, "{planar} {spatial}");
        }
    }
}
