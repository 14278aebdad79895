//! The model file: a valid file loads, and everything else is a typed error.

use crate::common::assert_close;
use crate::common::file::{self, Aligned, CARTPOLE, HEADER};
use crate::common::oracle::Learned;
use crate::common::shapes::{Angle, Model, Translation};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    CATALOGUE, FORMAT_VERSION, Family, Header, InertiaNetworkHeader, InertiaNetworkModel, Law, Laws,
    ModelError, Section, parse, parse_as,
};
use leastaction_core::network::Activation;
use leastaction_core::scalar::Weights;
use proptest::prelude::*;

/// The error of loading as the golden cart-pole.
fn load_error(bytes: &[u8]) -> ModelError {
    let aligned = Aligned::new(bytes);
    let loaded = InertiaNetworkModel::<2, 8, 2>::load(aligned.bytes());
    loaded.map(|_| ()).expect_err("the file must be refused")
}

fn with_family(inertia_network: InertiaNetworkHeader<'static>) -> Header<'static> {
    Header { family: Family::InertiaNetwork(inertia_network), ..HEADER }
}

#[test]
fn a_valid_file_loads_and_is_what_was_written() {
    let file = Aligned::new(&file::golden());
    let parsed = parse(file.bytes()).unwrap();
    assert_eq!(parsed.header, HEADER);
    assert_eq!(parsed.weights, Weights::Single(&file::weights(&CARTPOLE)));
    assert_eq!((parsed.weights.bits(), parsed.weights.len()), (32, file::weights(&CARTPOLE).len()));
    let model = InertiaNetworkModel::<2, 8, 2>::load(file.bytes()).unwrap();
    assert_eq!((model.trained_step, model.step()), (HEADER.trained_step, Ok(file::STEP)));
    assert_eq!(model.system.forces.coefficients, [0.125; 2]);
    assert_eq!(model.system.lagrangian.coordinates(), &[Translation, Angle]);
    // Borrowed in place.
    let range = file.bytes().as_ptr_range();
    let Weights::Single(weights) = parsed.weights else { panic!("single precision") };
    assert!(range.contains(&weights.as_ptr().cast()));
}

#[test]
fn a_loaded_model_is_the_network_of_its_weights() {
    let file = Aligned::new(&file::golden());
    let model = InertiaNetworkModel::<2, 8, 2>::load(file.bytes()).unwrap();
    let weights: Vec<f64> = file::weights(&CARTPOLE).into_iter().map(f64::from).collect();
    let twin = Model::<2> {
        coordinates: [Translation, Angle],
        widths: vec![7, 5],
        activation: Activation::Tanh,
        inertia: Inertia::Cholesky { epsilon: 1e-3 },
        weights: weights[..weights.len() - 2].to_vec(),
    };
    for (q, v) in [([0.3_f32, 1.25], [0.5_f32, -2.0]), ([-1.5, -3.0], [0.0, 1.0])] {
        let found = model.system.lagrangian.energies(&q, &v);
        let (kinetic, potential) = twin.naive_energies(&q.map(f64::from), &v.map(f64::from));
        assert_close("T", found.kinetic.into(), kinetic, 3e-6);
        assert_close("V", found.potential.into(), potential, 3e-6);
        assert!(acceleration(&model.system, &q, &v, &[1.0, 0.0]).unwrap().iter().all(|a| a.is_finite()));
    }
}

#[test]
fn headers_without_options_load_too() {
    let inertia_network = InertiaNetworkHeader {
        coordinates: "a",
        widths: [6, 0, 0, 0],
        activation: Activation::Isru,
        inertia: Inertia::Diagonal,
    };
    for provenance in ["", "a", "ab", "abc"] {
        let header = Header { provenance, ..Header::new(Family::InertiaNetwork(inertia_network)) };
        let weights = file::weights(&inertia_network);
        let (_, undamped) = weights.split_last().unwrap();
        let file = Aligned::new(&file::write(header, &weights[..undamped.len()]));
        let model = InertiaNetworkModel::<1, 6, 1>::load(file.bytes()).unwrap();
        assert_eq!((model.trained_step, model.system.forces.coefficients), (None, [0.0]));
        assert_eq!(
            (model.step(), model.actuator(), model.range()),
            (Err(ModelError::NoStep), Ok(None), Ok(None))
        );
    }
}

#[test]
fn every_truncation_is_an_error() {
    file::assert_truncations_are_refused(&file::golden());
}

#[test]
fn every_change_of_a_byte_is_an_error() {
    file::assert_changes_are_refused(&file::golden());
}

#[test]
fn additional_bytes_are_an_error() {
    let file = file::golden();
    assert!(matches!(load_error(&[&file[..], &[0]].concat()), ModelError::Checksum { .. }));
    // The file is closed with a valid checksum, but the bytes after the last section are no section.
    let longer = file::with_checksum(&[&file[..file.len() - 4], &[200, 1, 0]].concat());
    assert_eq!(load_error(&longer), ModelError::Malformed);
    // Bytes after the shape, within its section.
    let [start, end] = file::place(&file, Section::Energies);
    let longer = file::with_section(&file, Section::Energies, &[&file[start..end], &[1, 2, 3]].concat());
    assert_eq!(load_error(&longer), ModelError::TrailingBytes { bytes: 3 });
}

#[test]
fn unaligned_bytes_are_an_error() {
    let file = file::golden();
    for shift in 1..4 {
        let shifted = Aligned::shifted(&file, shift);
        let error = parse(&shifted.bytes()[shift..]).unwrap_err();
        assert_eq!(error, ModelError::Unaligned { offset: shift as u8 });
    }
    // An aligned file whose padding is wrong.
    let bytes = file::weights(&CARTPOLE).iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    let wrong = (0..4).filter(|n| {
        let file = file::write_raw(HEADER, Some(&[0; 3][..*n.min(&3)]), &bytes);
        matches!(parse(Aligned::new(&file).bytes()), Err(ModelError::Unaligned { .. }))
    });
    assert!(wrong.count() >= 2);
}

#[test]
fn weights_must_be_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for index in [0, 13, 60] {
            let mut weights = file::weights(&CARTPOLE);
            weights[index] = bad;
            assert_eq!(load_error(&file::write(HEADER, &weights)), ModelError::NotFinite { index });
        }
    }
}

