//! The writer of model files.

use crate::common::crane;
use crate::common::file::{self, Aligned, CARTPOLE, HEADER, arm, arm_header, web, web_header};
use leastaction_core::model::{
    ActuatorBytes, Family, Header, TrainedStep, TrainingRange, WriteError, parse, write,
};
use proptest::prelude::*;

/// The file that core writes from a header and a weight block.
fn written(header: &Header, weights: &[f32]) -> Vec<u8> {
    let mut memory = vec![0xaa; 8192];
    write(header, bytemuck::cast_slice(weights), &mut memory).unwrap().to_vec()
}

#[test]
fn core_writes_what_the_tests_write() {
    let (actuator, range) = (file::actuator(&file::ACTUATOR), file::range(&file::RANGE));
    let inertia_network = file::weights(&CARTPOLE);
    let cases = [
        (HEADER, inertia_network.clone()),
        (arm_header(arm()), file::arm_weights(file::ARM_NUMBERS)),
        (web_header(web()), file::web_weights(file::WEB_NUMBERS)),
        (crane::HEADER, crane::weights(crane::NUMBERS)),
    ];
    for (header, weights) in cases {
        for units in ["", "m", "m,", "m,r", "m,rad"] {
            for whole in [false, true] {
                let header = Header {
                    units,
                    actuator: whole.then(|| ActuatorBytes::new(&actuator).unwrap()),
                    range: whole.then(|| TrainingRange::new(&range).unwrap()),
                    trained_step: whole.then_some(file::STEP),
                    ..header
                };
                let file = written(&header, &weights);
                assert_eq!(file, file::write(header, &weights));
                assert_eq!(parse(Aligned::new(&file).bytes()).unwrap().header, header);
            }
        }
    }
}

#[test]
fn a_file_that_does_not_fit_is_not_written() {
    let weights = file::weights(&CARTPOLE);
    let whole = written(&HEADER, &weights).len();
    for length in 0..whole {
        let found = write(&HEADER, bytemuck::cast_slice(&weights), &mut vec![0; length]).map(<[u8]>::len);
        assert_eq!(found, Err(WriteError::TooShort), "{length} bytes");
    }
    assert!(write(&HEADER, bytemuck::cast_slice(&weights), &mut vec![0; whole]).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn families_and_texts_are_what_was_written(units in "[a-z,]{0,12}", provenance in ".{0,60}", h in 1e-6_f32..1e3) {
        let trained_step = Some(TrainedStep { h, ..file::STEP });
        let header = Header { units: &units, provenance: &provenance, trained_step, ..HEADER };
        let file = written(&header, &file::weights(&CARTPOLE));
        prop_assert_eq!(&file, &file::write(header, &file::weights(&CARTPOLE)));
        let parsed = Aligned::new(&file);
        prop_assert_eq!(parse(parsed.bytes()).unwrap().header, header);
        prop_assert!(matches!(header.family, Family::InertiaNetwork(_)));
    }
}
