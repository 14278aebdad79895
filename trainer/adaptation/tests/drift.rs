//! Drift between logs with errors that last, as those of a model do.

use leastaction_adaptation::drift::{Drift, DriftError, Moment, Windows};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const N: usize = 3;
const H: f64 = 0.01;
/// Ticks of a day.
const TICKS: usize = 6000;
/// Correlation of an error with that of the tick before: it lasts half a second.
const LASTING: f64 = 0.98;

/// Change of the errors of the second coordinate, of size 1.
#[derive(Clone, Copy, Default)]
struct Change {
    mean: f64,
    direction: f64,
    command: f64,
    size: f64,
    noise: f64,
}

fn day(seed: u64, ticks: usize, change: Change) -> Windows {
    day_in(1.0, seed, ticks, change)
}

/// A day whose errors, velocities and commands are given in a unit.
fn day_in(unit: f64, seed: u64, ticks: usize, change: Change) -> Windows {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut normal = move || random.sample::<f64, _>(StandardNormal);
    let phases: [f64; N] = core::array::from_fn(|_| 3.0 * normal());
    let (mut windows, mut lasting) = (Windows::new(H, ticks), [0.0; N]);
    for k in 0..ticks {
        let shared = normal();
        let moments: [Moment; N] = core::array::from_fn(|i| {
            let fresh = (1.0 - LASTING * LASTING).sqrt() * (0.8 * normal() + 0.6 * shared);
            lasting[i] = LASTING * lasting[i] + fresh;
            let phase = phases[i] + (2.0 + i as f64) * H * k as f64;
            let (velocity, command) = (phase.sin(), 4.0 + phase.cos());
            let Change { mean, direction, command: gain, size, noise } =
                if i == 1 { change } else { Change::default() };
            let changed = mean + direction * velocity.signum() + gain * (command - 4.0);
            let error = (1.0 + size) * lasting[i] + changed + (0.5 + noise) * normal();
            Moment { error: unit * error, velocity: unit * velocity, command: unit * command }
        });
        windows.take(moments);
    }
    windows
}

fn drift(seed: u64, change: Change) -> Drift {
    Drift::new(&day(1000 + seed, TICKS, Change::default()), &day(seed, TICKS, change), 1e-3)
        .expect("a number")
}

/// 300 days against as many references: a rate of 5% gives 15 ± 4.
#[test]
fn days_without_change_exceed_the_threshold_at_most_as_often_as_stated() {
    let found = (0..300_u64).map(|seed| {
        let reference = day(1000 + seed, TICKS, Change::default());
        Drift::new(&reference, &day(seed, TICKS, Change::default()), 0.05).expect("a number")
    });
    let found: Vec<Drift> = found.collect();
    let alarms = found.iter().filter(|drift| drift.has_drifted()).count();
    assert!(alarms <= 24, "{alarms} false alarms");
    let mean = found.iter().map(|drift| drift.value).sum::<f64>() / 300.0;
    assert!((0.7..1.5).contains(&mean), "the value is {mean} without change");
}

#[test]
fn every_kind_of_change_is_seen_where_it_is() {
    let none = Change::default();
    let changes = [
        Change { mean: 2.0, ..none },
        Change { direction: -2.0, ..none },
        Change { command: -2.0, ..none },
        Change { size: 2.0, ..none },
        Change { noise: 2.0, ..none },
    ];
    for (k, change) in changes.into_iter().enumerate() {
        let drift = drift(7, change);
        assert!(drift.has_drifted(), "{k}: {drift:?}");
        let [first, second, third] = [0, 1, 2].map(|i| drift.coordinates[i].value);
        assert!(second > 4.0 * first.max(third), "{k}: {drift:?}");
        let of = drift.coordinates[1];
        let signs = [of.mean, of.direction, of.command, of.windows, of.ticks].map(|z| z.expect("shown"));
        let expected = [change.mean, change.direction, change.command, change.size, change.noise][k];
        assert!(signs[k] * expected > 0.0 && signs[k].abs() > 4.0, "{k}: {signs:?}");
    }
}

#[test]
fn smaller_errors_are_no_drift_by_themselves() {
    let drift = drift(3, Change { size: -0.9, ..Change::default() });
    assert!(!drift.has_drifted() && drift.coordinates[1].errors < 0.5, "{drift:?}");
}

/// Millimetres and seconds of another clock change nothing: powers of two leave even the bits.
#[test]
fn a_number_has_no_unit_and_repeats() {
    let of = |unit: f64| {
        let [reference, log] = [1, 2].map(|seed| day_in(unit, seed, TICKS, Change::default()));
        Drift::new(&reference, &log, 0.01).expect("a number")
    };
    assert_eq!(of(1.0), of(1024.0));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let none = Change::default();
    let (whole, short) = (day(1, TICKS, none), day(2, 200, none));
    assert!(matches!(Drift::new(&short, &whole, 0.01), Err(DriftError::TooShort { .. })));
    let empty = whole.emptied();
    assert_eq!(Drift::new(&whole, &empty, 0.01), Err(DriftError::NoWindow));
    assert!(matches!(Drift::new(&empty, &whole, 0.01), Err(DriftError::TooShort { .. })));
    let mut still = Windows::new(H, TICKS);
    (0..TICKS).for_each(|_| still.take([Moment::default(); N]));
    assert_eq!(Drift::new(&still, &whole, 0.01), Err(DriftError::Exact));
}