#[test]
fn weights_must_be_as_many_as_the_shape_says() {
    let weights = file::weights(&CARTPOLE);
    let needed = weights.len();
    assert_eq!(needed, 4 * 7 + 8 * 5 + 6 * 4 + 2);
    let error = load_error(&file::write(HEADER, &weights[1..]));
    assert_eq!(error, ModelError::WeightCount { found: needed - 1, needed });
    let error = load_error(&file::write(HEADER, &[&weights[..], &[0.0]].concat()));
    assert_eq!(error, ModelError::WeightCount { found: needed + 1, needed });
    let odd = weights.iter().flat_map(|w| w.to_le_bytes()).skip(1).collect::<Vec<u8>>();
    assert_eq!(load_error(&file::write_raw(HEADER, None, &odd)), ModelError::Malformed);
}

#[test]
fn a_factor_of_the_inertia_matrix_loads() {
    for rows in [2, 3] {
        let inertia_network =
            InertiaNetworkHeader { inertia: Inertia::Factor { rows, epsilon: 0.5 }, ..CARTPOLE };
        let file = Aligned::new(&file::write(with_family(inertia_network), &file::weights(&inertia_network)));
        assert_eq!(parse(file.bytes()).unwrap().header, with_family(inertia_network));
        let model = InertiaNetworkModel::<2, 8, 2>::load(file.bytes()).unwrap();
        let [[a, b], [c, d]] =
            Lagrangian::<f32, 2>::dynamics(&model.system.lagrangian, &[0.3, 0.8], &[1.0, 2.0]).mass;
        assert!(a >= 0.5 && d >= 0.5 && b == c && a * d > b * b, "{rows}: {a} {b} {c} {d}");
    }
}

