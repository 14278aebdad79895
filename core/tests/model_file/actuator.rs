//! The actuator between command and force: its inverse, and the moments of the signal that a delay keeps.

use crate::common::forces::actuator;
use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::discrete::Control;
use leastaction_core::forces::Actuator;

#[test]
fn an_actuator_scales_shifts_and_inverts() {
    let mut random = Random(9);
    for _ in 0..100 {
        let actuator = Actuator { gain: random.array::<3>(2.0), offset: random.array(2.0), delay: 0.0 };
        let (u, before) = (random.array(5.0), random.array(5.0));
        let tau = actuator.output(&u);
        for i in 0..3 {
            assert_close("τ", tau[i], actuator.gain[i] * u[i] + actuator.offset[i], 0.0);
        }
        assert_vectors_close("u", &actuator.command(&tau), &u, 1e-10);
        let at_once = actuator.held(&before, &u);
        assert_eq!((at_once.start, at_once.end), (tau, tau), "without a delay the older command is over");
        let whole = Actuator { delay: 1.0, ..actuator }.held(&before, &u);
        assert_eq!(whole, Control::held(actuator.output(&before)), "a whole step late is the older command");
        let linear = actuator.linear(&before, &u, &random.array(5.0));
        assert_vectors_close("at the start", &linear.start, &tau, 1e-14);
    }
    let ideal = Actuator::<f64, 2>::ideal();
    assert_eq!((ideal.output(&[1.0, -2.0]), ideal.command(&[1.0, -2.0])), ([1.0, -2.0], [1.0, -2.0]));
    assert_eq!(ideal.held(&[9.0; 2], &[1.0, -2.0]), Control::held([1.0, -2.0]));
    let samples = ideal.linear(&[9.0; 2], &[1.0, -2.0], &[3.0, 0.5]);
    assert_eq!(samples, Control { start: [1.0, -2.0], end: [3.0, 0.5] });
}

/// ∫τ ds and ∫sτ ds over the step, s from 0 to 1, by Simpson's rule on both sides of the jump or bend: exact for a signal that is linear on
/// each side.
fn moments(delay: f64, tau: impl Fn(f64, bool) -> f64) -> [f64; 2] {
    let piece = |from: f64, to: f64, late: bool| {
        let middle = f64::midpoint(from, to);
        let points = [(from, 1.0), (middle, 4.0), (to, 1.0)].map(|(s, weight)| (s, weight * tau(s, late)));
        let sum = |f: fn(f64) -> f64| points.iter().map(|(s, tau)| f(*s) * tau).sum::<f64>();
        [sum(|_| 1.0), sum(|s| s)].map(|sum| sum * (to - from) / 6.0)
    };
    let (early, late) = (piece(0.0, delay, false), piece(delay, 1.0, true));
    [early[0] + late[0], early[1] + late[1]]
}

fn assert_same_moments(
    name: &str,
    control: &Control<f64, 2>,
    delay: f64,
    signal: impl Fn(usize, f64, bool) -> f64,
) {
    for i in 0..2 {
        let expected = moments(delay, |s, late| signal(i, s, late));
        let found = moments(0.5, |s, _| control.at(s)[i]);
        assert_vectors_close(name, &found, &expected, 1e-13);
    }
}

#[test]
fn a_delayed_command_keeps_impulse_and_moment() {
    let mut random = Random(10);
    for delay in [0.0, 0.1, 0.25, 0.5, 0.77, 0.9, 1.0] {
        let actuator = actuator(delay);
        for _ in 0..20 {
            let [before, start, end] = core::array::from_fn(|_| random.array::<2>(5.0));
            let held = actuator.held(&before, &start);
            assert_same_moments("held", &held, delay, |i, _, late| {
                actuator.output(if late { &start } else { &before })[i]
            });
            let linear = actuator.linear(&before, &start, &end);
            assert_same_moments("linear", &linear, delay, |i, s, late| {
                // u(s − d), linear between the samples at −1, 0 and 1.
                let at = s - delay;
                let u: [f64; 2] = core::array::from_fn(|i| {
                    let rate = if late { end[i] - start[i] } else { start[i] - before[i] };
                    start[i] + at * rate
                });
                actuator.output(&u)[i]
            });
        }
    }
}
