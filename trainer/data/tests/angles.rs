//! Angles given within one turn are unwrapped; everything else is unchanged.

use std::f64::consts::{PI, TAU};
use std::slice::from_ref;

use leastaction_data::{Dataset, Note, Rows, Trajectory};
use proptest::prelude::*;

/// Trajectories of one column each.
fn data(columns: &[Vec<f64>]) -> Dataset {
    let one = |(id, q): (i64, &Vec<f64>)| Trajectory {
        id,
        t0: 0.0,
        q: Rows::from_flat(1, q.clone()).unwrap(),
        v: None,
        a: None,
        u: None,
    };
    Dataset { n: 1, h: 0.01, control: None, trajectories: (0..).zip(columns).map(one).collect() }
}

/// Wraps an angle to [−π, π).
fn wrapped(q: f64) -> f64 {
    (q + PI).rem_euclid(TAU) - PI
}

fn spin(samples: usize, step: f64) -> Vec<f64> {
    (0..samples).map(|k| 0.3 + step * k as f64).collect()
}

/// The columns after unwrapping, and the notes.
fn unwrapped(columns: &[Vec<f64>], letter: &str) -> (Vec<Vec<f64>>, Vec<Note>) {
    let mut data = data(columns);
    let notes = data.unwrap_angles(letter);
    (data.trajectories.iter().map(|t| t.q.as_flat().to_vec()).collect(), notes)
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64]) {
    assert!(found.len() == expected.len(), "{found:?}");
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
}

#[test]
fn an_angle_goes_on_across_the_seam() {
    for (step, seams) in [(0.1, 3), (-0.1, 3), (1.5, 48), (-1.5, 48), (2.0, 63), (-2.8, 89)] {
        let straight = spin(200, step);
        for range in [wrapped, |q: f64| q.rem_euclid(TAU), |q: f64| (q - 1.0).rem_euclid(TAU) + 1.0] {
            let (found, notes) = unwrapped(&[straight.iter().map(|q| range(*q)).collect()], "a");
            let turns = ((found[0][0] - straight[0]) / TAU).round() * TAU;
            let expected: Vec<f64> = straight.iter().map(|q| q + turns).collect();
            assert_close(&found[0], &expected);
            let Note::Seams { coordinate: 0, cyclic: false, seams: found, trajectories } = &notes[0] else {
                panic!("{notes:?}")
            };
            assert!(found.abs_diff(seams) <= 1 && trajectories == &[0], "{notes:?}");
        }
    }
}

#[test]
fn to_and_fro_over_the_seam_is_no_turn() {
    let straight: Vec<f64> = (0..50).map(|k| PI + 0.01 * f64::from(k % 2) - 0.005).collect();
    let (found, _) = unwrapped(&[straight.iter().map(|q| wrapped(*q)).collect()], "a");
    assert_close(&found[0], &straight);
}

#[test]
fn what_is_no_seam_stays() {
    let jump = |size: f64| vec![0.0, 0.1, 0.2, 0.2 + size, 0.3 + size, 0.4 + size];
    let turning_fast: Vec<f64> = (0..9).map(|k| f64::from(k) * 6.0).collect();
    let whirling = vec![0.0, 2.9, 6.1, 10.9, 14.0, 16.9];
    let whipped = vec![0.0, 1.0, 2.0, 7.1, 8.0, 9.0];
    let straight = spin(500, 0.3);
    for column in [
        jump(1.0),
        jump(-3.2),
        jump(4.5),
        jump(8.0),
        jump(-12.6),
        jump(360.0),
        turning_fast,
        whirling,
        whipped,
        straight,
    ] {
        assert_eq!(unwrapped(from_ref(&column), "a"), (vec![column], vec![]));
    }
}

#[test]
fn only_angles_are_unwrapped() {
    let column: Vec<f64> = spin(99, 0.2).into_iter().map(wrapped).collect();
    for letters in ["t", ""] {
        assert_eq!(unwrapped(from_ref(&column), letters), (vec![column.clone()], vec![]));
    }
    let (_, notes) = unwrapped(&[column], "aaaa");
    assert_eq!(notes.len(), 1);
}

#[test]
fn a_cyclic_coordinate_is_an_angle_where_it_moves_as_one() {
    let straight = spin(99, 0.2);
    for range in [wrapped, |q: f64| q.rem_euclid(TAU)] {
        let (found, notes) = unwrapped(&[straight.iter().map(|q| range(*q)).collect()], "c");
        assert_close(&found[0], &straight);
        assert!(matches!(notes[..], [Note::Seams { cyclic: true, seams: 3, .. }]), "{notes:?}");
    }
    // A length that was reset.
    let track = vec![6.9, 7.0, 7.1, 0.9, 1.0, 1.1];
    assert_eq!(unwrapped(from_ref(&track), "c"), (vec![track], vec![]));
}

#[test]
fn the_note_says_where() {
    let column: Vec<f64> = spin(99, 0.2).into_iter().map(wrapped).collect();
    let note = |columns: &[Vec<f64>], letter: &str| unwrapped(columns, letter).1[0].to_string();
    let once = vec![3.0, 3.1, -3.1, -3.0];
    assert_eq!(
        note(from_ref(&once), "a"),
        "q0 jumps by 2π 1 time, in trajectory 0; whole turns were added there, so that it goes on across the seam"
    );
    let many = note(&[column.clone(), once.clone(), vec![0.0; 3], once.clone()], "a");
    assert!(many.starts_with("q0 jumps by 2π 5 times, in trajectories 0, 1, 3; "), "{many}");
    let cyclic = note(&vec![once; 7], "c");
    let expected = "q0, a cyclic coordinate taken for an angle, jumps by 2π 7 times, in 7 trajectories 0, 1, 2, 3, 4, …; ";
    assert!(cyclic.starts_with(expected), "{cyclic}");
}

#[test]
fn columns_are_taken_one_by_one() {
    let angle: Vec<f64> = spin(99, 0.2).into_iter().map(wrapped).collect();
    let both = angle.iter().flat_map(|q| [*q, *q]).collect();
    let mut data = data(&[vec![0.0; 3]]);
    data.n = 2;
    data.trajectories[0].q = Rows::from_flat(2, both).unwrap();
    let notes = data.unwrap_angles("ta");
    assert!(matches!(notes[..], [Note::Seams { coordinate: 1, .. }]), "{notes:?}");
    let q = &data.trajectories[0].q;
    assert_eq!(q.column(0).collect::<Vec<_>>(), angle);
    assert_close(&q.column(1).collect::<Vec<_>>(), &spin(99, 0.2));
}

proptest! {
    /// Any motion whose steps differ by less than a quarter turn is restored, up to whole turns.
    #[test]
    fn what_was_wrapped_comes_back(steps in prop::collection::vec(-0.75..0.75, 3..60), mean in -2.2..2.2, start in -9.0..9.0) {
        let straight: Vec<f64> = steps
            .iter()
            .scan(start, |q, step| {
                *q += mean + step;
                Some(*q)
            })
            .collect();
        let (found, _) = unwrapped(&[straight.iter().map(|q| wrapped(*q)).collect()], "a");
        let turns = found[0][0] - straight[0];
        prop_assert!(((turns / TAU).round() * TAU - turns).abs() < 1e-9);
        prop_assert!(found[0].iter().zip(&straight).all(|(a, b)| (a - b - turns).abs() < 1e-9));
    }
}
