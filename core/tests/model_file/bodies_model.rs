//! The model file of bodies: a valid file loads, and everything else is a typed error.

use crate::common::bodies::{Bodies, body};
use crate::common::crane::{self, CRANE, DAMPING, FRICTION, GRAVITY, HEADER, NUMBERS, weights};
use crate::common::file::{self, Aligned};
use crate::common::{assert_close, assert_vectors_close};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, Joint, TreeBody, TreeError};
use leastaction_core::forces::{Coulomb, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    BodiesHeader, BodiesModel, FORMAT_VERSION, Family, Header, InertiaNetworkModel, ModelError, Section,
    parse,
};
use leastaction_core::scalar::{Weights, f16};
use proptest::prelude::*;

type Crane<'a> = BodiesModel<'a, 3>;

fn refusal(file: &[u8]) -> ModelError {
    Crane::load(Aligned::new(file).bytes()).map(|_| ()).expect_err("the file must be refused")
}

fn header_refusal(bodies: BodiesHeader<'static>) -> ModelError {
    let header = Header { family: Family::Bodies(bodies), ..HEADER };
    refusal(&file::write(header, &vec![0.5; bodies.parameters().map_or(32, |count| count + bodies.n())]))
}

#[test]
fn a_valid_file_loads_and_is_what_was_written() {
    let file = Aligned::new(&crane::golden());
    let parsed = parse(file.bytes()).unwrap();
    assert_eq!(parsed.header, HEADER);
    let Weights::Single(found) = parsed.weights else { panic!("single precision") };
    assert_eq!(found, weights(NUMBERS));
    let model = Crane::load(file.bytes()).unwrap();
    assert_eq!(model.trained_step, parsed.header.trained_step);
    assert_eq!(model.system.forces.coefficients, DAMPING);
    let bodies = &model.system.lagrangian;
    assert_eq!((bodies.gravity, bodies.numbers), (&GRAVITY, &NUMBERS));
    assert!(file.bytes().as_ptr_range().contains(&bodies.numbers.as_ptr().cast()), "borrowed in place");
}

#[test]
fn a_loaded_tree_is_the_one_of_its_weights() {
    let file = Aligned::new(&crane::golden());
    let numbers = [&GRAVITY, NUMBERS.as_flattened()].concat();
    let bodies =
        [body(Joint::Prismatic, None), body(Joint::Revolute, Some(0)), body(Joint::Prismatic, Some(1))];
    let twin = Bodies { bodies, weights: numbers.into_iter().map(f64::from).collect() };
    let model = Crane::load(file.bytes()).unwrap();
    for (q, v) in [([0.3_f32, 1.25, 0.75], [0.5_f32, -2.0, 1.0]), ([-1.5, -3.0, 2.0], [0.0, 1.0, 0.25])] {
        let (found, in_f64) = (model.system.lagrangian.energies(&q, &v), twin.in_f64());
        let expected = in_f64.energies(&q.map(f64::from), &v.map(f64::from));
        assert_close("T", found.kinetic.into(), expected.kinetic, 3e-6);
        assert_close("V", found.potential.into(), expected.potential, 3e-6);
        assert!(acceleration(&model.system, &q, &v, &[1.0, 0.0, 0.5]).unwrap().iter().all(|a| a.is_finite()));
    }
}

#[test]
fn bodies_in_half_precision_are_the_same_bodies() {
    // All numbers of the crane are exact in half precision.
    let half = Aligned::new(&file::write_half(HEADER, &weights(NUMBERS)));
    let single = Aligned::new(&crane::golden());
    let (half, single) =
        (BodiesModel::<3, f16>::load(half.bytes()).unwrap(), Crane::load(single.bytes()).unwrap());
    let (q, v, u) = ([0.5, 0.25, -0.5], [1.0, -1.0, 2.0], [0.0; 3]);
    assert_eq!(acceleration(&half.system, &q, &v, &u), acceleration(&single.system, &q, &v, &u));
}

/// A coordinate is a group of its own for every law.
#[test]
fn laws_have_numbers_for_every_body() {
    type Dry<'a> = BodiesModel<'a, 3, f32, (Viscous<f32, 3>, Coulomb<f32, 3>)>;
    let file = Aligned::new(&crane::with_friction());
    let (viscous, dry) = Dry::load(file.bytes()).unwrap().system.forces;
    assert_eq!(viscous.coefficients, DAMPING);
    let found = dry.coordinates.map(|dry| [dry.constant, dry.load, dry.smoothing, dry.width]);
    for (found, expected) in found.iter().zip(&FRICTION) {
        assert_vectors_close("friction", &found.map(f64::from), &expected.map(f64::from), 0.0);
    }
    assert_eq!(Crane::load(file.bytes()).unwrap_err(), ModelError::Law { number: 1 });
}

#[test]
fn every_truncation_and_every_change_of_a_byte_is_an_error() {
    file::assert_truncations_are_refused(&crane::golden());
    file::assert_changes_are_refused(&crane::golden());
}

#[test]
fn families_are_not_mistaken_for_each_other() {
    let (inertia_network, bodies) = (file::golden(), Aligned::new(&crane::golden()));
    assert_eq!(refusal(&inertia_network), ModelError::OtherFamily { found: "inertia-network" });
    let error = InertiaNetworkModel::<2, 8, 2>::load(bodies.bytes()).unwrap_err();
    assert_eq!(error, ModelError::OtherFamily { found: "bodies" });
}

