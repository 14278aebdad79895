//! The sections of a model file: their order, their lengths, and which of them may be missing or unknown.

use crate::common::file::{self, Aligned, HEADER, golden_whole};
use crate::common::sections::{Cartpole, join, out_of_range, refusal, split, with_content};
use leastaction_core::discrete::Galerkin;
use leastaction_core::model::{ModelError, Section, parse};
use proptest::prelude::*;

#[test]
fn every_section_is_read() {
    let file = Aligned::new(&golden_whole());
    let header = parse(file.bytes()).unwrap().header;
    assert_eq!((header.units, header.provenance), ("m,rad", HEADER.provenance));
    assert_eq!(header.trained_step, Some(file::STEP));
    assert_eq!(header.actuator.unwrap().bytes(), file::actuator(&file::ACTUATOR));
    let range: Result<Vec<_>, _> = header.range.unwrap().coordinates().collect();
    assert_eq!(range.unwrap(), file::RANGE);
    let model = Cartpole::load(file.bytes()).unwrap();
    assert_eq!((model.actuator(), model.range()), (Ok(header.actuator), Ok(header.range)));
    assert_eq!(join(&split(file.bytes())), file.bytes(), "the tests split and join exactly");
    file::assert_truncations_are_refused(file.bytes());
    file::assert_changes_are_refused(file.bytes());
}

#[test]
fn sections_rise() {
    let sections = split(&golden_whole());
    for i in 1..sections.len() {
        let mut swapped = sections.clone();
        swapped.swap(i - 1, i);
        assert_eq!(refusal(&join(&swapped)), ModelError::Malformed, "sections {} and {i}", i - 1);
        let mut twice = sections.clone();
        twice.insert(i, sections[i].clone());
        assert_eq!(refusal(&join(&twice)), ModelError::Malformed, "section {i} twice");
    }
}

/// An unknown section that may change the physics is refused; any other unknown section is skipped.
#[test]
fn unknown_sections() {
    let sections = split(&golden_whole());
    let with = |number: u8| {
        let mut sections = sections.clone();
        sections.push((number, vec![1, 2, 3]));
        sections.sort_by_key(|(number, _)| *number);
        join(&sections)
    };
    let known = |number| Section::ALL.iter().any(|section| *section as u8 == number);
    let expected = parse(Aligned::new(&golden_whole()).bytes()).unwrap().header.trained_step;
    for number in (0..=255).filter(|number| !known(*number)) {
        let file = Aligned::new(&with(number));
        match number {
            0 => assert_eq!(refusal(file.bytes()), ModelError::Malformed),
            1..128 => assert_eq!(refusal(file.bytes()), ModelError::Section { number }),
            _ => assert_eq!(parse(file.bytes()).unwrap().header.trained_step, expected),
        }
        assert_eq!(Cartpole::load(file.bytes()).is_ok(), number >= Section::OPTIONAL);
    }
}

#[test]
fn sections_may_be_missing() {
    let sections = split(&golden_whole());
    for section in Section::ALL {
        let rest: Vec<_> = sections.iter().filter(|(number, _)| *number != section as u8).cloned().collect();
        let file = Aligned::new(&join(&rest));
        let parsed = parse(file.bytes());
        match section {
            Section::Energies | Section::Weights => {
                assert_eq!(parsed, Err(ModelError::MissingSection { what: section.name() }));
            }
            // The laws' numbers are in the weight block.
            Section::Forces => assert!(matches!(parsed, Err(ModelError::WeightCount { .. }))),
            _ => assert!(parsed.is_ok(), "{}", section.name()),
        }
    }
    let nothing = join(&[]);
    assert_eq!(refusal(&nothing), ModelError::MissingSection { what: "energies" });
}

#[test]
fn lengths_that_lie_are_refused() {
    let file = golden_whole();
    let body = &file[..file.len() - 4];
    for section in Section::ALL {
        let [start, end] = file::place(&file, section);
        let length = (end - start) as u32;
        for wrong in [0, length - 1, length + 1, length + 5, 1 << 30, 1 << 31, u32::MAX - 4, u32::MAX] {
            let mut changed = body.to_vec();
            changed[start - 4..start].copy_from_slice(&wrong.to_le_bytes());
            let changed = file::with_checksum(&changed);
            assert!(parse(Aligned::new(&changed).bytes()).is_err(), "{}: {wrong}", section.name());
        }
    }
}

/// Contents that are cut off or one byte too long are refused, even if the section states their actual length.
#[test]
fn contents_of_a_wrong_length_are_refused() {
    let whole = golden_whole();
    let change = |section, longer: bool| {
        let [start, end] = file::place(&whole, section);
        let mut content = whole[start..end].to_vec();
        if longer {
            content.push(0)
        } else {
            content.truncate(content.len() - 1)
        }
        refusal(&with_content(&whole, section, &content))
    };
    for (section, shorter, longer) in [
        (Section::Energies, ModelError::Malformed, ModelError::TrailingBytes { bytes: 1 }),
        (Section::Actuator, out_of_range("length of the actuator"), out_of_range("length of the actuator")),
        (Section::Step, ModelError::Malformed, ModelError::Malformed),
        (Section::Weights, ModelError::Malformed, ModelError::Malformed),
        (
            Section::Range,
            out_of_range("length of the training range"),
            out_of_range("length of the training range"),
        ),
    ] {
        assert_eq!((change(section, false), change(section, true)), (shorter, longer), "{}", section.name());
    }
}

#[test]
fn text_is_text() {
    for section in [Section::Units, Section::Provenance] {
        let file = with_content(&golden_whole(), section, &[b'm', 0xff]);
        assert_eq!(refusal(&file), ModelError::Malformed, "{}", section.name());
        // A program does not read the section.
        assert!(Cartpole::load(Aligned::new(&file).bytes()).is_ok());
    }
}

#[test]
fn version_1_is_refused_with_its_number() {
    let mut file = file::golden();
    file[4] = 1;
    let error = refusal(&file);
    assert_eq!(error, ModelError::Version { found: 1 });
    assert!(error.to_string().contains("leastaction convert"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    /// Sections of any numbers and contents behind a valid shape: refused or evaluated, never a panic.
    #[test]
    fn random_sections_never_panic(sections in prop::collection::vec(
        (any::<u8>(), prop::collection::vec(any::<u8>(), 0..40)), 0..6)) {
        let whole = split(&golden_whole());
        let mut all = [whole, sections].concat();
        all.sort_by_key(|(number, _)| *number);
        all.dedup_by_key(|(number, _)| *number);
        let file = Aligned::new(&join(&all));
        let _ = parse(file.bytes());
        if let Ok(model) = Cartpole::load(file.bytes()) {
            let _ = (model.actuator(), model.range(), model.del::<f32, Galerkin>().is_ok());
        }
    }

    /// Any bytes as the contents of the small sections.
    #[test]
    fn random_contents_never_panic(which in 0..4_usize, content in prop::collection::vec(any::<u8>(), 0..80)) {
        let section = [Section::Forces, Section::Actuator, Section::Step, Section::Range][which];
        let file = Aligned::new(&with_content(&golden_whole(), section, &content));
        let _ = parse(file.bytes());
        if let Ok(model) = Cartpole::load(file.bytes()) {
            if let Ok(Some(actuator)) = model.actuator() {
                let _ = actuator.at_step::<2>(0.01);
            }
            if let Ok(Some(range)) = model.range() {
                let _ = range.outside(&[0.0; 2], &[0.0; 2], &[0.0; 2]);
            }
        }
    }
}
