//! The lag between command and force: its closed form against a fine integration, its derivatives, and properties.

use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::forces::{Actuator, Lag, Lagging, Rise};

const LAGS: [f64; 8] = [0.01, 0.08, 0.4, 0.499, 0.501, 1.0, 8.0, 300.0];
const DELAYS: [f64; 5] = [0.0, 0.3, 0.5, 0.77, 1.0];

/// End of y, its mean and its moment over the step by Runge–Kutta steps of order 4 on both sides of the jump or bend.
fn integrated(lag: f64, delay: f64, y: f64, command: impl Fn(f64, bool) -> f64) -> [f64; 3] {
    let mut state = [y, 0.0, 0.0];
    for (from, to, late) in [(0.0, delay, false), (delay, 1.0, true)] {
        const PIECES: usize = 4_000;
        let h = (to - from) / PIECES as f64;
        for k in 0..PIECES {
            let start = from + k as f64 * h;
            let rate = |s: f64, x: [f64; 3]| [(command(s, late) - x[0]) / lag, x[0], s * x[0]];
            let moved = |by: f64, rate: [f64; 3]| core::array::from_fn(|i| state[i] + by * rate[i]);
            let first = rate(start, state);
            let second = rate(start + 0.5 * h, moved(0.5 * h, first));
            let third = rate(start + 0.5 * h, moved(0.5 * h, second));
            let fourth = rate(start + h, moved(h, third));
            let mean = |i: usize| (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]) / 6.0;
            state = core::array::from_fn(|i| state[i] + h * mean(i));
        }
    }
    state
}

/// End, mean and moment of a line.
fn of(Lagging { mean, slope, end }: Lagging<f64>) -> [f64; 3] {
    [end, mean, 0.5 * mean + slope / 12.0]
}

#[test]
fn a_step_keeps_end_impulse_and_moment() {
    let mut random = Random(21);
    for (lag, delay) in LAGS.into_iter().flat_map(|lag| DELAYS.map(|delay| (lag, delay))) {
        let own = Lag::new(lag, delay);
        let [y, before, start, end] = random.array::<4>(5.0);
        let expected = integrated(lag, delay, y, |_, late| if late { start } else { before });
        assert_vectors_close("held", &of(own.held(y, before, start)), &expected, 1e-10);
        let expected = integrated(lag, delay, y, |s, late| {
            start + (s - delay) * if late { end - start } else { start - before }
        });
        assert_vectors_close("linear", &of(own.linear(y, [before, start, end])), &expected, 1e-10);
    }
}

/// A lag vanishes with T: the line is the one of the delay alone.
#[test]
fn without_a_time_constant_it_is_the_delay() {
    let mut random = Random(22);
    for delay in DELAYS {
        let actuator = Actuator { gain: [1.0], offset: [0.0], delay };
        let [y, before, start, end] = random.array::<4>(5.0);
        for (lag, most) in [(0.0, 1e-13), (1e-9, 1e-7)] {
            let own = Lag::new(lag, delay);
            let held = actuator.held(&[before], &[start]);
            assert_vectors_close(
                "held",
                &own.held(y, before, start).line(),
                &[held.start[0], held.end[0]],
                most,
            );
            let linear = actuator.linear(&[before], &[start], &[end]);
            let found = own.linear(y, [before, start, end]);
            assert_vectors_close("linear", &found.line(), &[linear.start[0], linear.end[0]], most);
            let arrived = end - delay * (end - start);
            assert_close("end", found.end, if delay < 1.0 { arrived } else { start }, 1e-7);
        }
    }
}

#[test]
fn integrals_have_their_derivatives() {
    let near = |name: &str, own: [f64; 4], of: &dyn Fn(f64) -> [f64; 4]| {
        let (more, less) = (of(1.0), of(-1.0));
        let slopes: [f64; 4] = core::array::from_fn(|k| 0.5 * (more[k] - less[k]));
        assert_vectors_close(name, &own, &slopes, 1e-8);
    };
    for (lag, time) in LAGS.into_iter().flat_map(|lag| [0.05, 0.3, 0.97, 1.0].map(|time| (lag, time))) {
        let (rise, by) = (Rise::new(lag, time), 1e-5);
        let scaled = |of: Rise<f64>, by: f64| of.integrals.map(|own| by * own);
        let step = by * lag;
        near("by T", scaled(rise.by_lag(lag, time), step), &|side| {
            Rise::new(lag + side * step, time).integrals
        });
        let step = by * time;
        near("by time", scaled(rise.by_time(lag), step), &|side| {
            Rise::new(lag, time + side * step).integrals
        });
    }
    let at_once = Rise::new(0.0, 0.4).by_lag(0.0, 0.4).integrals;
    assert_vectors_close("at T = 0", &at_once, &[0.0, -1.0, -0.4, -0.08], 1e-15);
}

#[test]
fn single_precision_is_enough_for_any_time_constant() {
    let mut random = Random(23);
    for lag in [1e-30, 1e-4, 0.03, 0.45, 0.55, 3.0, 77.0, 1e4, 1e30] {
        for delay in DELAYS {
            let commands = random.array::<4>(5.0).map(|u| f64::from(u as f32));
            let ([y, before, start, _], narrow) = (commands, commands.map(|u| u as f32));
            let (wide, own) = (Lag::new(lag, delay), Lag::new(lag as f32, delay as f32));
            let numbers = |Lagging { mean, slope, end }: Lagging<f32>| [mean, slope, end].map(f64::from);
            let Lagging { mean, slope, end } = wide.held(y, before, start);
            let found = numbers(own.held(narrow[0], narrow[1], narrow[2]));
            assert_vectors_close("held", &found, &[mean, slope, end], 3e-5);
            let Lagging { mean, slope, end } = wide.linear(y, [commands[1], commands[2], commands[3]]);
            let found = numbers(own.linear(narrow[0], [narrow[1], narrow[2], narrow[3]]));
            assert_vectors_close("linear", &found, &[mean, slope, end], 3e-5);
        }
    }
}

/// A command that has always been the same acts as it is, to the last bit; y stays between the commands; two half steps end where one whole
/// step does.
#[test]
fn y_follows_the_commands() {
    let mut random = Random(24);
    for (lag, delay) in LAGS.into_iter().flat_map(|lag| DELAYS.map(|delay| (lag, delay))) {
        let own = Lag::new(lag, delay);
        let [y, before, now, _] = random.array::<4>(5.0);
        let still = Lagging { mean: y, slope: 0.0, end: y };
        assert_eq!((own.held(y, y, y), own.linear(y, [y; 3])), (still, still));
        let Lagging { mean, end, .. } = own.held(y, before, now);
        let [least, most] = [y.min(before).min(now) - 1e-12, y.max(before).max(now) + 1e-12];
        assert!([mean, end].iter().all(|y| (least..=most).contains(y)), "{mean} and {end}");
        let half = Lag::new(2.0 * lag, 0.0);
        let [first, second] = [(y, now), (half.held(y, now, now).end, now)].map(|(y, u)| half.held(y, u, u));
        let whole = Lag::new(lag, 0.0).held(y, now, now);
        assert_close("end", second.end, whole.end, 1e-13);
        assert_close("mean", 0.5 * (first.mean + second.mean), whole.mean, 1e-13);
    }
}
