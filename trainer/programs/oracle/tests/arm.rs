//! Comparison of arms with the recursions of core, and with differences.

mod common;

use common::Numbers;
use leastaction_core::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies, ArmParameters, BodyTree, Joint, TreeBody, TreeError,
};
use leastaction_core::forces;
use leastaction_programs::System;
use leastaction_programs::energies::{ArmEnergies, ArmJoint};

const fn body(joint: Joint, parent: Option<u8>) -> TreeBody {
    TreeBody { joint, parent }
}

/// Two branches, one of which has a prismatic joint.
const BRANCHED: [TreeBody; 5] = [
    body(Joint::Revolute, None),
    body(Joint::Revolute, Some(0)),
    body(Joint::Prismatic, Some(1)),
    body(Joint::Revolute, Some(2)),
    body(Joint::Revolute, Some(0)),
];

type Vector = [f64; 3];

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Vector) -> Vector {
    let norm = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / norm)
}

/// Random numbers, but frames are rotations, axes are unit vectors, and masses and inertias make M positive definite.
fn weights(bodies: usize, seed: u64) -> Vec<f64> {
    let mut weights = common::random_weights(ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * bodies, seed);
    for own in weights[ARM_GRAVITY_PARAMETERS..].as_chunks_mut::<ARM_PARAMETERS>().0 {
        let mut body = ArmParameters::from_array(*own);
        let [x, y, _] = body.rotation;
        let x = unit(x);
        let z = unit(cross(x, y));
        body.rotation = [x, cross(z, x), z];
        body.axis = unit(body.axis);
        *own = body.into_array();
        for (place, more) in [(15, 3.0), (19, 4.0), (21, 5.0), (24, 6.0), (25, 1.0)] {
            own[place] += more;
        }
    }
    weights
}

fn model(tree: &[TreeBody], weights: &[f64]) -> ArmEnergies {
    let numbers = weights[ARM_GRAVITY_PARAMETERS..].as_chunks::<ARM_PARAMETERS>().0;
    let joint = |(body, own): (&TreeBody, &[f64; ARM_PARAMETERS])| {
        let ArmParameters { rotation, place, axis, .. } = ArmParameters::from_array(*own);
        ArmJoint { body: *body, rotation, place, axis }
    };
    ArmEnergies::new(tree.iter().zip(numbers).map(joint).collect()).unwrap()
}

fn check_against_core<const N: usize>(tree: [TreeBody; N], seed: u64) {
    let numbers = Numbers::<N>::new(weights(N, seed), 2.0, seed);
    let bodies = ArmBodies::take(&mut &numbers.weights[..], BodyTree::new(tree).unwrap()).unwrap();
    let core = forces::System::conservative(bodies);
    common::check_values(&System::new(&model(&tree, &numbers.weights)), &core, &numbers, 10.0);
}

#[test]
fn values_and_derivatives_are_cores() {
    check_against_core([BRANCHED[0]], 1);
    check_against_core([body(Joint::Prismatic, None), BRANCHED[1]], 2);
    check_against_core(BRANCHED, 3);
}

/// Checks the rows ∂/∂θ y·(L_q − L_vq v − M a) of the numbers that can be learned against differences, for each number.
#[test]
fn gradients_are_the_differences_of_the_equation_of_motion() {
    const N: usize = BRANCHED.len();
    let weights = weights(N, 4);
    let is_of_body = |at: usize| {
        let place = at.checked_sub(ARM_GRAVITY_PARAMETERS).map(|place| place % ARM_PARAMETERS);
        place.is_none_or(|place| place >= 15)
    };
    // The numbers of the frames are not read from the weights.
    let system = System::new(&model(&BRANCHED, &weights));
    common::check_gradients_of_motion::<N>((&system, &weights), 4, is_of_body);
}

#[test]
fn what_is_no_tree_is_refused() {
    let joint = ArmJoint { body: BRANCHED[1], rotation: [[0.0; 3]; 3], place: [0.0; 3], axis: [0.0; 3] };
    assert_eq!(ArmEnergies::new(Vec::new()), Err(TreeError::Empty));
    assert_eq!(ArmEnergies::new(vec![joint]), Err(TreeError::Parent { element: 0, parent: 0 }));
}
