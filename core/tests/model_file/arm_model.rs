//! The model file of arms: what is right loads, and everything else is a typed error.

use crate::common::arms::{self, Arm};
use crate::common::file::{self, Aligned};
use crate::common::{assert_vectors_close, bodies::body};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::energy::modular::TreeError;
use leastaction_core::energy::spatial::{Joint, SPATIAL_PARAMETERS};
use leastaction_core::forces::{Coulomb, Viscous};
use leastaction_core::model::{ArmHeader, ArmModel, BodiesModel, Family, Header, Laws, ModelError, parse};
use leastaction_core::scalar::{Weights, f16};

const TREE: ArmHeader<'static> = ArmHeader { bodies: &[1, 0, 0, 1, 0, 1] };
const HEADER: Header<'static> = Header { family: Family::Arm(TREE), ..file::HEADER };
const DAMPING: [f32; 3] = [0.5, 0.125, 0.0];

fn arm() -> Arm<3> {
    let on = |joint| body(joint, Some(0));
    Arm::random([body(Joint::Prismatic, None), on(Joint::Revolute), on(Joint::Revolute)], 60)
}

fn weights() -> Vec<f32> {
    [arm().single(), DAMPING.to_vec()].concat()
}

fn valid() -> Vec<u8> {
    file::write(HEADER, &weights())
}

fn refusal(file: &[u8]) -> ModelError {
    ArmModel::<3>::load(Aligned::new(file).bytes()).map(|_| ()).expect_err("the file must be refused")
}

fn header_refusal(bodies: &'static [u8]) -> ModelError {
    let header = Header { family: Family::Arm(ArmHeader { bodies }), ..HEADER };
    refusal(&file::write(header, &weights()))
}

#[test]
fn a_valid_file_loads_in_place_and_is_what_was_written() {
    let file = Aligned::new(&valid());
    let parsed = parse(file.bytes()).unwrap();
    assert_eq!(parsed.header, HEADER);
    let Weights::Single(found) = parsed.weights else { panic!("single precision") };
    assert_eq!(found, weights());
    let model = ArmModel::<3>::load(file.bytes()).unwrap();
    let bodies = &model.system.lagrangian;
    assert_eq!((bodies.tree, model.system.forces.coefficients), (arm().tree(), DAMPING));
    assert_eq!([bodies.gravity, bodies.numbers.as_flattened()].concat(), arm().single());
    assert!(file.bytes().as_ptr_range().contains(&bodies.numbers.as_ptr().cast()), "borrowed in place");
}

#[test]
fn friction_acts_on_a_loaded_arm() {
    type Dry<'a> = ArmModel<'a, 3, f32, (Viscous<f32, 3>, Coulomb<f32, 3>)>;
    let dry = [[0.5, 0.25, 0.75, 0.0625], [0.125, 0.0, 1.0, 0.125], [0.0, 0.5, 0.25, 0.5]];
    let header = Header { laws: Laws::FRICTION, ..HEADER };
    let file = Aligned::new(&file::write(header, &[&weights(), dry.as_flattened()].concat()));
    assert_eq!(ArmModel::<3>::load(file.bytes()).unwrap_err(), ModelError::Law { number: 1 });
    let system = Dry::load(file.bytes()).unwrap().system;
    let (q, v, tau) = ([0.2, -0.7, 1.1], [0.4, 0.9, -1.3], [3.0, -2.0, 1.0]);
    let a = acceleration(&system, &q, &v, &tau).unwrap();
    let found = inverse_dynamics(&system, &q, &v, &a).unwrap();
    assert_vectors_close("τ", &found.map(f64::from), &tau.map(f64::from), 2e-5);
}

/// Rounding to half precision leaves frames that are orthonormal to 4e-3, which is enough to load them.
#[test]
fn half_precision_loads() {
    let file = Aligned::new(&file::write_half(HEADER, &weights()));
    let model = ArmModel::<3, f16>::load(file.bytes()).unwrap();
    assert!(
        acceleration(&model.system, &[0.3; 3], &[0.2; 3], &[0.0; 3]).unwrap().iter().all(|a| a.is_finite())
    );
}

#[test]
fn every_truncation_and_every_change_of_a_byte_is_an_error() {
    file::assert_truncations_are_refused(&valid());
    file::assert_changes_are_refused(&valid());
}

#[test]
fn the_tree_must_be_one_of_the_compiled_bodies() {
    let file = Aligned::new(&valid());
    let error = ArmModel::<2>::load(file.bytes()).unwrap_err();
    assert_eq!(error, ModelError::Tree(TreeError::Coordinates { found: 3, compiled: 2 }));
    assert_eq!(BodiesModel::<3>::load(file.bytes()).unwrap_err(), ModelError::OtherFamily { found: "arm" });
    let cycle = TreeError::Parent { element: 1, parent: 2 };
    assert_eq!(header_refusal(&[0, 0, 1, 3, 0, 2]), ModelError::Tree(cycle));
    assert_eq!(header_refusal(&[0, 0, 2, 1, 0, 2]), ModelError::OutOfRange { what: "joint of a body" });
}

#[test]
fn numbers_of_a_body_are_in_range() {
    let cases = [
        (0, 0.3, "rotation of a joint's frame"),
        (8, -2.0, "rotation of a joint's frame"),
        (13, 1.5, "axis of a joint"),
        (15, -1.0, "mass of a body"),
        (19, -0.1, "moment of inertia of a body"),
        (21, -0.1, "moment of inertia of a body"),
        (24, -0.1, "moment of inertia of a body"),
        (25, -0.1, "inertia of a rotor"),
    ];
    for body in 0..3 {
        for (number, value, what) in cases {
            let mut weights = weights();
            weights[3 + body * SPATIAL_PARAMETERS + number] = value;
            assert_eq!(refusal(&file::write(HEADER, &weights)), ModelError::OutOfRange { what });
        }
    }
    // A reflection is orthonormal, but no rotation.
    let mut mirrored = weights();
    mirrored[3..6].iter_mut().for_each(|entry| *entry = -*entry);
    let error = ModelError::OutOfRange { what: "rotation of a joint's frame" };
    assert_eq!(refusal(&file::write(HEADER, &mirrored)), error);
    assert_eq!(
        refusal(&file::write(HEADER, &weights()[1..])),
        ModelError::WeightCount { found: 83, needed: 84 }
    );
}

/// Arms of the other tests load too: whatever stands askew in f64 is orthonormal enough in f32.
#[test]
fn an_arm_of_seven_joints_loads() {
    let header = Header {
        family: Family::Arm(ArmHeader { bodies: &[0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6] }),
        laws: Laws::NONE,
        ..Header::new(Family::Arm(TREE))
    };
    let file = Aligned::new(&file::write(header, &arms::chain_of_seven().single()));
    assert_eq!(
        ArmModel::<7>::load(file.bytes()).unwrap().system.lagrangian.tree,
        arms::chain_of_seven().tree()
    );
}