#[test]
fn the_shape_must_be_the_compiled_one() {
    let file = Aligned::new(&file::golden());
    let shape = |what, found, compiled| Err(ModelError::Shape { what, found, compiled });
    let refused = |loaded: Result<(), ModelError>| loaded;
    assert_eq!(
        refused(InertiaNetworkModel::<1, 8, 2>::load(file.bytes()).map(|_| ())),
        shape("coordinates", 2, 1)
    );
    assert_eq!(
        refused(InertiaNetworkModel::<3, 8, 2>::load(file.bytes()).map(|_| ())),
        shape("coordinates", 2, 3)
    );
    assert_eq!(
        refused(InertiaNetworkModel::<2, 6, 2>::load(file.bytes()).map(|_| ())),
        shape("units in a hidden layer", 7, 6)
    );
    assert_eq!(
        refused(InertiaNetworkModel::<2, 8, 1>::load(file.bytes()).map(|_| ())),
        shape("hidden layers", 2, 1)
    );
}

#[test]
fn header_fields_out_of_range_are_errors() {
    let epsilon = |epsilon| InertiaNetworkHeader { inertia: Inertia::Cholesky { epsilon }, ..CARTPOLE };
    let rows = |rows| InertiaNetworkHeader { inertia: Inertia::Factor { rows, epsilon: 0.0 }, ..CARTPOLE };
    let cases = [
        (with_family(rows(1)), "rows of the inertia matrix"),
        (with_family(rows(4)), "rows of the inertia matrix"),
        (with_family(epsilon(-1e-3)), "epsilon of the inertia matrix"),
        (with_family(epsilon(f32::NAN)), "epsilon of the inertia matrix"),
        (with_family(InertiaNetworkHeader { coordinates: "", ..CARTPOLE }), "number of coordinates"),
        (
            with_family(InertiaNetworkHeader { coordinates: "aaaaaaaaaaaaaaaaa", ..CARTPOLE }),
            "number of coordinates",
        ),
    ];
    for (header, what) in cases {
        let file = file::write(header, &file::weights(&CARTPOLE));
        assert_eq!(load_error(&file), ModelError::OutOfRange { what }, "{header:?}");
    }
    // There are still three inputs and two letters, so that only the letters are wrong.
    for (coordinates, what) in [("xa", "coordinate kind"), ("é", "coordinate kind")] {
        let inertia_network = InertiaNetworkHeader { coordinates, ..CARTPOLE };
        let file = file::write(with_family(inertia_network), &file::weights(&inertia_network));
        assert_eq!(load_error(&file), ModelError::OutOfRange { what }, "{coordinates}");
    }
    let gap = InertiaNetworkHeader { widths: [7, 0, 5, 0], ..CARTPOLE };
    let file = file::write(with_family(gap), &file::weights(&gap));
    assert_eq!(load_error(&file), ModelError::OutOfRange { what: "hidden width" });
    let mut weights = file::weights(&CARTPOLE);
    *weights.last_mut().unwrap() = -0.5;
    let error = load_error(&file::write(HEADER, &weights));
    assert_eq!(error, ModelError::LawNumber { law: Law::Viscous, number: 0, group: 1, value: -0.5 });
}

#[test]
fn padding_is_at_most_three_zeros() {
    let weights = file::weights(&CARTPOLE);
    let bytes: Vec<u8> = weights.iter().flat_map(|w| w.to_le_bytes()).collect();
    let plain = file::golden();
    let right = (0..4).find(|n| file::write_raw(HEADER, Some(&[0; 4][..*n]), &bytes) == plain).unwrap();
    let longer = file::write_raw(HEADER, Some(&vec![0; right + 4]), &bytes);
    assert_eq!(load_error(&longer), ModelError::OutOfRange { what: "padding" });
    let filled = [1, 2, 3].map(|n| file::write_raw(HEADER, Some(&vec![7; n]), &bytes));
    for filled in filled {
        assert_eq!(load_error(&filled), ModelError::OutOfRange { what: "padding" });
    }
    let nothing = file::with_section(&plain, Section::Weights, &[]);
    assert_eq!(load_error(&nothing), ModelError::Malformed);
    let short = file::with_section(&plain, Section::Weights, &[3, 0, 0]);
    assert_eq!(load_error(&short), ModelError::Malformed);
}

