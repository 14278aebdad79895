//! Settings of an adapter as a file: what is written is read, and nothing damaged is.

use heapless::Vec;
use leastaction_core::adapt::{
    Announcement, Following, Number, Settings, SettingsError, SettingsFile, StoredSettings, Tuning, Unfit,
};
use leastaction_core::forces::Coefficient;

const N: usize = 3;
const P: usize = 7;
const MODEL: u32 = 0x1234_5678;

/// A host has lists of its own: they may be larger than those of the program that reads.
type Written = SettingsFile<Vec<f32, 8>, Vec<Following, 16>>;

fn list<T: Clone, const L: usize>(all: &[T]) -> Vec<T, L> {
    Vec::from_slice(all).unwrap()
}

fn following(number: Number, prior: f32) -> Following {
    Following { number, model: 2.0 * prior, prior, walk: 0.125 * prior, limits: [-prior, 4.0 * prior] }
}

/// Settings as a host writes them, of fewer numbers than there are places.
fn written() -> Written {
    let numbers = [
        following(Number::Inertia { body: 2, index: 0 }, 1.0),
        following(Number::Inertia { body: 2, index: 1 }, 0.25),
        following(Number::Inertia { body: 2, index: 2 }, 0.25),
        following(Number::Inertia { body: 2, index: 3 }, 0.125),
        following(Number::Friction(Coefficient::Viscous, 1), 0.5),
    ];
    let settings = Settings {
        half: 12,
        h: 0.008,
        deviation: list(&[0.5, 0.25, 0.125]),
        forgotten: 0.0625,
        change: 50.0,
        dry: Some((Coefficient::Coulomb, list(&[1.0, 0.5, 0.0]))),
        kept: 0.125,
        numbers: list(&numbers),
    };
    let announcement = Some(Announcement { number: 0, threshold: 20.0, least: 0.02, prior: 1.0 });
    SettingsFile { model: MODEL, block: 8, settings, announcement }
}

fn bytes(file: &Written) -> Vec<u8, 512> {
    let mut memory = [0; 512];
    list(file.write(&mut memory).unwrap())
}

fn read(file: &Written) -> Result<StoredSettings<N, P>, SettingsError> {
    StoredSettings::read(&bytes(file), MODEL)
}

/// Magic and version, fingerprint, block; half, tick, deviations, share that is forgotten, threshold of a change, dry friction, share that is
/// kept; numbers, each with its value, prior, walk and limits; announcement.
#[rustfmt::skip]
const GOLDEN: &[u8] = &[
    0x4c, 0x41, 0x54, 0x55, 1,
    0x78, 0x56, 0x34, 0x12, 8,
    12, 0x6f, 0x12, 0x03, 0x3c, 3, 0, 0, 0, 0x3f, 0, 0, 0x80, 0x3e, 0, 0, 0, 0x3e, 0, 0, 0x80, 0x3d, 0, 0, 0x48, 0x42,
    1, 1, 3, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x3e,
    5,
    1, 2, 0, 0, 0, 0, 0x40, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3e, 0, 0, 0x80, 0xbf, 0, 0, 0x80, 0x40,
    1, 2, 1, 0, 0, 0, 0x3f, 0, 0, 0x80, 0x3e, 0, 0, 0, 0x3d, 0, 0, 0x80, 0xbe, 0, 0, 0x80, 0x3f,
    1, 2, 2, 0, 0, 0, 0x3f, 0, 0, 0x80, 0x3e, 0, 0, 0, 0x3d, 0, 0, 0x80, 0xbe, 0, 0, 0x80, 0x3f,
    1, 2, 3, 0, 0, 0x80, 0x3e, 0, 0, 0, 0x3e, 0, 0, 0x80, 0x3c, 0, 0, 0, 0xbe, 0, 0, 0, 0x3f,
    3, 0, 1, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 0, 0, 0x80, 0x3d, 0, 0, 0, 0xbf, 0, 0, 0, 0x40,
    1, 0, 0, 0, 0xa0, 0x41, 0x0a, 0xd7, 0xa3, 0x3c, 0, 0, 0x80, 0x3f,
];

