//! The model file of arms: a valid file loads, and everything else is a typed error.

use crate::common::arms::{self, Arm};
use crate::common::file::{self, Aligned};
use crate::common::{assert_vectors_close, bodies::body};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::energy::arm::{ARM_PARAMETERS, Joint};
use leastaction_core::energy::modular::TreeError;
use leastaction_core::forces::{Coulomb, Viscous};
use leastaction_core::model::{ArmHeader, ArmModel, BodiesModel, Family, Header, Laws, ModelError, parse};
use leastaction_core::scalar::{Weights, f16};
use proptest::prelude::*;

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
            weights[3 + body * ARM_PARAMETERS + number] = value;
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

/// Arms of the other tests load too: arbitrary frames that are orthonormal in f64 are orthonormal enough in f32.
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

/// Two bytes for each body of a tree, as they may stand in a file; most are valid.
fn tree_bytes() -> impl Strategy<Value = Vec<u8>> {
    let body = |index: usize| (0..=2_u8, 0..=index as u8 + 1);
    let bodies = (0..=6_usize).prop_flat_map(move |n| (0..n).map(body).collect::<Vec<_>>());
    (bodies, any::<bool>()).prop_map(|(bodies, odd)| {
        let bytes = bodies.into_iter().flat_map(|(joint, parent)| [joint, parent]);
        bytes.chain(odd.then_some(0)).collect()
    })
}

/// Whether bytes are a tree as the format page defines it: revolute or prismatic joints, each on the ground or on an
/// earlier body.
fn is_tree(bytes: &[u8]) -> bool {
    let (bodies, rest) = bytes.as_chunks::<2>();
    let fits = |(index, [joint, parent]): (usize, &[u8; 2])| *joint <= 1 && usize::from(*parent) <= index;
    rest.is_empty() && !bodies.is_empty() && bodies.iter().enumerate().all(fits)
}

/// The weights for a number of bodies, each the same as in the test's tree, and as many dampers.
fn weights_of(bodies: usize) -> Vec<f32> {
    let (gravity, body) = (&weights()[..3], &weights()[3..3 + ARM_PARAMETERS]);
    [gravity, &body.repeat(bodies), &vec![0.25; bodies]].concat()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn a_header_is_read_as_it_was_written_or_refused(bytes in tree_bytes()) {
        let header = Header { family: Family::Arm(ArmHeader { bodies: &bytes }), ..HEADER };
        let file = Aligned::new(&file::write(header, &weights_of(bytes.len() / 2)));
        match parse(file.bytes()) {
            Ok(parsed) => {
                prop_assert!(is_tree(&bytes), "{bytes:?} is no tree");
                prop_assert_eq!(parsed.header, header);
            }
            Err(error) => prop_assert!(!is_tree(&bytes), "{bytes:?}: {error}"),
        }
    }

    #[test]
    fn only_a_tree_of_the_compiled_size_loads(bytes in tree_bytes()) {
        let header = Header { family: Family::Arm(ArmHeader { bodies: &bytes }), ..HEADER };
        let file = Aligned::new(&file::write(header, &weights_of(bytes.len() / 2)));
        match ArmModel::<3>::load(file.bytes()) {
            Ok(model) => {
                prop_assert!(is_tree(&bytes) && bytes.len() == 6);
                let found = model.system.lagrangian.tree.bodies().map(|body| body.to_bytes().unwrap());
                prop_assert_eq!(found.as_flattened(), &bytes[..]);
            }
            Err(error) => prop_assert!(!is_tree(&bytes) || bytes.len() != 6, "{bytes:?}: {error}"),
        }
    }

    /// Any value among a body's numbers is either refused or gives an arm that moves; nothing panics.
    #[test]
    fn any_number_is_refused_or_evaluated(at in 0_usize..3 + 3 * ARM_PARAMETERS, bits in any::<u32>()) {
        let mut weights = weights();
        weights[at] = f32::from_bits(bits);
        let file = Aligned::new(&file::write(HEADER, &weights));
        if let Ok(model) = ArmModel::<3>::load(file.bytes()) {
            prop_assert!(weights[at].is_finite());
            let _ = acceleration(&model.system, &[0.3; 3], &[0.2; 3], &[0.0; 3]);
        }
    }
}
