//! Catalogue of the reasons for refusing settings and patches.

use leastaction_core::adapt::{CATALOGUE, PatchError, SettingsError, Unfit};
use leastaction_core::frame::FrameFault;
use leastaction_core::model::Coded;
use leastaction_core::plan;

const FRAME: [(FrameFault, [usize; 3]); 4] = [
    (FrameFault::TooShort { bytes: 3 }, [3, 0, 0]),
    (FrameFault::Magic { expected: *b"LATU" }, [0; 3]),
    (FrameFault::Version { found: 9, supported: 1 }, [9, 0, 0]),
    (FrameFault::Checksum { stored: 1, computed: 2 }, [1, 2, 0]),
];

#[test]
fn every_reason_has_its_number() {
    let ticks = [1e-3_f32, 2e-3].map(|h| h.to_bits() as usize);
    let settings = [
        (SettingsError::Malformed, [0; 3]),
        (SettingsError::Coordinates { found: 2, needed: 3 }, [2, 3, 0]),
        (SettingsError::Places { found: 9, places: 8 }, [9, 8, 0]),
        (SettingsError::OutOfRange, [0; 3]),
        (SettingsError::Number { index: 7 }, [7, 0, 0]),
        (SettingsError::Unfit(Unfit::NoSuch { found: 5, count: 4 }), [5, 4, 0]),
        (SettingsError::Unfit(Unfit::PartOfBody { body: 6 }), [6, 0, 0]),
        (SettingsError::Unfit(Unfit::Gauge { coordinate: 1 }), [1, 0, 0]),
        (SettingsError::OtherModel { saved: 8, given: 9 }, [8, 9, 0]),
        (SettingsError::OtherTick { made_for: 1e-3, given: 2e-3 }, [ticks[0], ticks[1], 0]),
    ];
    let patches = [
        (PatchError::Malformed, [0; 3]),
        (PatchError::NotFinite { index: 4 }, [4, 0, 0]),
        (PatchError::OtherModel { saved: 6, given: 7 }, [6, 7, 0]),
    ];
    let frames = || FRAME.into_iter();
    let of_settings = frames().map(|(fault, numbers)| (SettingsError::Frame(fault), numbers));
    let of_settings = of_settings.chain(settings).map(|(error, numbers)| (error.coded(), numbers));
    let of_patches = frames().map(|(fault, numbers)| (PatchError::Frame(fault), numbers));
    let of_patches = of_patches.chain(patches).map(|(error, numbers)| (error.coded(), numbers));
    let all: Vec<_> = of_settings.chain(of_patches).collect();
    assert_eq!(all.len(), CATALOGUE.len());
    for ((coded, numbers), entry) in all.into_iter().zip(CATALOGUE) {
        assert_eq!(coded, Coded { code: entry.code, numbers, what: None }, "{}", entry.name);
        assert!(entry.message.to_str().is_ok_and(|text| !text.is_empty()));
    }
    // No number is that of another file's reason.
    assert!(plan::CATALOGUE.iter().all(|entry| entry.code < CATALOGUE[0].code));
    assert!(CATALOGUE.windows(2).all(|two| two[0].code < two[1].code));
}