#[test]
fn bytes_stay_what_they_are() {
    let (file, bytes) = (written(), bytes(&written()));
    assert_eq!(bytes[..bytes.len() - 4], *GOLDEN);
    let own = read(&file).unwrap();
    assert_eq!((own.model, own.block, own.announcement), (file.model, file.block, file.announcement));
    let (host, chip): (Tuning<f32, N, P>, _) =
        (file.settings.tuning().unwrap(), own.settings.tuning().unwrap());
    assert_eq!(host, chip);
    assert_eq!(chip.numbers[5..], [Number::None; 2]);
    assert_eq!((chip.prior[5], chip.prior[1], chip.limits.upper[3], chip.walk[4]), (0.0, 0.25, 0.5, 0.0625));
}

#[test]
fn no_damaged_bit_is_read() {
    let whole = bytes(&written());
    for bit in 0..8 * whole.len() {
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(StoredSettings::<N, P>::read(&damaged, MODEL).is_err(), "bit {bit}");
    }
    for length in 0..whole.len() {
        assert!(StoredSettings::<N, P>::read(&whole[..length], MODEL).is_err(), "{length} bytes");
    }
}

#[test]
fn settings_for_something_else_are_refused() {
    let whole = bytes(&written());
    let other = SettingsError::OtherModel { saved: MODEL, given: 1 };
    assert_eq!(StoredSettings::<N, P>::read(&whole, 1), Err(other));
    assert_eq!(StoredSettings::<N, 4>::read(&whole, MODEL), Err(SettingsError::Malformed), "too few places");
    let needed = SettingsError::Coordinates { found: 3, needed: 4 };
    assert_eq!(StoredSettings::<4, P>::read(&whole, MODEL), Err(needed));
    let places = SettingsError::Places { found: 5, places: 4 };
    assert_eq!(written().settings.tuning::<N, 4>(), Err(places));
    let own = read(&written()).unwrap();
    assert_eq!(own.check_tick(1e-3), Ok(()));
    assert_eq!(own.check_tick(2e-3), Err(SettingsError::OtherTick { made_for: 1e-3, given: 2e-3 }));
    assert!(own.check_tick(f32::NAN).is_err());
    let mut two = written();
    two.settings.numbers.remove(1);
    assert_eq!(read(&two), Err(SettingsError::Unfit(Unfit::PartOfBody { body: 2 })));
    assert!(written().write(&mut [0; 100]).is_err());
}

/// A change of the settings.
type Change = fn(&mut Written);

#[test]
fn numbers_out_of_range_are_refused() {
    let of_number: [Change; 7] = [
        |file| file.settings.numbers[3].prior = -1.0,
        |file| file.settings.numbers[3].model = f32::NAN,
        |file| file.settings.numbers[3].walk = -1e-3,
        |file| file.settings.numbers[3].walk = f32::INFINITY,
        |file| file.settings.numbers[3].limits[0] = 0.1,
        |file| file.settings.numbers[3].limits[1] = -0.1,
        |file| file.settings.numbers[3].limits[1] = f32::NAN,
    ];
    let of_all: [Change; 17] = [
        |file| file.block = 0,
        |file| file.settings.half = 0,
        |file| file.settings.h = 0.0,
        |file| file.settings.h = f32::INFINITY,
        |file| file.settings.deviation[2] = 0.0,
        |file| file.settings.deviation[0] = f32::NAN,
        |file| file.settings.forgotten = 1.0,
        |file| file.settings.forgotten = -0.1,
        |file| file.settings.forgotten = f32::NAN,
        |file| file.settings.change = f32::NAN,
        |file| file.settings.change = 0.0,
        |file| file.settings.kept = 0.0,
        |file| file.settings.kept = 1.5,
        |file| file.settings.dry = Some((Coefficient::Coulomb, list(&[1.0, -0.5, 0.0]))),
        |file| file.announcement.as_mut().unwrap().number = 5,
        |file| file.announcement.as_mut().unwrap().threshold = f32::NAN,
        |file| file.announcement.as_mut().unwrap().prior = 0.0,
    ];
    let all = of_number.map(|change| (change, SettingsError::Number { index: 3 })).into_iter();
    for (k, (change, error)) in
        all.chain(of_all.map(|change| (change, SettingsError::OutOfRange))).enumerate()
    {
        let mut file = written();
        change(&mut file);
        assert_eq!(read(&file), Err(error), "change {k}");
    }
}
