use super::*;
use crate::InertiaNetworkArchitecture;
use leastaction_core::discrete::Order;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::{InertiaNetworkModel, Law};
use leastaction_core::scalar::f16;
use proptest::prelude::*;

const STEP: TrainedStep = TrainedStep { order: Order::Four, h: 0.05, control: ControlKind::Linear };
const CARTPOLE: [Coordinate; 2] = [Coordinate::Translation, Coordinate::Angle];

fn example(provenance: &str) -> (Architecture, Vec<f64>, Vec<u8>) {
    let architecture: Architecture =
        InertiaNetworkArchitecture { damped: true, ..InertiaNetworkArchitecture::new(&CARTPOLE, 9) }.into();
    let weights = architecture.initial_weights(3);
    let bytes = encode(&architecture, &weights, Some(STEP), provenance).unwrap();
    (architecture, weights, bytes)
}

proptest! {
    #[test]
    fn what_is_written_is_read_whatever_the_padding(provenance in ".{0,9}") {
        let (architecture, weights, bytes) = example(&provenance);
        let model = decode(&bytes).unwrap();
        prop_assert_eq!(&model.architecture, &architecture);
        prop_assert_eq!(&model.facts.provenance, &provenance);
        prop_assert_eq!(model.facts.trained_step, Some(STEP));
        let rounded: Vec<f64> = weights.iter().map(|w| f64::from(*w as f32)).collect();
        prop_assert_eq!(&model.weights, &rounded);
        let again = encode(&architecture, &model.weights, model.facts.trained_step, &provenance).unwrap();
        prop_assert_eq!(again, bytes);
    }
}

#[test]
fn a_program_with_dry_friction_names_its_forces() {
    let (architecture, weights, _) = example("");
    let numbers = [&weights[..], &[0.5, 0.1, 0.2, 0.1, 0.01, 0.0, 1.0, 0.1]].concat();
    let block = rounded(&numbers, Precision::Single).unwrap();
    let laws = leastaction_core::model::Laws::FRICTION;
    let written =
        architecture.with_header(|family| assemble(&Header { laws, ..Header::new(family) }, &block)).unwrap();
    let source = rust_source(&written).unwrap();
    for line in [
        "use leastaction_core::forces::{Coulomb, Viscous};",
        "pub type Friction<const M: usize> = (Viscous<f32, M>, Coulomb<f32, M>);",
        "pub type Model = InertiaNetworkModel<'static, N, H, L, f32, Friction<N>>;",
    ] {
        assert!(source.contains(line), "{source}");
    }
}

/// Commands kept for a delay of 0.23 s: for steps of 0.05 s, linear, and for any step if the model was trained for
/// none.
#[test]
fn a_stepper_keeps_as_many_commands_as_the_delay_needs() {
    let (architecture, weights, _) = example("");
    let actuator = Actuator { gain: vec![1.0, -2.0], offset: vec![0.0, 0.5], delay: 0.23, lag: 0.0 };
    let file = |trained_step| {
        let facts = Facts { trained_step, actuator: actuator.clone(), ..Facts::default() };
        encode_in(Precision::Single, &architecture, &weights, &facts).unwrap()
    };
    let trained = rust_source(&file(Some(STEP))).unwrap();
    assert!(trained.contains("pub type Drive = stepper::Drive<Linear, Actuated<N>, N, 6>;"), "{trained}");
    assert!(trained.contains("pub fn stepper() -> Result<Stepper, ModelError>"), "{trained}");
    let any = rust_source(&file(None)).unwrap();
    assert!(any.contains("pub type Drive = stepper::Drive<Held, Actuated<N>, N, 9>;"), "{any}");
    assert!(any.contains("pub fn stepper(h: f32) -> Result<Stepper, ModelError>"), "{any}");
    let constants = rust_constants(&file(Some(STEP))).unwrap();
    assert!(constants.contains("gain: [1.0, -2.0], offset: [0.0, 0.5]"), "{constants}");
    let lagging = Facts {
        trained_step: Some(STEP),
        actuator: Actuator { lag: 0.008, ..actuator.clone() },
        ..Facts::default()
    };
    let lagging = encode_in(Precision::Single, &architecture, &weights, &lagging).unwrap();
    let source = rust_source(&lagging).unwrap();
    assert!(source.contains("pub type Drive = stepper::Drive<Linear, Lagged<N>, N, 6>;"), "{source}");
    assert!(source.contains("a delay of 0.23 s and a lag of 0.008 s."), "{source}");
    let refused = rust_constants(&file(None)).unwrap_err();
    assert!(matches!(refused, ConstantsError::Unsupported { .. }), "{refused}");
}

