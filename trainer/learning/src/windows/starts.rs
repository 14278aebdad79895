//! The start states that are best for given numbers, window by window.

use super::rollout::{In, Lanes};
use leastaction_programs::steps::{State, Steps};
use leastaction_programs::{Row, WIDTH};

/// What changes a sum by less than this part of it is as good as nothing.
const NOTHING: f64 = 1e-3;
/// By which a step that does not lower the sum is shortened.
const SHORTER: f64 = 0.25;

/// Gauss–Newton steps from start states, until they hardly change anything, each window on its own; a step that raises its sum is taken
/// back and shortened.
pub(super) fn solved(lanes: &Lanes, stepper: &mut dyn Steps, starts: &State, iterations: usize) -> State {
    let count = starts.len();
    let mut linearise = |starts: &State| {
        let (mut rows, sums) = lanes.rows(stepper, starts, In::Starts);
        (rows.eliminate(count), sums)
    };
    let mut best = starts.clone();
    let (mut step, mut sums) = linearise(&best);
    let mut part = Row::splat(1.0);
    for _ in 0..iterations {
        let mut trial = best.clone();
        trial.iter_mut().zip(&step).for_each(|(x, step)| x.add_product(&part, step));
        let (next, after) = linearise(&trial);
        let matters = |lane: usize| (after.0[lane] - sums.0[lane]).abs() > NOTHING * sums.0[lane];
        let is_done = !(0..WIDTH).any(matters);
        for lane in 0..WIDTH {
            let lower = after.0[lane] < sums.0[lane] || (sums.0[lane].is_nan() && !after.0[lane].is_nan());
            if !lower {
                part.0[lane] *= SHORTER;
                continue;
            }
            (sums.0[lane], part.0[lane]) = (after.0[lane], 1.0);
            best.iter_mut().zip(&trial).for_each(|(x, trial)| x.0[lane] = trial.0[lane]);
            step.iter_mut().zip(&next).for_each(|(x, next)| x.0[lane] = next.0[lane]);
        }
        if is_done {
            break;
        }
    }
    best
}

/// One Gauss–Newton step from start states, where it lowers the sum of a window, and Σρ of every window then.
pub(super) fn stepped(lanes: &Lanes, stepper: &mut dyn Steps, starts: &State) -> (State, Row) {
    let (mut rows, mut sums) = lanes.rows(stepper, starts, In::Starts);
    let step = rows.eliminate(starts.len());
    let (mut best, mut trial) = (starts.clone(), starts.clone());
    trial.iter_mut().zip(&step).for_each(|(x, step)| x.add_scaled(1.0, step));
    let after = lanes.sums(stepper, &trial);
    for lane in 0..WIDTH {
        // Not a number before where the window could not be computed.
        if sums.0[lane].is_nan() || after.0[lane] < sums.0[lane] {
            sums.0[lane] = after.0[lane];
            best.iter_mut().zip(&trial).for_each(|(x, trial)| x.0[lane] = trial.0[lane]);
        }
    }
    (best, sums)
}
