//! Rates of false alarms, counted.

use leastaction_core::adapt::{Agreement, Announcement, Changes, Filter, Measurement};
use rand::Gaussian;

mod rand {
    //! Normal numbers from uniform ones.

    use crate::common::Random;

    pub struct Gaussian(pub Random);

    impl Gaussian {
        /// The sum of twelve uniform numbers, of variance 1.
        pub fn next(&mut self) -> f64 {
            (0..12).map(|_| self.0.symmetric(0.5)).sum()
        }
    }
}

use crate::common::Random;

/// Announcements of numbers that do not differ, over 2,000 looks each, are as rare as stated; those that differ are announced.
#[test]
fn false_announcements_are_as_rare_as_stated() {
    let alpha: f64 = 0.05;
    let test = Announcement { number: 0, threshold: -2.0 * alpha.ln(), least: 0.0, prior: 4.0 };
    let announced = |seed: u64, truth: f64| {
        let (mut filter, mut noise) = (Filter::<f64, 1, 0>::new([2.0]), Gaussian(Random(seed)));
        (0..2_000).find(|_| {
            let value = truth + noise.next();
            filter.take(&Measurement {
                row: &[1.0],
                value,
                variance: 1.0,
                largest: f64::INFINITY,
                forgotten: 0.0,
            });
            test.of(&filter).is_some()
        })
    };
    let runs = 2_000;
    let alarms = (0..runs).filter(|seed| announced(*seed, 0.0).is_some()).count();
    assert!(alarms as f64 <= alpha * runs as f64, "{alarms} of {runs}");
    assert!(alarms > 0, "a test that never errs tests nothing");
    for seed in 0..100 {
        let looks = announced(seed, 1.0).expect("a difference of one deviation");
        assert!(looks < 60, "after {looks}");
    }
}

#[test]
fn small_differences_are_not_announced() {
    let test = Announcement { number: 0, threshold: 6.0, least: 0.5, prior: 4.0 };
    let certain = |estimate: f64| Filter::<f64, 2, 1>::at([estimate, 0.0], [1e-3, 1.0]);
    assert!(test.of(&certain(0.4)).is_none());
    assert!(test.of(&certain(-0.6)).is_some_and(|difference| difference.error == 1e-3));
}

fn agreement(squares: f64) -> Agreement<f64> {
    Agreement { rows: 7, squares, changed: false }
}

#[test]
fn changes_are_told_from_noise() {
    let (mut changes, mut noise) = (Changes::new(50.0, 100, 0.0), Gaussian(Random(3)));
    for _ in 0..200_000 {
        let squares = (0..7).map(|_| noise.next().powi(2)).sum();
        assert!(!changes.take(&agreement(squares)));
    }
    assert!(changes.take(&agreement(80.0)));
    assert!(!changes.unlike());
}

#[test]
fn changes_without_end_are_another_machine() {
    let mut changes = Changes::new(50.0, 10, 0.0);
    for k in 0..5 {
        assert!(changes.take(&agreement(100.0)));
        assert_eq!(changes.unlike(), k >= 2);
    }
    (0..20).for_each(|_| assert!(!changes.take(&agreement(7.0))));
    assert!(!changes.unlike());
}
