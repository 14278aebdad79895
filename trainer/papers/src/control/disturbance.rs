//! Disturbances of the policy's run: a PID takes the pendulum to a random posture.

use super::plant::DoublePendulum;
use super::policy::TORQUE_LIMIT;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::array::from_fn;
use std::f64::consts::PI;

/// Number of disturbances of a run.
const COUNT: usize = 15;
/// Mean time of the first and the last disturbance, s.
const TIMES: [f64; 2] = [3.75, 56.25];
/// Duration of a disturbance, s.
const DURATION: f64 = 0.2;
/// Gains of the PID: N m/rad, N m/(rad s), N m s/rad.
const GAINS: [f64; 3] = [10.0, 0.1, 1.0];
/// Tick for which the PID was written, s; it is called every 0.002 s.
const PID_TICK: f64 = 0.001;

/// Disturbances of a run, drawn before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Time at which each begins, s, and its posture, rad.
    pub disturbances: Vec<(f64, [f64; 2])>,
}

impl Schedule {
    /// Draws postures, each angle uniform in ±π, and then times.
    pub fn draw(seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let postures: [[f64; 2]; COUNT] = from_fn(|_| from_fn(|_| random.random_range(-PI..PI)));
        let apart = (TIMES[1] - TIMES[0]) / (COUNT - 1) as f64;
        let time = |k: usize| TIMES[0] + apart * k as f64 + random.random_range(-1.0..1.0);
        Self { disturbances: (0..COUNT).map(time).zip(postures).collect() }
    }
}

/// PID that remembers all errors of its life.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pid {
    calls: usize,
    sum: [f64; 2],
    last: [f64; 2],
}

impl Pid {
    /// Torques towards a posture, N m, within the limit. Angles are not wrapped; the errors of former postures stay in I, and the first D
    /// after a change of posture is the jump between them.
    pub fn torques(&mut self, posture: [f64; 2], q: [f64; 2]) -> [f64; 2] {
        let [kp, ki, kd] = GAINS;
        let error: [f64; 2] = from_fn(|i| posture[i] - q[i]);
        self.calls += 1;
        self.sum = from_fn(|i| self.sum[i] + error[i]);
        let has_slope = self.calls > 2;
        let slope = |i: usize| if has_slope { (error[i] - self.last[i]) / PID_TICK } else { 0.0 };
        let torques = from_fn(|i| limited(kp * error[i] + ki * self.sum[i] * PID_TICK + kd * slope(i)));
        self.last = error;
        torques
    }
}

/// A torque within ±6 N m.
pub fn limited(tau: f64) -> f64 {
    tau.clamp(-TORQUE_LIMIT, TORQUE_LIMIT)
}

/// Disturber of a run. The order of its decisions in a tick is that of DFKI's `GlobalPolicyTestingControllerV2`: a disturbance begins, or one
/// whose clock is over ends; then its torques are computed; then the time since the last call is added to its clock.
#[derive(Clone, Debug)]
pub struct Disturber {
    schedule: Schedule,
    /// Number of disturbances that have begun.
    begun: usize,
    active: bool,
    clock: f64,
    last: f64,
    pid: Pid,
}

impl Disturber {
    /// Before the run.
    pub fn new(schedule: Schedule) -> Self {
        Self { schedule, begun: 0, active: false, clock: 0.0, last: 0.0, pid: Pid::default() }
    }

    /// Torques of both joints at time t, s, and positions q; `None` if the policy is asked.
    pub fn torques(&mut self, t: f64, q: [f64; 2], pendulum: &DoublePendulum) -> Option<[f64; 2]> {
        let next = self.schedule.disturbances.get(self.begun);
        if !self.active && next.is_some_and(|(time, _)| t >= *time) {
            (self.active, self.clock) = (true, 0.0);
            self.begun += 1;
        }
        if self.clock > DURATION {
            self.active = false;
        }
        let torques = self.active.then(|| self.towards_posture(q, pendulum));
        if self.active {
            self.clock += t - self.last;
        }
        self.last = t;
        torques
    }

    fn towards_posture(&mut self, q: [f64; 2], pendulum: &DoublePendulum) -> [f64; 2] {
        let posture = self.schedule.disturbances[self.begun - 1].1;
        let (pid, held) = (self.pid.torques(posture, q), pendulum.holding_torque(q));
        from_fn(|i| limited(pid[i] + held[i]))
    }
}