#[test]
fn the_chip_loads_it_in_place() {
    let (_, _, bytes) = example("somewhere");
    let aligned = Aligned::new(&bytes);
    let model = InertiaNetworkModel::<2, 9, 2>::load(aligned.bytes()).unwrap();
    assert_eq!(model.trained_step, Some(STEP));
    let narrow = InertiaNetworkModel::<2, 8, 2>::load(aligned.bytes()).unwrap_err();
    assert_eq!(narrow, ModelError::Shape { what: "units in a hidden layer", found: 9, compiled: 8 });
}

#[test]
fn halves_are_the_nearest_numbers_and_the_chip_loads_them() {
    let (architecture, mut weights, single) = example("somewhere");
    weights[2] = 1.0 + 2_f64.powi(-11);
    let bytes = encode_in(Precision::Half, &architecture, &weights, &Facts::default()).unwrap();
    assert!(bytes.len() + 2 * weights.len() <= single.len());
    let model = decode(&bytes).unwrap();
    assert_eq!(model.precision, Precision::Half);
    // A value halfway between two half-precision numbers is rounded to the even one.
    assert_eq!(model.weights[2], 1.0);
    for (trained, shipped) in weights.iter().zip(&model.weights) {
        assert!((trained - shipped).abs() <= trained.abs() * 2_f64.powi(-11) + 2_f64.powi(-25));
    }
    let again = encode_in(Precision::Half, &architecture, &model.weights, &Facts::default()).unwrap();
    assert_eq!(again, bytes);
    assert!(InertiaNetworkModel::<2, 9, 2, f16>::load(Aligned::new(&bytes).bytes()).is_ok());
    assert!(
        rust_source(&bytes).unwrap().contains("pub type Model = InertiaNetworkModel<'static, N, H, L, f16>;")
    );
}

#[test]
fn numbers_that_half_precision_cannot_hold_are_refused() {
    let (architecture, mut weights, _) = example("");
    weights[5] = 65_520.0;
    let error = encode_in(Precision::Half, &architecture, &weights, &Facts::default()).unwrap_err();
    assert!(matches!(error, EncodeError::Weight { index: 5, .. }), "{error}");
    assert!(error.to_string().contains("16 bits cannot hold; keep single precision"), "{error}");
    weights[5] = 65_519.0;
    assert!(encode_in(Precision::Half, &architecture, &weights, &Facts::default()).is_ok());
}

#[test]
fn every_truncation_and_every_changed_byte_is_refused() {
    let (_, _, bytes) = example("p");
    for length in 0..bytes.len() {
        assert!(decode(&bytes[..length]).is_err(), "{length}");
    }
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        assert!(decode(&damaged).is_err(), "{place}");
    }
}

#[test]
fn numbers_that_single_precision_cannot_hold_are_refused() {
    let (architecture, mut weights, _) = example("");
    for value in [f64::NAN, f64::INFINITY, 1e39] {
        weights[5] = value;
        let error = encode(&architecture, &weights, None, "").unwrap_err();
        assert!(matches!(error, EncodeError::Weight { index: 5, .. }), "{error}");
    }
}

#[test]
fn what_the_chip_would_refuse_is_not_written() {
    let (architecture, mut weights, _) = example("");
    let step = encode(&architecture, &weights, Some(TrainedStep { h: 0.0, ..STEP }), "").unwrap_err();
    assert_eq!(step, EncodeError::Model(ModelError::OutOfRange { what: "step h" }));
    *weights.last_mut().unwrap() = -1.0;
    let damping = encode(&architecture, &weights, None, "").unwrap_err();
    assert_eq!(
        damping,
        EncodeError::Model(ModelError::LawNumber { law: Law::Viscous, number: 0, group: 1, value: -1.0 })
    );
    weights.pop();
    assert!(matches!(
        encode(&architecture, &weights, None, "").unwrap_err(),
        EncodeError::Model(ModelError::WeightCount { .. })
    ));
}

