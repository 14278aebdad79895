//! The best start states for given numbers, window by window.

use super::rollout::{In, Lanes};
use leastaction_programs::steps::{State, Steps};
use leastaction_programs::{Row, WIDTH};

/// Relative change of a sum that is negligible.
const NOTHING: f64 = 1e-3;
/// Factor that shortens a step that does not lower the sum.
const SHORTER: f64 = 0.25;

/// Gauss–Newton steps of start states until they hardly change. Each window is treated on its own: a step that raises
/// its sum is undone and shortened.
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

/// Takes one Gauss–Newton step of start states, which a window keeps if it lowers the window's sum; also returns Σρ of
/// every window afterwards.
pub(super) fn stepped(lanes: &Lanes, stepper: &mut dyn Steps, starts: &State) -> (State, Row) {
    let (mut rows, mut sums) = lanes.rows(stepper, starts, In::Starts);
    let step = rows.eliminate(starts.len());
    let (mut best, mut trial) = (starts.clone(), starts.clone());
    trial.iter_mut().zip(&step).for_each(|(x, step)| x.add_scaled(1.0, step));
    let after = lanes.sums(stepper, &trial);
    for lane in 0..WIDTH {
        // The sum before the step is NaN if the window could not be computed.
        if sums.0[lane].is_nan() || after.0[lane] < sums.0[lane] {
            sums.0[lane] = after.0[lane];
            best.iter_mut().zip(&trial).for_each(|(x, trial)| x.0[lane] = trial.0[lane]);
        }
    }
    (best, sums)
}
