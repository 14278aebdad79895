//! The plan between its records.

use crate::common::assert_close;
use crate::sample::{MODEL, Sample};
use leastaction_core::plan::{Gain, Plan, Reference};

/// The record of a node, read by hand.
fn record(sample: &Sample, node: usize) -> Reference<3, 2> {
    let x = &sample.records[20 * node..20 * (node + 1)];
    let three = |i: usize| [x[i], x[i + 1], x[i + 2]];
    Reference {
        q: three(0),
        v: three(3),
        u: [x[6], x[7]],
        gain: [8, 14].map(|i| Gain { q: three(i), v: three(i + 3) }),
    }
}

#[test]
fn nodes_begin_with_their_records() {
    let sample = Sample::random(1);
    let file = sample.file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    assert_eq!(plan.ticks(), 20);
    assert_close("seconds", plan.seconds().into(), 0.2, 1e-7);
    for node in 0..=5 {
        assert_eq!(plan.reference(4 * node), record(&sample, node as usize));
    }
    for tick in [21, 23, 24, 1000, u32::MAX] {
        assert_eq!(plan.reference(tick), record(&sample, 5));
    }
}

#[test]
fn commands_are_held_and_gains_are_linear() {
    let sample = Sample::random(2);
    let file = sample.file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    for tick in 0..20 {
        let (node, s) = (tick as usize / 4, f64::from(tick % 4) / 4.0);
        let (found, start, end) = (plan.reference(tick), record(&sample, node), record(&sample, node + 1));
        assert_eq!(found.u, start.u);
        for row in 0..2 {
            let between = |a: f32, b: f32| f64::from(a) + s * (f64::from(b) - f64::from(a));
            for i in 0..3 {
                let ([found, start, end], name) = ([&found, &start, &end].map(|x| x.gain[row]), "gain");
                assert_close(name, found.q[i].into(), between(start.q[i], end.q[i]), 2e-7);
                assert_close(name, found.v[i].into(), between(start.v[i], end.v[i]), 2e-7);
            }
        }
    }
}

/// Position and velocity of a cubic motion at t seconds.
fn cubic([a, b, c, d]: [f64; 4], t: f64) -> [f64; 2] {
    [a + t * (b + t * (c + t * d)), b + t * (2.0 * c + t * 3.0 * d)]
}

/// Plans of a cubic motion, sampled by nodes of several lengths.
#[test]
fn a_cubic_motion_is_reproduced() {
    let motion = [[0.5, -1.0, 2.0, -0.75], [-3.0, 4.0, 0.25, 1.5]];
    for (ticks_per_node, nodes) in [(1, 12), (2, 6), (3, 4), (12, 1)] {
        let (h, mut records) = (0.125, Vec::new());
        for node in 0..=nodes {
            let t = h * f64::from(node * ticks_per_node);
            let [x, y] = motion.map(|motion| cubic(motion, t));
            records.extend([x[0], y[0], x[1], y[1], 0.0, 0.0, 0.0, 0.0, 0.0].map(|x| x as f32));
        }
        let sample = Sample { h: h as f32, ticks_per_node, nodes, records, ..Sample::golden() };
        let file = sample.file();
        let plan = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap();
        assert_eq!(plan.seconds(), 1.5);
        for tick in 0..=12 {
            let found = plan.reference(tick);
            for (i, motion) in motion.into_iter().enumerate() {
                let [q, v] = cubic(motion, h * f64::from(tick));
                assert_close("q", found.q[i].into(), q, 1e-6);
                assert_close("v", found.v[i].into(), v, 2e-6);
            }
        }
    }
}

/// Between ticks as on them, and at rest in acceleration beyond both ends.
#[test]
fn the_motion_is_that_of_the_references() {
    let sample = Sample::random(4);
    let file = sample.file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    for tick in 0..20_u8 {
        let (found, [q, v, _]) = (plan.reference(tick.into()), plan.motion(0.01 * f32::from(tick)));
        for i in 0..3 {
            assert_close("q", q[i].into(), found.q[i].into(), 1e-5);
            assert_close("v", v[i].into(), found.v[i].into(), 1e-4);
        }
        // Velocity and acceleration are the slopes of what comes before them, within a node.
        let at = |t: f32| plan.motion(0.01 * (f32::from(tick) + t));
        let ([q0, v0, _], [_, v, a], [q1, v1, _]) = (at(0.25), at(0.5), at(0.75));
        for i in 0..3 {
            assert_close("v", v[i].into(), f64::from(q1[i] - q0[i]) / 0.005, 0.02);
            assert_close("a", a[i].into(), f64::from(v1[i] - v0[i]) / 0.005, 1e-3);
        }
    }
    let (start, end) = (record(&sample, 0), record(&sample, 5));
    for before in [-1.0, f32::NEG_INFINITY] {
        assert_eq!(plan.motion(before), [start.q, start.v, [0.0; 3]]);
    }
    for after in [0.2001, 7.0, f32::INFINITY] {
        assert_eq!(plan.motion(after), [end.q, end.v, [0.0; 3]]);
    }
}

/// The plan's own angles are continuous: between 3 and 3.5 rad lies 3.25 rad, not an angle wrapped to ±π.
#[test]
fn planned_angles_pass_half_a_turn() {
    let mut sample = Sample { ticks_per_node: 2, nodes: 1, h: 0.25, ..Sample::golden() };
    sample.records.truncate(18);
    for (node, q) in [3.0, 3.5].into_iter().enumerate() {
        sample.records[9 * node] = q;
        sample.records[9 * node + 2] = 1.0;
    }
    let file = sample.file();
    let found = Plan::<2, 1>::load(file.bytes(), MODEL).unwrap().reference(1);
    assert_eq!((found.q[0], found.v[0]), (3.25, 1.0));
}

#[test]
fn a_time_at_a_tick_is_the_tick() {
    let mut sample = Sample::random(4);
    // A tick whose products round up and down.
    (sample.h, sample.ticks_per_node) = (0.1, 3);
    let file = sample.file();
    let plan = Plan::<3, 2>::load(file.bytes(), MODEL).unwrap();
    for tick in 0..20 {
        let (found, expected) = (plan.reference_at(tick as f32 * 0.1), plan.reference(tick));
        assert_eq!(found.u, expected.u, "tick {tick}");
        for i in 0..3 {
            assert_close("q", found.q[i].into(), expected.q[i].into(), 1e-5);
            assert_close("gain", found.gain[1].v[i].into(), expected.gain[1].v[i].into(), 1e-5);
        }
        let (q, v) = ([0.5, -1.0, 2.0], [1.0, 0.25, -3.0]);
        let at = [plan.force_at(tick as f32 * 0.1, &q, &v), plan.force(tick, &q, &v)].map(Result::unwrap);
        for (found, expected) in at[0].into_iter().zip(at[1]) {
            assert_close("u", found.into(), expected.into(), 1e-4);
        }
    }
    // The middle between two ticks is on the motion; before the start and from the end on are the first and the last record.
    let [q, v, _] = plan.motion(0.45);
    assert_eq!((plan.reference_at(0.45).q, plan.reference_at(0.45).v), (q, v));
    for t in [-1.0, f32::NEG_INFINITY, f32::NAN] {
        assert_eq!(plan.reference_at(t), plan.reference(0));
    }
    for t in [1.5, 2.0, f32::INFINITY] {
        assert_eq!(plan.reference_at(t), plan.reference(15));
    }
}
