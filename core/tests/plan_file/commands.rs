//! The law that follows a plan.

use crate::common::{Random, assert_close};
use crate::sample::{MODEL, Sample};
use leastaction_core::plan::{CommandError, Plan};
use std::f64::consts::TAU;

/// The deviation of a state from the plan, entry by entry of (q, v), and the command for it by the formula.
fn naive(plan: &Plan<3, 2>, tick: u32, deviation: [[f64; 3]; 2]) -> [f64; 2] {
    let reference = plan.reference(tick);
    let mut u = reference.u.map(f64::from);
    for (u, gain) in u.iter_mut().zip(reference.gain) {
        for (gain, x) in [gain.q, gain.v].as_flattened().iter().zip(deviation.as_flattened()) {
            *u -= f64::from(*gain) * x;
        }
    }
    u
}

/// The state with this deviation, its angles turned by whole turns.
fn state(plan: &Plan<3, 2>, tick: u32, [q, v]: [[f64; 3]; 2], turns: [i32; 3]) -> [[f32; 3]; 2] {
    let reference = plan.reference(tick);
    let at = |i: usize| f64::from(reference.q[i]) + q[i] + TAU * f64::from(turns[i]);
    [[at(0), at(1), at(2)].map(|q| q as f32), [0, 1, 2].map(|i| (f64::from(reference.v[i]) + v[i]) as f32)]
}

#[test]
fn commands_are_those_of_the_formula() {
    let mut random = Random(7);
    for seed in 0..20 {
        let file = Sample::random(seed).file();
        let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
        for tick in 0..25 {
            // Coordinate 0 is a length; the differences of angles stay short of half a turn.
            let deviation = [random.array(3.0), random.array(10.0)];
            let turns = [0, (random.bits() % 7) as i32 - 3, (random.bits() % 7) as i32 - 3];
            let [q, v] = state(&plan, tick, deviation, turns);
            let found = plan.command(tick, &q, &v).unwrap();
            let expected = naive(&plan, tick, deviation);
            for (found, expected) in found.into_iter().zip(expected) {
                assert_close("u", found.into(), expected, 1e-5);
            }
            assert_eq!(plan.force(tick, &q, &v), Ok([found[0], 0.0, found[1]]));
        }
    }
}

#[test]
fn a_state_on_the_plan_has_the_planned_command() {
    let file = Sample::random(3).file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    for tick in 0..25 {
        let reference = plan.reference(tick);
        assert_eq!(plan.command(tick, &reference.q, &reference.v), Ok(reference.u));
        assert_eq!(plan.planned_force(tick), [reference.u[0], 0.0, reference.u[1]]);
    }
}

/// An angle and a driven length, one node, with these positions, and the gains (1, 1, 0, 0).
fn facing(q: [f32; 2]) -> Sample {
    let record = [q[0], q[1], 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0];
    Sample { nodes: 1, limits: vec![[-100.0, 100.0]], records: [record; 2].concat(), ..Sample::golden() }
}

#[test]
fn differences_of_angles_go_the_short_way() {
    let across = 6.2 - TAU;
    for (planned, measured, difference) in [(3.1, -3.1, -across), (-3.1, 3.1, across)] {
        let file = facing([planned, 0.0]).file();
        let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
        let [u] = plan.command(0, &[measured, 0.0], &[0.0; 2]).unwrap();
        assert_close("across half a turn", u.into(), -difference, 1e-6);
        // A length of the same numbers has the whole difference.
        let file = facing([0.0, planned]).file();
        let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
        assert_eq!(plan.command(0, &[0.0, measured], &[0.0; 2]), Ok([planned - measured]));
    }
}

#[test]
fn whole_turns_are_those_off_the_start() {
    let file = facing([0.5, -0.25]).file();
    let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
    let turn = std::f32::consts::TAU;
    let turns = plan.turns(&[0.75 + 2.0 * turn, -0.5 - turn], &[true, true]);
    assert_close("turns", turns[0].into(), 2.0 * TAU, 1e-6);
    assert_close("turns", turns[1].into(), -TAU, 1e-6);
    assert_eq!(plan.turns(&[0.75 + 2.0 * turn, -0.5 - turn], &[false, true])[0], 0.0);
    assert_eq!(plan.turns(&[0.75, -0.5], &[true, true]), [0.0; 2]);
}

#[test]
fn commands_stay_within_their_limits() {
    let mut sample = facing([0.0, 0.0]);
    sample.limits = vec![[-0.5, 0.25]];
    let file = sample.file();
    let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
    for (q, u) in [(-0.125, 0.125), (-0.25, 0.25), (-9.0, 0.25), (0.5, -0.5), (9.0, -0.5), (-1e38, 0.25)] {
        assert_eq!(plan.command(0, &[0.0, q], &[0.0; 2]), Ok([u]), "{q}");
    }
    // A planned command is limited, too.
    sample.records[4] = 7.0;
    let file = sample.file();
    let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
    assert_eq!(plan.command(0, &[0.0; 2], &[0.0; 2]), Ok([0.25]));
}

#[test]
fn states_must_be_finite() {
    let file = Sample::random(4).file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for coordinate in 0..3 {
            for (index, quantity) in ['q', 'v'].into_iter().enumerate() {
                let mut x = [[0.0; 3]; 2];
                x[index][coordinate] = bad;
                let error = plan.command(5, &x[0], &x[1]).unwrap_err();
                assert_eq!(plan.force(5, &x[0], &x[1]).unwrap_err().to_string(), error.to_string());
                let CommandError::NotFinite { value, .. } = error else { panic!("{error:?}") };
                assert_eq!(value.to_bits(), bad.to_bits());
                let text = format!("the measured {quantity} of coordinate {coordinate} is {bad}");
                assert!(error.to_string().starts_with(&text), "{error}");
            }
        }
    }
}

#[test]
fn a_command_that_single_precision_does_not_hold_is_an_error() {
    let mut sample = Sample::random(5);
    // Gains of the second driven coordinate, number 2: their sum is ∞ − ∞.
    sample.records[14..16].copy_from_slice(&[3e38, -3e38]);
    sample.angles = vec![0; 3];
    let file = sample.file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    let error = plan.command(0, &[50.0, 50.0, 0.0], &[0.0; 3]).unwrap_err();
    assert_eq!(error, CommandError::Overflow { coordinate: 2 });
    assert!(error.to_string().contains("coordinate 2"));
}
