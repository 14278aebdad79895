//! The last chapter of the demo: an acrobot is learned from a robot's logs, its swing-up is planned, and the firmware's program follows the plan.

use super::{Demo, MARK, write_model};
use crate::commands::simulate::{
    self, Floats, MpcArgs, PlanArgs, Plant, Request, Scenario, TrackArgs, World, of_model, simulate,
};
use crate::commands::{plan, train};
use leastaction::cli::{Failure, Output, folder, written};
use leastaction_ground_truth::Mechanism;
use leastaction_ground_truth::robot::{
    Drives, Excitation, JointFriction, Machine, RobotSettings, Sensors, StartSpread, robot_logs,
};
use leastaction_learning::{atomic, data};
use leastaction_models::Model;
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt;
use std::path::{Path, PathBuf};

/// Configuration of the training: two links in the plane, one of them weighed; everything else is learned.
const TRAINING: &str = include_str!("acrobot.toml");
/// Configuration of the plan, from hanging to upright.
const PLAN: &str = include_str!("acrobot-plan.toml");
/// Dry friction of shoulder and elbow, N m, and the width of its change of sign, rad/s.
const COULOMB: [f64; 2] = [0.1, 0.07];
const WIDTH: f64 = 0.05;
/// Delay of the drive, s.
const DELAY: f64 = 0.006;
/// Count of an encoder of 12 bits, and standard deviation of its noise, rad.
const COUNT: f64 = TAU / 4096.0;
const NOISE: f64 = 1e-3;
/// Number of logs, samples in each, and time between samples, s.
const LOGS: usize = 6;
const SAMPLES: usize = 301;
const STEP: f64 = 0.01;

/// Results of the chapter.
#[derive(Serialize)]
pub struct Report {
    samples: usize,
    training: train::Report,
    model: PathBuf,
    model_bytes: usize,
    plan: plan::Report,
    swing_up: simulate::Report,
}

impl Report {
    /// Run of the firmware's program.
    pub fn swing_up(&self) -> &simulate::Report {
        &self.swing_up
    }

    /// Pictures and pages to look at.
    pub fn pictures(&self) -> impl Iterator<Item = &Path> {
        [self.plan.page(), &self.swing_up.picture].into_iter().chain(self.swing_up.moving.as_deref())
    }
}

/// Runs the chapter; `say` announces its steps.
pub fn run(demo: &Demo, output: Output, say: impl Fn(&str)) -> Result<Report, Failure> {
    let home = demo.out.join("acrobot");
    folder(&home)?;
    let at = |name: &str| home.join(name);
    let text = |name: &str, text: &str| {
        atomic::write(&at(name), text.as_bytes()).map_err(|error| Failure::file(&at(name), error))
    };
    say("generate: logs of an acrobot, driven at the elbow alone, with friction, noise and delay");
    let logs = robot_logs(&settings(demo.seed)).map_err(|error| Failure::Work(error.to_string()))?;
    let log = logs.measured();
    data::write(at("log.npz"), &log).map_err(written)?;
    text(super::CONFIG, &format!("{MARK}{TRAINING}"))?;
    say("train: its links, its friction and its drive's delay, from two encoders and the commands");
    let training = demo.train(&at(super::CONFIG), &at("run"), output)?;
    let (model, model_bytes) = write_model(&at("run"), &at("model.postcard"), &at("model.rs"))?;
    say("plan: the swing-up, by the learned model");
    text("plan.toml", PLAN)?;
    let (plan, verdict) = plan::Plan::of(at("plan.toml"), home.clone()).make(output)?;
    verdict?;
    say("simulate: the firmware's program follows the plan, and holds its end");
    let swing_up = follow(&model, &home, demo.seed)?;
    let (samples, model) = (log.samples(), at("model.postcard"));
    Ok(Report { samples, training, model, model_bytes, plan, swing_up })
}

/// The robot that is logged; the shoulder has no drive.
fn settings(seed: u64) -> RobotSettings {
    let friction = COULOMB.map(|coulomb| JointFriction { viscous: 0.0, coulomb, width: WIDTH });
    RobotSettings {
        machine: Machine::Named(Mechanism::Acrobot),
        friction: friction.to_vec(),
        sensors: Sensors { noise: NOISE, grid: COUNT, zeros: 0.0, jitter: 0.0 },
        drives: Drives { gain: vec![1.0; 2], delay: DELAY, noise: 0.0, driven: vec![false, true] },
        excitation: Excitation { sines: 3, frequency: [0.2, 1.5], amplitude: [1.0, 5.0] },
        start: StartSpread { q: 1.5, v: 0.0 },
        logs: LOGS,
        samples: SAMPLES,
        h: STEP,
        seed,
    }
}

/// Lets the firmware's program follow the plan on the robot.
fn follow(model: &Model, home: &Path, seed: u64) -> Result<simulate::Report, Failure> {
    let file = home.join("model.postcard");
    let bytes = std::fs::read(&file).map_err(|error| Failure::file(&file, error))?;
    let follows = PlanArgs::along(home.join("plan.postcard"));
    let files = follows.read()?;
    let plans = of_model(&files, &bytes)?;
    let request = Request {
        model,
        plant: Plant::Exact(Mechanism::Acrobot),
        scenario: Scenario::Follow,
        seed,
        seconds: None,
        tick: None,
        world: &World::dry_and_late(COULOMB.to_vec(), WIDTH, DELAY),
        motion: &TrackArgs::default(),
        floats: &Floats::default(),
        follows: &follows,
        decides: &MpcArgs::default(),
        adaptive: None,
        plans: &plans,
        config: None,
        on: None,
    };
    let (report, _) = simulate(&file, &request, [home.join("trace.csv"), home.join("swing-up.svg")])?;
    Ok(report)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { samples, training, model_bytes, plan, swing_up, .. } = self;
        let line = |f: &mut fmt::Formatter, name: &str, value: String| writeln!(f, "{name:<34} {value}");
        line(f, "an acrobot, logged", format!("{LOGS} logs, {samples} samples of two encoders"))?;
        line(f, "learned", format!("{} numbers in {:.1} s", training.learned_parameters, training.seconds))?;
        line(f, "model file", format!("{model_bytes} bytes"))?;
        line(f, "swing-up planned", plan.summary())?;
        let followed = swing_up.planned.as_ref();
        followed.map_or(Ok(()), |followed| write!(f, "{}", followed.told(swing_up.success)))
    }
}
