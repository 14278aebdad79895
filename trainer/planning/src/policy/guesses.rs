//! Start guesses that need no library.

use super::Setting;
use crate::interior::FreeMotion;
use leastaction_core::control::Plant;
use std::array::from_fn;
use std::f64::consts::TAU;

/// Goals that differ by whole turns from the one next to `near`, the nearest first.
pub fn turned<const D: usize>(near: &[f64; D], turns: &[bool; D]) -> Vec<[f64; D]> {
    let mut goals = vec![*near];
    for i in (0..D).filter(|i| turns[*i]) {
        let moved =
            |turn: f64| goals.iter().map(move |goal| from_fn(|j| goal[j] + if j == i { turn } else { 0.0 }));
        let others: Vec<_> = moved(-TAU).chain(moved(TAU)).collect();
        goals.extend(others);
    }
    goals
}

/// The cubic motion from a state to a goal, both velocities being met, without commands.
pub fn cubic<const D: usize, const M: usize>(
    start: &[f64; D],
    goal: &[f64; D],
    (nodes, seconds): (usize, f64),
) -> FreeMotion<D, M> {
    let n = D / 2;
    let at = |k: usize| -> [f64; D] {
        let s = k as f64 / nodes as f64;
        from_fn(|i| {
            let (i, velocity) = (i % n, i >= n);
            let (v0, v1) = (start[n + i], goal[n + i]);
            let w = (goal[i] - start[i]) / seconds;
            let (b, c) = (3.0 * w - 2.0 * v0 - v1, v0 + v1 - 2.0 * w);
            if velocity {
                v0 + s * (2.0 * b + 3.0 * s * c)
            } else {
                start[i] + s * seconds * (v0 + s * (b + s * c))
            }
        })
    };
    FreeMotion { x: (0..nodes).map(at).collect(), u: vec![[0.0; M]; nodes], end: *goal }
}

/// Part of the limits that the law of a coasting motion uses.
const COASTING: f64 = 0.9;

/// The motion from a state under commands that feed the velocities back with a gain in limits per unit: with a negative one the drives brake.
pub fn coasting<P: Plant<f64, D, M>, const D: usize, const M: usize>(
    setting: &Setting<P, D, M>,
    start: &[f64; D],
    nodes: usize,
    gain: f64,
) -> Option<FreeMotion<D, M>> {
    let (mut motion, mut x) = (setting.plant.begin(start).ok()?, *start);
    let mut free = FreeMotion { x: Vec::new(), u: Vec::new(), end: x };
    for _ in 0..nodes {
        let u = braking(setting, &x, gain);
        free.x.push(x);
        free.u.push(u);
        x = setting.plant.advance(&mut motion, (setting.ticks, &u), &mut [0.0; D]).ok()?;
    }
    free.end = x;
    Some(free)
}

/// Commands that feed the velocities back.
pub fn braking<P: Plant<f64, D, M>, const D: usize, const M: usize>(
    setting: &Setting<P, D, M>,
    x: &[f64; D],
    gain: f64,
) -> [f64; M] {
    let aim = &setting.aim;
    from_fn(|j| {
        let share = (gain * x[D / 2 + j] / aim.unit[D / 2 + j]).clamp(-COASTING, COASTING);
        let [least, most] = [aim.controls.least[j], aim.controls.most[j]];
        0.5 * (least + most) + 0.5 * share * (most - least)
    })
}

/// A motion over another number of nodes, its velocities scaled by the change of time.
pub fn resampled<const D: usize, const M: usize>(
    motion: &FreeMotion<D, M>,
    nodes: usize,
) -> FreeMotion<D, M> {
    let count = motion.x.len();
    let faster = count as f64 / nodes as f64;
    let state = |k: usize| -> [f64; D] {
        let place = k as f64 * faster;
        let (low, part) = (place as usize, place.fract());
        let (x, next) = (motion.x[low.min(count - 1)], motion.x.get(low + 1).unwrap_or(&motion.end));
        from_fn(|i| {
            let x = x[i] + part * (next[i] - x[i]);
            if i < D / 2 { x } else { x * faster }
        })
    };
    let command = |k: usize| motion.u[((k as f64 * faster) as usize).min(count - 1)];
    FreeMotion { x: (0..nodes).map(state).collect(), u: (0..nodes).map(command).collect(), end: motion.end }
}
