//! Excitation motions: within limits, from rest, better than the first, and reproducible.

use super::panda;
use leastaction_learning::torque::excitation::{Excitation, ExcitationError, Search, excite};
use leastaction_models::tree::{Limits, Tree};

fn limits(tree: &Tree) -> Vec<Limits> {
    (0..tree.coordinates()).map(|k| tree.limits(k)).collect()
}

fn few() -> Search {
    Search { period: 8.0, starts: 2, trials: 6, ..Search::default() }
}

fn found(search: &Search) -> Excitation {
    let tree = panda::guessed();
    excite(&tree, &limits(&tree), search).unwrap()
}

#[test]
fn a_motion_keeps_its_limits_starts_at_rest_and_is_better_than_the_first() {
    let (search, tree) = (few(), panda::guessed());
    let own = found(&search);
    assert_eq!(own, found(&search));
    assert_ne!(own, found(&Search { seed: 1, ..search }));
    let [first, last] = own.condition;
    assert!(last < first, "{first} {last}");
    let [start, end] = [0.0, search.period].map(|t| own.series.at(t));
    for (part, (start, end)) in start.iter().zip(&end).enumerate() {
        for (x, y) in start.iter().zip(end) {
            assert!((x - y).abs() < 1e-9 && (part == 0 || x.abs() < 1e-9), "{part}: {x} {y}");
        }
    }
    for (own, limits) in own.uses.iter().zip(limits(&tree)) {
        let [from, to] = limits.position;
        assert!(own.position[0] > from && own.position[1] < to, "{own:?} {limits:?}");
        assert!(own.velocity < 0.92 * limits.velocity && own.effort < limits.effort, "{own:?} {limits:?}");
    }
    // The limits are used.
    assert!(own.uses.iter().zip(limits(&tree)).any(|(own, limits)| own.velocity > 0.5 * limits.velocity));
}

#[test]
fn velocities_and_accelerations_are_slopes() {
    let series = found(&few()).series;
    let e = 1e-5;
    let [before, at, after] = [1.3 - e, 1.3, 1.3 + e].map(|t| series.at(t));
    for part in 0..2 {
        for ((a, b), slope) in before[part].iter().zip(&after[part]).zip(&at[part + 1]) {
            assert!(((b - a) / (2.0 * e) - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{slope}");
        }
    }
}

#[test]
fn what_cannot_be_is_said_by_the_joint() {
    let tree = panda::guessed();
    let search = few();
    let error = |change: &dyn Fn(&mut Limits)| {
        let mut limits = limits(&tree);
        change(&mut limits[2]);
        excite(&tree, &limits, &search).unwrap_err().to_string()
    };
    let text = error(&|own| own.velocity = f64::INFINITY);
    assert!(text.contains("joint3") && text.contains("velocity"), "{text}");
    let text = error(&|own| own.position[1] = f64::INFINITY);
    assert!(text.contains("joint3") && text.contains("position"), "{text}");
    let text = error(&|own| own.velocity = 0.0);
    assert!(text.contains("joint3"), "{text}");
    // The limit is too small to hold the arm up in any motion.
    let mut weak = limits(&tree);
    weak[1].effort = 1.0;
    let failed = excite(&tree, &weak, &search).unwrap_err();
    assert!(
        matches!(failed, ExcitationError::Effort { .. }) && failed.to_string().contains("joint2"),
        "{failed}"
    );
    let none = Search { harmonics: 2, ..search };
    assert!(matches!(excite(&tree, &limits(&tree), &none), Err(ExcitationError::Search(_))));
}
