//! Logs as robots write them: joints with friction, drives with delay and gain, encoders with quantisation, noise and zero offsets, stamps
//! with jitter. The truth behind every log is known.
//!
//! ```text
//! u_k = Σ a sin(2πft_k + φ)   at the sampling instants t_k = kh + jitter, held until the next
//! M v̇ = L_q − L_vq v + τ − b v − c tanh(v/ε),   τ(t) = g u(t − d), u = 0 before t_0
//! q̃_k = grid · round((q(t_k) + z + σ noise)/grid),   z one number for every encoder and log
//! ```
//!
//! The motion is integrated by Runge–Kutta steps of at most 0.25 ms, shorter if friction is stiff, from one change of τ
//! to the next. Every kind of random number has its own stream for every log, so changing the noise does not change the
//! motion, and adding a log does not change the others.

mod csv;
mod linkage;
mod settings;
mod simulate;
mod sines;

pub use csv::{CSV_HEAD, write_csv};
pub use linkage::{Joint, Linkage, MOST_JOINTS};
pub use settings::{
    Drives, Excitation, JointFriction, Machine, RobotError, RobotSettings, Sensors, StartSpread,
};
pub use sines::Sines;

use leastaction_core::forces::ControlKind;
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::parallel;
use simulate::Robot;

/// A log with its truth, one row per sample.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// Number of the log, from 0.
    pub id: i64,
    /// Sampling times, which are also the stamps, s.
    pub times: Vec<f64>,
    /// Encoder readings q̃, rad or m.
    pub readings: Rows,
    /// Commands u, given at each sample and held until the next, N or N m.
    pub commands: Rows,
    /// Torques τ that act immediately after each sample, N or N m.
    pub torques: Rows,
    /// True positions, rad or m.
    pub q: Rows,
    /// True velocities, rad/s or m/s.
    pub v: Rows,
    /// True accelerations immediately after each sample, rad/s² or m/s².
    pub a: Rows,
    /// Zero offset z of every encoder in this log, rad or m.
    pub zeros: Vec<f64>,
}

/// Logs of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLogs {
    /// Number of coordinates.
    pub n: usize,
    /// Mean time between samples, s.
    pub h: f64,
    /// The logs in order.
    pub logs: Vec<RobotLog>,
}

/// Drives a robot and logs it; each log has its own start and control.
///
/// # Errors
/// [`RobotError`] for settings out of range, and for a motion that diverges.
pub fn robot_logs(settings: &RobotSettings) -> Result<RobotLogs, RobotError> {
    settings.check()?;
    match settings.machine.coordinates() {
        1 => logs::<1>(settings),
        2 => logs::<2>(settings),
        3 => logs::<3>(settings),
        4 => logs::<4>(settings),
        joints => Err(RobotError::Joints { joints }),
    }
}

fn logs<const N: usize>(settings: &RobotSettings) -> Result<RobotLogs, RobotError> {
    let terms = settings.machine.terms::<N>()?;
    let robot = Robot::new(settings, &terms)?;
    let logs = parallel::map(settings.logs, &|id| robot.log(id)).into_iter().collect::<Result<_, _>>()?;
    Ok(RobotLogs { n: N, h: settings.h, logs })
}

impl RobotLogs {
    /// The measurements: readings and commands, at stamps without jitter.
    #[must_use]
    pub fn measured(&self) -> Dataset {
        self.dataset(|log| Trajectory { v: None, a: None, q: log.readings.clone(), ..log.truth() })
    }

    /// The truth: exact positions, velocities and accelerations, and the commands.
    #[must_use]
    pub fn truth(&self) -> Dataset {
        self.dataset(RobotLog::truth)
    }

    fn dataset(&self, trajectory: impl Fn(&RobotLog) -> Trajectory) -> Dataset {
        let trajectories = self.logs.iter().map(trajectory).collect();
        Dataset { n: self.n, h: self.h, control: Some(ControlKind::Held), trajectories }
    }
}

impl RobotLog {
    fn truth(&self) -> Trajectory {
        Trajectory {
            id: self.id,
            t0: 0.0,
            q: self.q.clone(),
            v: Some(self.v.clone()),
            a: Some(self.a.clone()),
            u: Some(self.commands.clone()),
        }
    }

    /// Velocities as a drive computes them, from the previous reading and the stamps; the first is 0; rad/s or m/s.
    pub fn differences(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        (0..self.times.len()).map(|k| {
            let before = k.saturating_sub(1);
            let time = self.times[k] - self.times[before];
            let readings = [k, before].map(|k| self.readings.get(k).unwrap_or_default());
            let difference = |(now, before): (&f64, &f64)| if k == 0 { 0.0 } else { (now - before) / time };
            readings[0].iter().zip(readings[1]).map(difference).collect()
        })
    }
}

#[cfg(test)]
mod tests;
