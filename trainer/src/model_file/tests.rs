use super::*;
use crate::architecture::RigidArchitecture;
use leastaction_core::energy::rigid::Coordinate;
use leastaction_core::model::RigidModel;
use proptest::prelude::*;

const CARTPOLE: [Coordinate; 2] = [Coordinate::Translation, Coordinate::Angle];

fn example(provenance: &str) -> (Architecture, Vec<f64>, Vec<u8>) {
    let architecture: Architecture =
        RigidArchitecture { damped: true, ..RigidArchitecture::new(&CARTPOLE, 9) }.into();
    let weights = architecture.initial_weights(3);
    let bytes = encode(&architecture, &weights, Some(TrainedStep { order: 4, h: 0.05 }), provenance).unwrap();
    (architecture, weights, bytes)
}

proptest! {
    #[test]
    fn what_is_written_is_read_whatever_the_padding(provenance in ".{0,9}") {
        let (architecture, weights, bytes) = example(&provenance);
        let model = decode(&bytes).unwrap();
        prop_assert_eq!(&model.architecture, &architecture);
        prop_assert_eq!(&model.provenance, &provenance);
        prop_assert_eq!(model.trained_step, Some(TrainedStep { order: 4, h: 0.05 }));
        let rounded: Vec<f64> = weights.iter().map(|w| f64::from(*w as f32)).collect();
        prop_assert_eq!(&model.weights, &rounded);
        let again = encode(&architecture, &model.weights, model.trained_step, &provenance).unwrap();
        prop_assert_eq!(again, bytes);
    }
}

#[test]
fn the_chip_loads_it_in_place() {
    let (_, _, bytes) = example("somewhere");
    let aligned = Aligned::new(&bytes);
    let model = RigidModel::<2, 9, 2>::load(aligned.bytes()).unwrap();
    assert_eq!(model.trained_step, Some(TrainedStep { order: 4, h: 0.05 }));
    let narrow = RigidModel::<2, 8, 2>::load(aligned.bytes()).unwrap_err();
    assert_eq!(narrow, ModelError::Shape { what: "units in a hidden layer", found: 9, compiled: 8 });
}

#[test]
fn halves_are_the_nearest_numbers_and_the_chip_loads_them() {
    let (architecture, mut weights, single) = example("somewhere");
    weights[2] = 1.0 + 2_f64.powi(-11);
    let bytes = encode_in(Precision::Half, &architecture, &weights, None, "").unwrap();
    assert!(bytes.len() + 2 * weights.len() <= single.len());
    let model = decode(&bytes).unwrap();
    assert_eq!(model.precision, Precision::Half);
    // Between two halves, to the even one.
    assert_eq!(model.weights[2], 1.0);
    for (trained, shipped) in weights.iter().zip(&model.weights) {
        assert!((trained - shipped).abs() <= trained.abs() * 2_f64.powi(-11) + 2_f64.powi(-25));
    }
    let again = encode_in(Precision::Half, &architecture, &model.weights, None, "").unwrap();
    assert_eq!(again, bytes);
    assert!(RigidModel::<2, 9, 2, _>::load_half(Aligned::new(&bytes).bytes()).is_ok());
    assert!(rust_source(&bytes).unwrap().contains("pub type Model = RigidModel<'static, N, H, D, f16>;"));
}

#[test]
fn numbers_that_half_precision_cannot_hold_are_refused() {
    let (architecture, mut weights, _) = example("");
    weights[5] = 65_520.0;
    let error = encode_in(Precision::Half, &architecture, &weights, None, "").unwrap_err();
    assert!(matches!(error, EncodeError::Weight { index: 5, .. }), "{error}");
    assert!(error.to_string().contains("16 bits cannot hold; keep single precision"), "{error}");
    weights[5] = 65_519.0;
    assert!(encode_in(Precision::Half, &architecture, &weights, None, "").is_ok());
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
    let step = Some(TrainedStep { order: 3, h: 0.05 });
    let order = encode(&architecture, &weights, step, "").unwrap_err();
    assert_eq!(order, EncodeError::Model(ModelError::OutOfRange { what: "order" }));
    *weights.last_mut().unwrap() = -1.0;
    let damping = encode(&architecture, &weights, None, "").unwrap_err();
    assert_eq!(damping, EncodeError::Model(ModelError::OutOfRange { what: "damping coefficient" }));
    weights.pop();
    assert!(matches!(
        encode(&architecture, &weights, None, "").unwrap_err(),
        EncodeError::Model(ModelError::WeightCount { .. })
    ));
}
