//! Numbers in use: possible bodies, limits, and no jumps.

use crate::common::Random;
use leastaction_core::adapt::{Filter, Limits, Measurement, Number, Unfit};
use leastaction_core::forces::Coefficient;
use leastaction_core::linear::dot;
use proptest::prelude::*;

/// Ten numbers of a body and one of friction.
const P: usize = 11;
const T: usize = P * (P - 1) / 2;
const BODY: [f64; P] = [2.0, 0.1, -0.2, 0.05, 0.09, 0.01, 0.08, -0.01, 0.005, 0.07, 0.4];
const PRIOR: [f64; P] = [5.0, 1.0, 1.0, 1.0, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.2];

fn numbers() -> [Number; P] {
    core::array::from_fn(|j| match j {
        10 => Number::Friction(Coefficient::Coulomb, 0),
        _ => Number::Inertia { body: 0, index: j as u8 },
    })
}

fn limits() -> Limits<f64, P> {
    let (mut lower, mut upper) = ([-20.0; P], [20.0; P]);
    (lower[10], upper[10]) = (-0.4, 1.2);
    Limits { model: BODY, lower, upper, kept: 0.1 }
}

/// Smallest pseudo-inertia of a body along directions all around.
fn least_along_all(numbers: &[f64]) -> f64 {
    let [m, x, y, z, xx, xy, yy, xz, yz, zz] = numbers[..10] else { unreachable!() };
    let half = 0.5 * (xx + yy + zz);
    let j = [[half - xx, -xy, -xz, x], [-xy, half - yy, -yz, y], [-xz, -yz, half - zz, z], [x, y, z, m]];
    let mut random = Random(1);
    let along = |d: [f64; 4]| (0..4).map(|i| d[i] * dot(&j[i], &d)).sum::<f64>();
    (0..20_000).map(|_| along(random.array(1.0))).fold(f64::INFINITY, f64::min)
}

fn of_body(distances: &[f64; P], share: f64) -> Vec<f64> {
    (0..10).map(|j| share * BODY[j] + distances[j]).collect()
}

#[test]
fn a_possible_estimate_is_used_as_it_is() {
    let distances = [1.0, 0.1, 0.0, 0.1, 0.05, 0.0, 0.05, 0.0, 0.0, 0.05, 0.3];
    let filter = Filter::<f64, P, T>::at(distances, PRIOR);
    assert_eq!(limits().within(&numbers(), &filter), distances);
}

/// A mass that is known well stays, while unknown moments and inertias give way.
#[test]
fn what_is_known_stays_where_a_body_would_be_impossible() {
    let mut filter = Filter::<f64, P, T>::new(PRIOR);
    let mut row = [0.0; P];
    row[0] = 1.0;
    filter.take(&Measurement {
        row: &row,
        value: 1.5,
        variance: 1e-6,
        largest: f64::INFINITY,
        forgotten: 0.0,
    });
    (row[0], row[4]) = (0.0, 1.0);
    filter.take(&Measurement {
        row: &row,
        value: -0.4,
        variance: 0.1,
        largest: f64::INFINITY,
        forgotten: 0.0,
    });
    let used = limits().within(&numbers(), &filter);
    assert!((used[0] - 1.5).abs() < 1e-4, "{used:?}");
    assert!(least_along_all(&of_body(filter.estimate(), 1.0)) < 0.0);
    assert!(least_along_all(&of_body(&used, 0.9)) > -1e-9, "{used:?}");
}

proptest! {
    /// Whatever was measured, the body keeps a tenth of its inertia and every number its limits.
    #[test]
    fn numbers_in_use_are_possible(seed in 0..u64::MAX, rows in 0_usize..20, size in 0.1..100.0_f64) {
        let (mut filter, mut random) = (Filter::<f64, P, T>::new(PRIOR), Random(seed));
        for _ in 0..rows {
            let row: [f64; P] = random.array(1.0);
            filter.take(&Measurement { row: &row, value: random.symmetric(size), variance: 0.01, largest: f64::INFINITY, forgotten: 0.1 });
        }
        let (limits, used) = (limits(), limits().within(&numbers(), &filter));
        prop_assert!(least_along_all(&of_body(&used, 0.9)) > -1e-6, "{:?}", used);
        for ((used, lower), upper) in used.iter().zip(limits.lower).zip(limits.upper) {
            prop_assert!(lower - 1e-9 <= *used && *used <= upper + 1e-9);
        }
    }
}

#[test]
fn estimates_that_are_not_finite_are_not_used() {
    let filter = Filter::<f64, P, T>::at([f64::NAN; P], PRIOR);
    assert_eq!(limits().within(&numbers(), &filter), [0.0; P]);
}

#[test]
fn numbers_that_do_not_belong_together_are_refused() {
    use leastaction_core::adapt::{Adapter, Tuning};
    let new = |numbers: [Number; P]| {
        let tuning = Tuning {
            numbers,
            half: 10,
            h: 1e-2,
            deviation: [1.0],
            prior: PRIOR,
            forgotten: 0.0,
            walk: [0.0; P],
            change: 50.0,
            limits: limits(),
            dry: None,
        };
        Adapter::<f64, 1, P, T>::new(&tuning).map(|_| ())
    };
    assert_eq!(new(numbers()), Ok(()));
    let with = |j: usize, number| {
        let mut numbers = numbers();
        numbers[j] = number;
        new(numbers)
    };
    assert_eq!(with(10, Number::Gain(0)), Err(Unfit::Gauge { coordinate: 0 }));
    assert_eq!(with(10, Number::Offset(1)), Err(Unfit::NoSuch { found: 1, count: 1 }));
    for missing in 0..10 {
        assert_eq!(with(missing, Number::None), Err(Unfit::PartOfBody { body: 0 }), "without {missing}");
    }
    let swapped = with(3, Number::Inertia { body: 0, index: 4 });
    assert_eq!(swapped, Err(Unfit::PartOfBody { body: 0 }));
}
