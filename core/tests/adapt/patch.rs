//! Saved numbers: what is written is read, and nothing damaged is.

use leastaction_core::adapt::{Adapter, Limits, Number, Patch, PatchError, Saved, Tuning};
use leastaction_core::forces::Coefficient;

const P: usize = 8;

/// Numbers of every kind; the golden file names them all, so their order cannot change by itself.
fn patch() -> Patch<P> {
    let numbers = [
        Number::Inertia { body: 2, index: 0 },
        Number::Rotor(1),
        Number::Friction(Coefficient::Viscous, 0),
        Number::Friction(Coefficient::Sticking, 3),
        Number::Offset(1),
        Number::Gain(2),
        Number::Potential(4),
        Number::Dissipation(1),
    ];
    let saved = numbers.into_iter().zip([2.5, 0.25, -0.5, 1.0, 0.125, -0.0625, 0.5, -1.0]);
    Patch {
        model: 0x1234_5678,
        numbers: saved.map(|(number, distance)| Saved { number, distance, error: 0.03125 }).collect(),
    }
}

fn bytes(patch: &Patch<P>) -> Vec<u8> {
    let mut memory = [0; Patch::<P>::MAX_BYTES];
    patch.write(&mut memory).unwrap().to_vec()
}

/// Magic and version, fingerprint, count; number, distance and error of each; checksum.
#[rustfmt::skip]
const GOLDEN: &[u8] = &[
    0x4c, 0x41, 0x50, 0x54, 1,
    0x78, 0x56, 0x34, 0x12, 8,
    1, 2, 0, 0x00, 0x00, 0x20, 0x40, 0x00, 0x00, 0x00, 0x3d,
    2, 1, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x00, 0x3d,
    3, 0, 0, 0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x00, 0x3d,
    3, 4, 3, 0x00, 0x00, 0x80, 0x3f, 0x00, 0x00, 0x00, 0x3d,
    4, 1, 0x00, 0x00, 0x00, 0x3e, 0x00, 0x00, 0x00, 0x3d,
    5, 2, 0x00, 0x00, 0x80, 0xbd, 0x00, 0x00, 0x00, 0x3d,
    6, 4, 0x00, 0x00, 0x00, 0x3f, 0x00, 0x00, 0x00, 0x3d,
    7, 1, 0x00, 0x00, 0x80, 0xbf, 0x00, 0x00, 0x00, 0x3d,
];

#[test]
fn bytes_stay_what_they_are() {
    let bytes = bytes(&patch());
    assert_eq!(bytes[..bytes.len() - 4], *GOLDEN);
    assert_eq!(Patch::<P>::read(&bytes, 0x1234_5678), Ok(patch()));
    assert!(bytes.len() <= Patch::<P>::MAX_BYTES);
}

#[test]
fn no_damaged_bit_is_read() {
    let whole = bytes(&patch());
    for bit in 0..8 * whole.len() {
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(Patch::<P>::of_any(&damaged).is_err(), "bit {bit}");
    }
    for length in 0..whole.len() {
        assert!(Patch::<P>::of_any(&whole[..length]).is_err(), "{length} bytes");
    }
}

#[test]
fn what_does_not_belong_here_is_refused() {
    let whole = bytes(&patch());
    let other = PatchError::OtherModel { saved: 0x1234_5678, given: 1 };
    assert_eq!(Patch::<P>::read(&whole, 1), Err(other));
    assert_eq!(Patch::<7>::of_any(&whole), Err(PatchError::Malformed), "more numbers than places");
    for (distance, error) in [(f32::NAN, 0.1), (f32::INFINITY, 0.1), (1.0, f32::NAN), (1.0, -0.1)] {
        let mut bad = patch();
        bad.numbers[1] = Saved { distance, error, ..bad.numbers[1] };
        assert_eq!(Patch::<P>::of_any(&bytes(&bad)), Err(PatchError::NotFinite { index: 1 }));
    }
    assert!(patch().write(&mut [0; 20]).is_err());
}

fn tuning() -> Tuning<f32, 4, P> {
    let friction = |i| Number::Friction(Coefficient::Viscous, i);
    let unit = Number::Potential(4);
    let numbers = [
        friction(3),
        Number::None,
        Number::Rotor(1),
        friction(0),
        Number::None,
        friction(1),
        unit,
        Number::None,
    ];
    let limits = Limits { model: [1.0; P], lower: [-0.25; P], upper: [0.5; P], kept: 0.1 };
    let prior = [1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    Tuning {
        numbers,
        half: 10,
        h: 1e-2,
        deviation: [1.0; 4],
        prior,
        forgotten: 0.0,
        walk: [0.0; P],
        change: 50.0,
        limits,
        dry: None,
    }
}

#[test]
fn an_adapter_begins_where_it_was_saved() {
    let tuning = tuning();
    let mut first = Adapter::<f32, 4, P, 28>::new(&tuning).unwrap();
    first.begin_with(&tuning, &patch());
    // The rotor is known, one friction is beyond its limit, others are not in the patch.
    assert_eq!(first.applied(), &[0.0, 0.0, 0.25, -0.25, 0.0, 0.0, 0.5, 0.0]);
    let saved = first.patch(&tuning, 7);
    assert_eq!(saved.numbers.len(), 5);
    let mut second = Adapter::new(&tuning).unwrap();
    second.begin_with(&tuning, &Patch::read(&bytes(&saved), 7).unwrap());
    assert_eq!(second, first);
}
