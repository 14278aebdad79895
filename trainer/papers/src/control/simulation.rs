//! Runs of the simulator.

use super::plant::{DoublePendulum, State};
use super::policy::TICK;

/// Course of a run: K ticks between K + 1 samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// State of every sample.
    pub states: Vec<State>,
    /// Torques of both joints, N m, held over every tick.
    pub torques: Vec<[f64; 2]>,
    /// Flags of the samples whose tip is high.
    pub up: Vec<bool>,
}

/// Part of the greatest height above which the tip is up.
const UP: f64 = 0.9;

/// Whether the tip is up.
pub fn is_up(pendulum: &DoublePendulum, x: State) -> bool {
    pendulum.tip(x) > UP * pendulum.length.iter().sum::<f64>()
}

/// Runs the pendulum from hanging at rest. `torques` gives the torques of both joints, N m, from the time at the start of a tick, s, and all
/// states so far. A run ends early when a state is not finite.
///
/// The clock is a sum of ticks, as in DFKI's `Simulator`; its length is counted in ticks, whereas `Simulator.simulate` takes one more where
/// the sum's rounding is below the end.
pub fn simulate(
    pendulum: &DoublePendulum,
    seconds: f64,
    mut torques: impl FnMut(f64, &[State]) -> [f64; 2],
) -> Course {
    let ticks = (seconds / TICK).round() as usize;
    let mut course = Course { states: vec![[0.0; 4]], torques: Vec::new(), up: vec![false] };
    let (mut t, mut x) = (0.0, [0.0; 4]);
    for _ in 0..ticks {
        let tau = torques(t, &course.states);
        x = pendulum.step(x, tau, TICK);
        t += TICK;
        course.states.push(x);
        course.torques.push(tau);
        course.up.push(is_up(pendulum, x));
        if x.iter().any(|x| !x.is_finite()) {
            break;
        }
    }
    course
}