#[test]
fn impossible_encodings_are_malformed() {
    let file = file::golden();
    let body = &file[..file.len() - 4];
    // Family 5; a coordinate string that is not UTF-8; activation 5; inertia 2.
    for (position, value) in [(10, 5), (12, 0xff), (18, 5), (19, 2)] {
        let mut changed = body.to_vec();
        changed[position] = value;
        assert_eq!(load_error(&file::with_checksum(&changed)), ModelError::Malformed, "byte {position}");
    }
}

/// A reader of one family does not decode the others: it holds no code for their shapes.
#[test]
fn other_families_are_refused_before_their_shape_is_decoded() {
    let file = file::golden();
    let mut changed = file[..file.len() - 4].to_vec();
    changed[10] = 1;
    let changed = file::with_checksum(&changed);
    assert_eq!(load_error(&changed), ModelError::OtherFamily { found: "modular" });
    assert_eq!(parse(Aligned::new(&changed).bytes()), Err(ModelError::Malformed));
}

#[test]
fn a_file_of_one_family_says_the_same_as_of_any() {
    let file = Aligned::new(&file::golden());
    let (any, one) =
        (parse(file.bytes()).unwrap(), parse_as::<InertiaNetworkHeader, f32>(file.bytes()).unwrap());
    assert_eq!(any.header.family, Family::InertiaNetwork(one.shape));
    assert_eq!(any.header.trained_step, one.trained_step);
    assert_eq!((any.header.laws, any.weights), (Laws::VISCOUS, Weights::Single(one.weights)));
    assert_eq!(any.header.laws, one.laws);
    assert_eq!(one.sections.get(Section::Provenance), Some(any.header.provenance.as_bytes()));
}

#[test]
fn errors_say_what_is_wrong() {
    let error = load_error(&file::golden()[..20]);
    assert!(error.to_string().contains("damaged"), "{error}");
    assert!(load_error(b"PNG").to_string().contains("3 bytes"));
    assert!(load_error(b"\x89PNG\r\n").to_string().contains("LACT"));
    let shape = ModelError::Shape { what: "coordinates", found: 2, compiled: 3 };
    assert_eq!(shape.to_string(), "2 coordinates, but this program was compiled for 3");
}

#[test]
fn coordinate_letters_are_their_own_inverse() {
    for kind in [Coordinate::Translation, Coordinate::Angle, Coordinate::Cyclic] {
        assert_eq!(Coordinate::from_letter(kind.letter()), Some(kind));
    }
    assert_eq!(Coordinate::from_letter('A'), None);
}

#[test]
fn codes_are_their_own_and_rise() {
    assert!(CATALOGUE.is_sorted_by(|a, b| a.code < b.code));
    let names: std::collections::BTreeSet<_> = CATALOGUE.iter().map(|entry| entry.name).collect();
    assert_eq!(names.len(), CATALOGUE.len());
    assert!(CATALOGUE.iter().all(|entry| entry.message.to_str().is_ok_and(|text| !text.is_empty())));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(parse(Aligned::new(&bytes).bytes()).is_err());
    }

    /// Random bytes behind a valid beginning and before a valid checksum, so that they reach the decoder.
    #[test]
    fn random_headers_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..120)) {
        let file = file::with_checksum(&[&b"LACT"[..], &[FORMAT_VERSION], &bytes[..]].concat());
        let _ = parse(Aligned::new(&file).bytes());
    }

    /// Several bytes of a valid file changed and the checksum corrected: whatever loads can be evaluated.
    #[test]
    fn changes_under_a_right_checksum_never_panic(changes in prop::collection::vec((0usize..110, any::<u8>()), 1..4)) {
        let file = file::golden();
        let mut body = file[..file.len() - 4].to_vec();
        for (position, value) in changes {
            // Positions count from the front, or from the end.
            let end = body.len();
            body[if position < 60 { position } else { end - (position - 59) }] = value;
        }
        let file = Aligned::new(&file::with_checksum(&body));
        let _ = parse(file.bytes());
        if let Ok(model) = InertiaNetworkModel::<2, 8, 3>::load(file.bytes()) {
            let _ = acceleration(&model.system, &[0.1, 0.2], &[0.3, 0.4], &[0.5, 0.6]);
        }
    }
}