/// The bytes of a file that is written as hexadecimal numbers, with comments.
fn hexadecimal(text: &str) -> Vec<u8> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.flat_map(str::split_whitespace).map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

const VERSION_1: [(&str, &str); 4] = [
    ("arm", include_str!("../../tests/version_1/arm.hex")),
    ("cartpole", include_str!("../../tests/version_1/cartpole.hex")),
    ("cartpole-f16", include_str!("../../tests/version_1/cartpole-f16.hex")),
    ("web", include_str!("../../tests/version_1/web.hex")),
];
const VERSION_2: [&str; 4] = [
    include_str!("../../../../core/tests/golden/arm.hex"),
    include_str!("../../../../core/tests/golden/cartpole.hex"),
    include_str!("../../../../core/tests/golden/cartpole-f16.hex"),
    include_str!("../../../../core/tests/golden/web.hex"),
];

/// Models that this repository ships, as files of version 1 and of the current version.
const SHIPPED: [(&str, &[u8], &[u8]); 5] = [
    (
        "cartpole.postcard",
        include_bytes!("../../tests/version_1/cartpole.postcard"),
        include_bytes!("../../../../firmware-sim/chip/models/cartpole.postcard"),
    ),
    (
        "cartpole-f16.postcard",
        include_bytes!("../../tests/version_1/cartpole-f16.postcard"),
        include_bytes!("../../../../firmware-sim/chip/models/cartpole-f16.postcard"),
    ),
    (
        "double.postcard",
        include_bytes!("../../tests/version_1/double.postcard"),
        include_bytes!("../../../../firmware-sim/chip/models/double.postcard"),
    ),
    (
        "pendulums.postcard",
        include_bytes!("../../tests/version_1/pendulums.postcard"),
        include_bytes!("../../../../firmware-sim/chip/models/pendulums.postcard"),
    ),
    (
        "example.postcard",
        include_bytes!("../../tests/version_1/example.postcard"),
        include_bytes!("../../../../firmware-sim/examples/cartpole.postcard"),
    ),
];

/// The files of both versions hold the same models. Version 1 took the control as linear, and named no units.
#[test]
fn files_of_version_1_are_the_same_models() {
    let golden = VERSION_1.into_iter().zip(VERSION_2);
    let golden = golden.map(|((name, old), new)| (name, hexadecimal(old), hexadecimal(new)));
    let shipped = SHIPPED.map(|(name, old, new)| (name, old.to_vec(), new.to_vec()));
    for (name, old, new) in golden.chain(shipped) {
        let (old, new) = (decode(&old).unwrap(), decode(&new).unwrap());
        assert_eq!((old.version, new.version), (1, 2), "{name}");
        assert_eq!(old.architecture, new.architecture, "{name}");
        let bits = |model: &Model| model.weights.iter().map(|w| w.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&old), bits(&new), "{name}");
        assert_eq!(old.precision, new.precision, "{name}");
        let step = old.facts.trained_step.map(|step| (step.order, step.h.to_bits()));
        assert_eq!(step, new.facts.trained_step.map(|step| (step.order, step.h.to_bits())), "{name}");
        assert_eq!(old.facts.provenance, new.facts.provenance, "{name}");
    }
}

#[test]
fn damaged_files_of_version_1_are_refused() {
    for (name, text) in VERSION_1 {
        let bytes = hexadecimal(text);
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{name}: {length} bytes");
        }
        for place in 0..bytes.len() {
            for change in [1, 0x10, 0xff] {
                let mut damaged = bytes.clone();
                damaged[place] ^= change;
                assert!(decode(&damaged).is_err(), "{name}: byte {place}");
            }
        }
    }
}

/// Arbitrary bytes with a correct checksum are read or refused without a panic.
#[test]
fn nonsense_of_version_1_is_refused() {
    for (name, text) in VERSION_1 {
        let bytes = hexadecimal(text);
        let body = &bytes[..bytes.len() - 4];
        for place in 5..body.len() {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut damaged = body.to_vec();
                damaged[place] = value;
                damaged.extend(leastaction_core::model::checksum(&damaged).to_le_bytes());
                if let Ok(model) = decode(&damaged) {
                    assert!(model.weights.iter().all(|w| w.is_finite()), "{name}: byte {place}");
                }
            }
        }
    }
}
