//! Headers that the format does not allow, in files with a right checksum.

use crate::common::file::{Aligned, golden, with_checksum};
use crate::sample::{MODEL, Sample, refusal};
use leastaction_core::model::{ModelError, fingerprint, stored_fingerprint};
use leastaction_core::plan::{Plan, PlanError, PlanFile};

fn refused(sample: Sample) -> PlanError {
    refusal(&sample.bytes())
}

fn out_of_range(what: &'static str) -> PlanError {
    PlanError::OutOfRange { what }
}

#[test]
fn numbers_of_the_header_have_their_range() {
    let plan = Sample::golden;
    let huge = u32::MAX;
    for (sample, what) in [
        (Sample { angles: vec![], ..plan() }, "number of coordinates"),
        (Sample { angles: vec![0; 65], ..plan() }, "number of coordinates"),
        (Sample { angles: vec![2, 0], ..plan() }, "mark of an angle"),
        (Sample { driven: vec![], limits: vec![], ..plan() }, "number of driven coordinates"),
        (Sample { h: 0.0, ..plan() }, "tick h"),
        (Sample { h: -0.05, ..plan() }, "tick h"),
        (Sample { h: f32::NAN, ..plan() }, "tick h"),
        (Sample { h: f32::INFINITY, ..plan() }, "tick h"),
        (Sample { ticks_per_node: 0, ..plan() }, "number of ticks of a node"),
        (Sample { nodes: 0, ..plan() }, "number of nodes"),
        (Sample { nodes: huge, ..plan() }, "duration"),
        (Sample { ticks_per_node: huge, ..plan() }, "duration"),
        (Sample { h: 1e38, ticks_per_node: 100, ..plan() }, "duration"),
    ] {
        assert_eq!(refused(sample.clone()), out_of_range(what), "{sample:?}");
    }
}

#[test]
fn numbers_must_be_as_many_as_the_header_says() {
    let plan = Sample::golden;
    let found = 4 * (2 + 27);
    for (sample, needed) in [
        (Sample { nodes: 1, ..plan() }, 4 * (2 + 18)),
        (Sample { nodes: 3, ..plan() }, 4 * (2 + 36)),
        (Sample { nodes: 1 << 24, ..plan() }, 4 * (2 + 9 * ((1 << 24) + 1))),
        (Sample { angles: vec![0; 64], ..plan() }, 4 * (2 + 3 * (128 + 1 + 128))),
    ] {
        assert_eq!(refused(sample), PlanError::NumberCount { found, needed });
    }
    // More numbers than a small processor can address.
    let error = refused(Sample { nodes: u32::MAX, ticks_per_node: 1, ..plan() });
    let expected = matches!(error, PlanError::NumberCount { .. }) || error == out_of_range("number of nodes");
    assert!(expected, "{error:?}");
}

#[test]
fn driven_coordinates_ascend_and_exist() {
    for (driven, coordinate) in [
        (vec![2], 2),
        (vec![255], 255),
        (vec![0, 0], 0),
        (vec![1, 0], 0),
        (vec![0, 2], 2),
        (vec![0, 1, 1], 1),
        (vec![0, 1, 2], 2),
    ] {
        let limits = vec![[0.0, 1.0]; driven.len()];
        let sample = Sample { driven, limits, ..Sample::golden() };
        assert_eq!(refused(sample.clone()), PlanError::Driven { coordinate }, "{sample:?}");
    }
}

#[test]
fn limits_rise() {
    let limits = |least, most| Sample { limits: vec![[least, most]], ..Sample::golden() };
    let fault = PlanError::Limits { coordinate: 1, least: 0.5, most: 0.25 };
    assert_eq!(refused(limits(0.5, 0.25)), fault);
    assert!(PlanFile::parse(limits(0.5, 0.5).file().bytes()).is_ok());
}

#[test]
fn numbers_must_be_finite() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for index in 0..2 {
            let mut sample = Sample::golden();
            sample.limits[0][index] = bad;
            assert_eq!(refused(sample), PlanError::NotFinite { index });
        }
        for index in 0..27 {
            let mut sample = Sample::golden();
            sample.records[index] = bad;
            assert_eq!(refused(sample), PlanError::NotFinite { index: 2 + index });
        }
    }
}

#[test]
fn padding_is_at_most_three_zeros() {
    let file = Sample::golden().bytes();
    let (before, numbers) = (&file[..20], &file[24..file.len() - 4]);
    assert_eq!(file[20..24], [3, 0, 0, 0]);
    let with = |padding: &[u8]| refusal(&with_checksum(&[before, padding, numbers].concat()));
    for wrong in [&[7, 0, 0, 0, 0, 0, 0, 0][..], &[3, 0, 0, 1], &[255], &[4]] {
        assert_eq!(with(wrong), out_of_range("padding"), "{wrong:?}");
    }
    for wrong in [&[0][..], &[1, 0], &[2, 0, 0]] {
        assert!(matches!(with(wrong), PlanError::Unaligned { .. }), "{wrong:?}");
    }
    assert_eq!(refusal(&with_checksum(before)), out_of_range("padding"));
}

