//! Scores of runs: the policy's, and that of a single swing-up.

use super::disturbance::{Disturber, Schedule, limited};
use super::plant::DoublePendulum;
use super::policy::{Policy, Robot, TICK};
use super::simulation::{Course, simulate};
use std::f64::consts::PI;

/// Duration of the policy's run, s.
pub const POLICY_SECONDS: f64 = 60.0;
/// Duration of a single swing-up, s.
pub const SINGLE_SECONDS: f64 = 10.0;

/// Part of the time in which the tip is up: Σ dt of its samples over the duration; the first sample has no dt.
pub fn time_up(course: &Course, seconds: f64) -> f64 {
    course.up.iter().skip(1).filter(|up| **up).count() as f64 * TICK / seconds
}

/// A policy's run under the disturbances of a seed.
///
/// Both joints are driven in it: the torque of the passive joint is 0 except during a disturbance.
pub fn policy_course(
    pendulum: &DoublePendulum,
    robot: Robot,
    policy: &mut dyn Policy,
    seed: u64,
    seconds: f64,
) -> Course {
    policy.reset();
    let mut disturber = Disturber::new(Schedule::draw(seed));
    simulate(pendulum, seconds, |t, states| {
        let [q1, q2, v1, v2] = states[states.len() - 1];
        let disturbed = disturber.torques(t, [q1, q2], pendulum);
        disturbed.unwrap_or_else(|| robot.torques(limited(policy.torque(t, [q1, q2], [v1, v2]))))
    })
}

/// Terms of a single swing-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingUp {
    /// Time after which the tip stays up to the end, s; `None` if it does not.
    pub time: Option<f64>,
    /// Energy Σ|Δq_i τ_i|, J.
    pub energy: f64,
    /// Cost of torques Σ|τ|² dt, N² m² s.
    pub torque_cost: f64,
    /// Sum over the joints of the standard deviation of successive torque differences, N m.
    pub smoothness: f64,
    /// Cost of velocities Σ|v|² dt, rad²/s.
    pub velocity_cost: f64,
}

impl SwingUp {
    /// Terms of a course.
    pub fn of(course: &Course) -> Self {
        let samples = course.up.len();
        let stays = course.up.iter().rev().take_while(|up| **up).count();
        let ticks = || course.states.windows(2).zip(&course.torques);
        let energy = |i: usize| ticks().map(|(x, tau)| ((x[1][i] - x[0][i]) * tau[i]).abs()).sum::<f64>();
        let square = |x: f64, y: f64| (x * x + y * y) * TICK;
        Self {
            time: (stays > 0).then(|| (samples - stays) as f64 * TICK),
            energy: energy(0) + energy(1),
            torque_cost: course.torques.iter().map(|[tau1, tau2]| square(*tau1, *tau2)).sum(),
            smoothness: roughness(course, 0) + roughness(course, 1),
            velocity_cost: ticks().map(|(x, _)| square(x[0][2], x[0][3])).sum(),
        }
    }

    /// Score success · (1 − ⅕ Σ tanh(π c/n)).
    pub fn score(&self) -> f64 {
        let Some(time) = self.time else { return 0.0 };
        let Self { energy, torque_cost, smoothness, velocity_cost, .. } = *self;
        let terms = [time, energy, torque_cost, smoothness, velocity_cost];
        let falls = terms.iter().zip(NORMS).map(|(term, norm)| (PI * term / norm).tanh());
        1.0 - falls.sum::<f64>() / 5.0
    }

    /// Slopes −∂score/∂c of all terms but time.
    pub fn slopes(&self) -> Slopes {
        let slope = |term: f64, norm: f64| {
            let fall = (PI * term / norm).tanh();
            PI / norm * (1.0 - fall * fall) / 5.0
        };
        let [_, energy, torque, smoothness, velocity] = NORMS;
        Slopes {
            energy: slope(self.energy, energy),
            torque: slope(self.torque_cost, torque),
            smoothness: slope(self.smoothness, smoothness),
            velocity: slope(self.velocity_cost, velocity),
        }
    }
}

/// Norms n of time, energy, cost of torques, smoothness and cost of velocities.
const NORMS: [f64; 5] = [20.0, 60.0, 20.0, 0.1, 400.0];

/// Slopes of the score: its fall per unit of a term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes {
    /// Per J.
    pub energy: f64,
    /// Per N² m² s.
    pub torque: f64,
    /// Per N m.
    pub smoothness: f64,
    /// Per rad²/s.
    pub velocity: f64,
}

/// Standard deviation of the successive differences of a joint's torque.
fn roughness(course: &Course, joint: usize) -> f64 {
    let differences = || course.torques.windows(2).map(|tau| tau[1][joint] - tau[0][joint]);
    let count = differences().count().max(1) as f64;
    let mean = differences().sum::<f64>() / count;
    (differences().map(|d| (d - mean) * (d - mean)).sum::<f64>() / count).sqrt()
}

/// A single swing-up from hanging at rest, undisturbed.
pub fn swing_up_course(pendulum: &DoublePendulum, robot: Robot, policy: &mut dyn Policy) -> Course {
    policy.reset();
    simulate(pendulum, SINGLE_SECONDS, |t, states| {
        let [q1, q2, v1, v2] = states[states.len() - 1];
        robot.torques(limited(policy.torque(t, [q1, q2], [v1, v2])))
    })
}