#[test]
fn the_tree_must_be_one_of_the_compiled_bodies() {
    let file = Aligned::new(&crane::golden());
    let error = BodiesModel::<2>::load(file.bytes()).unwrap_err();
    assert_eq!(error, ModelError::Tree(TreeError::Coordinates { found: 3, compiled: 2 }));
    let cases = [
        (&[0, 0, 1, 3, 0, 2][..], TreeError::Parent { element: 1, parent: 2 }),
        (&[0, 1, 1, 0, 0, 2], TreeError::Parent { element: 0, parent: 0 }),
        (&[0, 0, 1, 1, 0, 255], TreeError::Parent { element: 2, parent: 254 }),
        (&[], TreeError::Empty),
    ];
    for (bodies, error) in cases {
        assert_eq!(header_refusal(BodiesHeader::planar(bodies)), ModelError::Tree(error), "{bodies:?}");
    }
}

#[test]
fn the_shape_is_in_range() {
    static LONG: [u8; 130] = [0; 130];
    let planar = BodiesHeader::planar;
    let cases = [
        (planar(&[0, 0, 2, 1, 0, 2]), "joint of a body"),
        (planar(&[0, 0, 1]), "length of a tree"),
        (planar(&LONG), "number of coordinates of a tree"),
        (BodiesHeader { dimensions: 3, ..CRANE }, "dimensions of the space of bodies"),
        (BodiesHeader { dimensions: 0, ..CRANE }, "dimensions of the space of bodies"),
    ];
    for (header, what) in cases {
        assert_eq!(header_refusal(header), ModelError::OutOfRange { what });
    }
    let most = ModelError::Tree(TreeError::Coordinates { found: 64, compiled: 3 });
    assert_eq!(header_refusal(planar(&LONG[..128])), most);
}

#[test]
fn numbers_of_a_body_are_in_range() {
    let with = |body: usize, number: usize, value| {
        let mut numbers = NUMBERS;
        numbers[body][number] = value;
        file::write(HEADER, &weights(numbers))
    };
    let cases = [
        (3, 0.0, "mass of a body"),
        (3, -1.0, "mass of a body"),
        (6, 0.0, "moment of inertia of a body"),
        (6, -0.1, "moment of inertia of a body"),
        (7, -0.1, "inertia of a rotor"),
    ];
    for body in 0..3 {
        for (number, value, what) in cases {
            assert_eq!(refusal(&with(body, number, value)), ModelError::OutOfRange { what });
        }
        for number in 0..BODY_PARAMETERS {
            let error = refusal(&with(body, number, f32::NAN));
            assert_eq!(error, ModelError::NotFinite { index: 2 + body * BODY_PARAMETERS + number });
        }
    }
    let error = refusal(&file::write(HEADER, &weights(NUMBERS)[1..]));
    assert_eq!(error, ModelError::WeightCount { found: 31, needed: 32 });
}

#[test]
fn a_body_is_two_bytes() {
    for joint in [Joint::Revolute, Joint::Prismatic] {
        for parent in [None, Some(0), Some(3), Some(254)] {
            let body = TreeBody { joint, parent };
            assert_eq!(TreeBody::from_bytes(body.to_bytes().unwrap()), Some(body));
        }
        assert_eq!(TreeBody { joint, parent: Some(255) }.to_bytes(), None);
    }
    assert_eq!(TreeBody::from_bytes([2, 0]), None);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// Random bytes behind a valid beginning and before a valid checksum, so that they reach the decoder.
    #[test]
    fn random_headers_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..40)) {
        let energies = file::section_of(Section::Energies, &[&[3], &bytes[..]].concat());
        let file = file::with_checksum(&[&b"LACT"[..], &[FORMAT_VERSION], &energies[..]].concat());
        let _ = parse(Aligned::new(&file).bytes());
    }

    /// Several bytes of a valid file changed and the checksum corrected: whatever loads can be evaluated.
    #[test]
    fn changes_under_a_right_checksum_never_panic(changes in prop::collection::vec((5usize..170, 0u8..12), 1..4)) {
        let file = crane::golden();
        let mut body = file[..file.len() - 4].to_vec();
        for (position, value) in changes {
            body[position] = value;
        }
        let file = Aligned::new(&file::with_checksum(&body));
        if let Ok(model) = Crane::load(file.bytes()) {
            let _ = acceleration(&model.system, &[0.2; 3], &[0.4; 3], &[0.5; 3]);
        }
    }

    /// Any two bytes per body: they are a tree if every parent comes first, and an error otherwise.
    #[test]
    fn random_trees_load_or_are_refused(bodies in prop::collection::vec((0u8..4, 0u8..4), 3)) {
        let bytes: Vec<u8> = bodies.iter().flat_map(|(joint, parent)| [*joint, *parent]).collect();
        let header = Header { family: Family::Bodies(BodiesHeader::planar(&bytes)), ..HEADER };
        let valid = bodies.iter().zip(0u8..).all(|((joint, parent), e)| *joint < 2 && *parent <= e);
        let file = Aligned::new(&file::write(header, &weights(NUMBERS)));
        prop_assert_eq!(Crane::load(file.bytes()).is_ok(), valid);
    }
}