#[test]
fn lengths_beyond_the_file_are_malformed() {
    let file = Sample::golden().bytes();
    // Lengths of the two lists, as varints.
    for position in [9, 11] {
        for length in [&[200, 1][..], &[255, 255, 255, 255, 15], &[255; 12]] {
            let body = [&file[..position], length, &file[position + 1..file.len() - 4]].concat();
            assert_eq!(refusal(&with_checksum(&body)), PlanError::Malformed, "{length:?} at {position}");
        }
    }
}

#[test]
fn sizes_must_be_the_compiled_ones() {
    let file = Sample::golden().file();
    let shape = |what, found, compiled| Some(PlanError::Shape { what, found, compiled });
    assert!(Plan::<2, 1>::load(file.bytes(), MODEL).is_ok());
    assert_eq!(Plan::<1, 1>::load(file.bytes(), MODEL).err(), shape("coordinates", 2, 1));
    assert_eq!(Plan::<3, 1>::load(file.bytes(), MODEL).err(), shape("coordinates", 2, 3));
    assert_eq!(Plan::<2, 0>::load(file.bytes(), MODEL).err(), shape("driven coordinates", 1, 0));
    assert_eq!(Plan::<2, 2>::load(file.bytes(), MODEL).err(), shape("driven coordinates", 1, 2));
}

/// Commands and gains beyond those of the file are 0.
#[test]
fn fewer_commands_than_compiled_can_be_allowed() {
    let file = Sample::golden().file();
    let parsed = leastaction_core::plan::PlanFile::parse(file.bytes()).unwrap();
    let (one, two) = (Plan::<2, 1>::new(parsed).unwrap(), Plan::<2, 2>::at_most(parsed).unwrap());
    for tick in 0..8 {
        let (q, v) = ([0.1, -0.2], [0.3, 0.4]);
        assert_eq!(one.force(tick, &q, &v), two.force(tick, &q, &v));
        let (found, narrow) = (two.reference(tick), one.reference(tick));
        assert_eq!((found.q, found.v, found.u), (narrow.q, narrow.v, [narrow.u[0], 0.0]));
        assert_eq!(found.gain[0], narrow.gain[0]);
        assert!(found.gain[1].q == [0.0; 2] && found.gain[1].v == [0.0; 2]);
    }
    let shape = |what, found, compiled| Some(PlanError::Shape { what, found, compiled });
    assert_eq!(Plan::<2, 0>::at_most(parsed).err(), shape("driven coordinates", 1, 0));
    assert_eq!(Plan::<3, 3>::at_most(parsed).err(), shape("coordinates", 2, 3));
}

#[test]
fn a_plan_for_another_model_is_refused() {
    let file = Sample::golden().file();
    let error = Plan::<2, 1>::load(file.bytes(), 0x0012_3456).unwrap_err();
    assert_eq!(error, PlanError::OtherModel { planned: MODEL, given: 0x0012_3456 });
    let text = error.to_string();
    assert!(text.contains("89abcdef") && text.contains("00123456"), "{text}");
}

#[test]
fn the_fingerprint_is_the_checksum_of_a_whole_model_file() {
    let file = golden();
    let sum = u32::from_le_bytes(*file.last_chunk().unwrap());
    assert_eq!(fingerprint(&file), Ok(sum));
    assert_eq!((stored_fingerprint(&file), stored_fingerprint(b"LAC")), (Some(sum), None));
    assert!(matches!(fingerprint(&file[..file.len() - 1]), Err(ModelError::Checksum { .. })));
    assert_eq!(fingerprint(&Sample::golden().bytes()), Err(ModelError::Magic));
    assert_eq!(fingerprint(b"LACT"), Err(ModelError::TooShort { bytes: 4 }));
}

#[test]
fn errors_say_what_is_wrong() {
    assert_eq!(refusal(&golden()), PlanError::Magic);
    assert!(refusal(&golden()).to_string().contains("LAPN"));
    assert!(refusal(b"LAP").to_string().contains("3 bytes"));
    assert!(refusal(b"LAPN\x02").to_string().contains("version 2 is not 1"));
    let file = Aligned::new(&Sample::golden().bytes()[..40]);
    let error = PlanFile::parse(file.bytes()).unwrap_err();
    assert!(error.to_string().contains("damaged"), "{error}");
    let limits = PlanError::Limits { coordinate: 1, least: 0.5, most: 0.25 };
    assert_eq!(limits.to_string(), "the largest command of coordinate 1 is 0.25, below its least, 0.5");
}
