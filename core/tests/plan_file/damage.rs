//! Damaged plans are refused.

use crate::common::file::{Aligned, with_checksum};
use crate::sample::{MODEL, Sample, refusal};
use leastaction_core::model::{CATALOGUE, Coded};
use leastaction_core::plan::{self, FORMAT_VERSION, MAGIC, Plan, PlanError, PlanFile};
use proptest::prelude::*;

#[test]
fn every_truncation_is_an_error() {
    let file = Sample::golden().bytes();
    for length in 0..file.len() {
        let error = refusal(&file[..length]);
        let expected = matches!(error, PlanError::TooShort { .. } | PlanError::Checksum { .. });
        assert!(expected, "{length} bytes: {error:?}");
    }
}

#[test]
fn every_change_of_a_byte_is_an_error() {
    let file = Sample::golden().bytes();
    for position in 0..file.len() {
        for change in 1..=255 {
            let mut bytes = file.clone();
            bytes[position] ^= change;
            let error = refusal(&bytes);
            match position {
                0..4 => assert_eq!(error, PlanError::Magic),
                4 => assert_eq!(error, PlanError::Version { found: FORMAT_VERSION ^ change }),
                _ => assert!(matches!(error, PlanError::Checksum { .. }), "byte {position}: {error:?}"),
            }
        }
    }
}

/// Writes a plan anew from its parts.
fn again(file: &PlanFile) -> Vec<u8> {
    let mut memory = vec![0; 1024];
    plan::write(file.header(), file.records(), &mut memory).unwrap().to_vec()
}

/// Checks that a plan, if it is read, is the plan that is written from its parts, and can be followed. Returns whether it is read.
fn is_read(bytes: &[u8]) -> bool {
    let aligned = Aligned::new(bytes);
    let Ok(file) = PlanFile::parse(aligned.bytes()) else { return false };
    let written = Aligned::new(&again(&file));
    assert_eq!(PlanFile::parse(written.bytes()), Ok(file));
    if let Ok(plan) = Plan::<2, 1>::new(file) {
        let [least, most] = file.header().limits[0];
        for tick in [0, 1, 2, 3, 5, u32::MAX] {
            if let Ok([u]) = plan.command(tick, &[0.5, -0.5], &[1.0, 2.0]) {
                assert!(least <= u && u <= most, "{least} <= {u} <= {most}");
            }
        }
    }
    true
}

#[test]
fn every_change_of_a_byte_under_a_right_checksum_is_refused_or_read_well() {
    let file = Sample::golden().bytes();
    let body = &file[..file.len() - 4];
    let mut read = vec![0; body.len()];
    for (position, read) in read.iter_mut().enumerate() {
        for change in 0..=255 {
            let mut bytes = body.to_vec();
            bytes[position] ^= change;
            *read += usize::from(is_read(&with_checksum(&bytes)));
        }
    }
    assert_eq!(read[..5], [1; 5], "magic letters and version have one value");
    assert_eq!(read[5..9], [256; 4], "any fingerprint is read");
    assert_eq!(read[20..24], [1; 4], "the padding is its length, then zeros");
    // Every bit of a number's lowest byte gives a finite number.
    assert!(read[32..].iter().step_by(4).all(|count| *count == 256), "{read:?}");
}

#[test]
fn additional_bytes_are_an_error() {
    let file = Sample::golden().bytes();
    assert!(matches!(refusal(&[&file[..], &[0]].concat()), PlanError::Checksum { .. }));
    let body = &file[..file.len() - 4];
    for more in [1, 4, 36] {
        let longer = with_checksum(&[body, &vec![0; more]].concat());
        let needed = 4 * (2 + 27);
        assert_eq!(refusal(&longer), PlanError::NumberCount { found: needed + more, needed });
    }
}

#[test]
fn truncations_under_a_right_checksum_are_errors() {
    let file = Sample::golden().bytes();
    for length in 5..file.len() - 4 {
        assert!(!is_read(&with_checksum(&file[..length])), "{length} bytes");
    }
    assert_eq!(refusal(&with_checksum(&file[..5])), PlanError::Malformed);
}

#[test]
fn unaligned_bytes_are_an_error() {
    let file = Sample::golden().bytes();
    for shift in 1..4 {
        let shifted = Aligned::shifted(&file, shift);
        let error = Plan::<2, 1>::load(&shifted.bytes()[shift..], MODEL).unwrap_err();
        assert_eq!(error, PlanError::Unaligned { offset: shift as u8 });
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn random_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(!is_read(&bytes));
    }

    /// Random bytes behind a valid beginning and before a valid checksum.
    #[test]
    fn random_headers_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..120)) {
        is_read(&with_checksum(&[&MAGIC[..], &[FORMAT_VERSION], &bytes[..]].concat()));
    }

    /// Several bytes of a plan changed and the checksum corrected.
    #[test]
    fn changes_under_a_right_checksum_never_panic(changes in prop::collection::vec((5_usize..140, any::<u8>()), 1..4)) {
        let file = Sample::golden().bytes();
        let mut body = file[..file.len() - 4].to_vec();
        for (position, value) in changes {
            body[position] = value;
        }
        is_read(&with_checksum(&body));
    }
}

#[test]
fn every_reason_has_its_code_and_numbers() {
    let [least, most] = [2.0_f32, 1.0];
    let bits = [least, most].map(|limit| limit.to_bits() as usize);
    let table = [
        (PlanError::TooShort { bytes: 3 }, 80, [3, 0, 0], None),
        (PlanError::Magic, 81, [0; 3], None),
        (PlanError::Version { found: 9 }, 82, [9, 0, 0], None),
        (PlanError::Checksum { stored: 1, computed: 2 }, 83, [1, 2, 0], None),
        (PlanError::Malformed, 84, [0; 3], None),
        (PlanError::Unaligned { offset: 3 }, 85, [3, 0, 0], None),
        (PlanError::BigEndian, 86, [0; 3], None),
        (PlanError::NumberCount { found: 5, needed: 6 }, 87, [5, 6, 0], None),
        (PlanError::NotFinite { index: 7 }, 88, [7, 0, 0], None),
        (PlanError::OutOfRange { what: "tick h" }, 89, [0; 3], Some("tick h")),
        (PlanError::Driven { coordinate: 4 }, 90, [4, 0, 0], None),
        (PlanError::Limits { coordinate: 1, least, most }, 91, [1, bits[0], bits[1]], None),
        (PlanError::Shape { what: "coordinates", found: 2, compiled: 3 }, 92, [2, 3, 0], Some("coordinates")),
        (PlanError::OtherModel { planned: 8, given: 9 }, 93, [8, 9, 0], None),
    ];
    for ((error, code, numbers, what), entry) in table.into_iter().zip(plan::CATALOGUE) {
        assert_eq!(error.coded(), Coded { code, numbers, what }, "{error}");
        assert_eq!(entry.code, code);
        assert!(entry.message.to_str().is_ok_and(|text| !text.is_empty()));
    }
    assert_eq!(table.len(), plan::CATALOGUE.len());
    // No code is both a model's and a plan's.
    assert!(CATALOGUE.iter().all(|entry| entry.code < plan::CATALOGUE[0].code));
}
