//! Logs of the competition's pendulum as a robot writes them, and the model that is learned from them.

use super::model::{Model, failed, pendulum_of};
use super::plant::DoublePendulum;
use super::policy::{ControlError, Robot, TORQUE_LIMIT};
use crate::hardware::configured::trained;
use crate::task::{TaskError, Tell};
use leastaction_ground_truth::robot::{
    Drives, Excitation, Joint, JointFriction, Linkage, Machine, RobotSettings, Sensors, StartSpread,
    robot_logs, write_csv,
};
use leastaction_learning::config::Config;
use leastaction_models::Model as Bodies;
use std::f64::consts::TAU;
use std::path::Path;

/// Number of logs, samples in each, and time between them, s.
const LOGS: usize = 10;
const SAMPLES: usize = 1001;
const STEP: f64 = 0.01;
/// Count of an encoder of 12 bits, rad; largest deviation of a sample from its time, s; deviation of the torque from its command, N m.
const COUNT: f64 = TAU / 4096.0;
const JITTER: f64 = 0.001;
const TORQUE_NOISE: f64 = 0.1;
/// Number of sines of a command, whose sum stays within the limit.
const SINES: usize = 3;
/// Seed of the logs.
const SEED: u64 = 100;

/// Configuration of the training, but for its files, torques and friction. The upper link is measured; masses are any, since motion shows
/// only their sums with other numbers.
const TRAINING: &str = r#"
step = 0.01
validation = 0.0

[data.columns]
t = "time"
q = ["pos_meas1", "pos_meas2"]
u = TORQUES

[model]
family = "bodies"

[[model.bodies]]
mass = 0.5

[[model.bodies]]
on = 0
at = [0.2, 0.0]
mass = 0.6
FRICTION
[training]
loss = "windows"
"#;
/// Columns of commanded and of measured torques.
const COMMANDED: &str = r#"["tau_con1", "tau_con2"]"#;
const MEASURED: &str = r#"["tau_meas1", "tau_meas2"]"#;
/// Friction of real joints.
const FRICTION: &str = "\n[model.friction]\nviscous = \"learned\"\ncoulomb = \"learned\"\n";

/// Learns the pendulum of a robot from ten logs of 10 s: encoders of 12 bits, sampling times that jitter, a noisy torque of the one drive within
/// the limit.
///
/// # Errors
/// [`ControlError::Policy`] if a log cannot be written or nothing can be learned.
pub fn learned(robot: Robot, note: &(dyn Fn(&str) + Sync)) -> Result<Model, ControlError> {
    let bodies = from_simulated(robot, (LOGS, SAMPLES), note).map_err(failed)?;
    Model::of_bodies("learned", bodies)
}

/// Learns the pendulum from the logs of the real robot in a folder, its friction too, which is then left out: the simulated one has none.
///
/// # Errors
/// [`ControlError::Policy`] if a log cannot be read or nothing can be learned.
pub fn from_real(folder: &Path, note: &(dyn Fn(&str) + Sync)) -> Result<DoublePendulum, ControlError> {
    let work = tempfile::tempdir().map_err(failed)?;
    let bodies = from_logs(folder, (MEASURED, FRICTION), (work.path(), note)).map_err(failed)?;
    pendulum_of(&bodies)
}

/// Learns the pendulum of a robot from some simulated logs with a number of samples.
pub(super) fn from_simulated(
    robot: Robot,
    size: (usize, usize),
    note: &(dyn Fn(&str) + Sync),
) -> Result<Bodies, TaskError> {
    let folder = tempfile::tempdir()?;
    let logs = robot_logs(&settings(robot, size))?;
    for (k, log) in logs.logs.iter().enumerate() {
        write_csv(&folder.path().join(format!("{k:02}.csv")), log)?;
    }
    let tell = |line: &str| note(&format!("{}: {line}", robot.name()));
    from_logs(folder.path(), (COMMANDED, ""), (folder.path(), &tell))
}

/// Learns a pendulum from all logs in a folder, in a folder for work.
fn from_logs(
    logs: &Path,
    (torques, friction): (&str, &str),
    (work, note): (&Path, &Tell),
) -> Result<Bodies, TaskError> {
    let files = std::path::absolute(logs)?.join("*.csv").display().to_string();
    let training = TRAINING.replace("TORQUES", torques).replace("FRICTION", friction);
    let config = Config::parse(&format!("[data]\nfile = {files:?}{training}"), &work.join("train.toml"))?;
    Ok(trained(config, (work, false), note)?.trained.model())
}

/// The robot that is logged.
fn settings(robot: Robot, (logs, samples): (usize, usize)) -> RobotSettings {
    let none = JointFriction { viscous: 0.0, coulomb: 0.0, width: 1.0 };
    RobotSettings {
        machine: Machine::Linkage(linkage(&DoublePendulum::competition())),
        friction: vec![none; 2],
        sensors: Sensors { noise: 0.0, grid: COUNT, zeros: 0.0, jitter: JITTER },
        drives: Drives {
            gain: vec![1.0; 2],
            delay: 0.0,
            noise: TORQUE_NOISE,
            driven: robot.torques(1.0).map(|u| u > 0.0).to_vec(),
        },
        excitation: Excitation {
            sines: SINES,
            frequency: [0.2, 1.5],
            amplitude: [0.5, (TORQUE_LIMIT - 4.0 * TORQUE_NOISE) / SINES as f64],
        },
        start: StartSpread { q: 1.5, v: 0.0 },
        logs,
        samples,
        h: STEP,
        seed: SEED,
    }
}

/// The links of a pendulum without rotors.
fn linkage(of: &DoublePendulum) -> Linkage {
    let joint = |k: usize| {
        let (mass, length, centre) = (of.mass[k], of.length[k], of.centre[k]);
        let inertia = of.inertia[k] - mass * centre * centre;
        Joint { length, centre, inertia, ..Joint::point(mass, length) }
    };
    Linkage { gravity: of.gravity, joints: vec![joint(0), joint(1)] }
}
