//! States of the training logs, for losses that need single states or a step ahead.

use super::grid::STEP;
use super::log::Log;
use super::polynomial::Polynomial;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::training::Samples;

/// Number of samples on each side from which a smoothed state is taken, and the degree of the polynomial through them.
const SMOOTHED: (usize, usize) = (4, 3);

/// Converts logs to trajectories with the grid's step: positions, the drives' velocities, measured torques.
pub(super) fn dataset(logs: &[&Log]) -> Dataset {
    let n = logs.first().map_or(1, |log| log.joints());
    let trajectory = |(id, log): (i64, &&Log)| Trajectory {
        id,
        t0: 0.0,
        q: log.q.clone(),
        v: Some(log.v.clone()),
        a: None,
        u: Some(log.measured.clone()),
    };
    Dataset { n, h: STEP, control: None, trajectories: (0..).zip(logs).map(trajectory).collect() }
}

/// Returns positions, velocities and accelerations of cubics through nine samples, with the mean of the torque before and after.
pub(super) fn smoothed(logs: &[&Log]) -> Samples {
    let n = logs.first().map_or(1, |log| log.joints());
    let mut samples = Samples { n, h: STEP, ..Samples::default() };
    let (half, degree) = SMOOTHED;
    let cubic = Polynomial::new(half, degree, STEP);
    for log in logs {
        for start in 0..(log.samples() + 1).saturating_sub(cubic.samples()) {
            let state = cubic.at(&log.q, start);
            samples.states.iter_mut().zip(state).for_each(|(all, own)| all.extend(own));
            let torque = mean(&log.measured, start + half);
            samples.controls.iter_mut().for_each(|all| all.extend(&torque));
        }
    }
    samples
}

/// Mean of the torques of the steps before and after a sample.
fn mean(torques: &Rows, sample: usize) -> Vec<f64> {
    let of = |k: usize| torques.get(k).unwrap_or_default();
    of(sample - 1).iter().zip(of(sample)).map(|(before, after)| 0.5 * (before + after)).collect()
}
