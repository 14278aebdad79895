//! The demo of an arm with six joints: from its description and a log of torques to a motion that the firmware follows.

mod robot;

use super::{Demo, MARK, say, write_model};
use crate::commands::simulate::{
    self, Floats, LawName, MpcArgs, PlanArgs, Plant, Request, Scenario, Trace, TrackArgs, World, simulate,
};
use crate::commands::train;
use leastaction::cli::{Done, Failure, Output, written};
use leastaction::evaluation::{Torques, torques};
use leastaction_learning::{atomic, data};
use leastaction_models::Model;
use leastaction_models::file::decode;
use leastaction_plot::{Panel, Series, Stroke, time_series};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Configuration of everything that the description does not contain: the log, and the numbers to learn.
const CONFIG: &str = r#"
[data]
file = "log.npz"
validation = 0

[model]
family = "arm"
urdf = "arm.urdf"                 # the log is of an arm that is heavier, and that has friction
friction = { viscous = "learned", coulomb = "learned" }
"#;
/// Bandwidth ω of the feedback of both controllers, rad/s.
const BANDWIDTH: f32 = 60.0;

/// Number of ticks of which the plots show one.
const SHOWN: usize = 20;

/// Results of the demo.
#[derive(Serialize)]
pub struct Report {
    out: PathBuf,
    seconds: f64,
    samples: usize,
    training: train::Report,
    model: PathBuf,
    model_bytes: usize,
    #[serde(flatten)]
    torques: Torques,
    computed_torque: simulate::Report,
    pd_gravity: simulate::Report,
    pictures: Vec<PathBuf>,
}

/// Runs the demo.
pub fn run(demo: &Demo, output: Output) -> Done {
    let report = steps(demo, output)?;
    output.report(&report)?;
    report.computed_torque.judge()
}

fn steps(demo: &Demo, output: Output) -> Result<Report, Failure> {
    let started = Instant::now();
    let at = |name: &str| demo.out.join(name);
    let say = |step: &str| say(output, &started, step);
    let text = |name: &str, text: &str| {
        atomic::write(&at(name), text.as_bytes()).map_err(|error| Failure::file(&at(name), error))
    };
    say("generate: an arm of six joints in motion, heavier than it is described, with friction and noise");
    text("arm.urdf", robot::DESCRIPTION)?;
    text(super::CONFIG, &format!("{MARK}{CONFIG}"))?;
    let (log, unseen) = (robot::log(demo.seed, 0)?, robot::log(demo.seed, 1)?);
    data::write(at("log.npz"), &log).map_err(written)?;
    data::write(at("unseen.npz"), &unseen).map_err(written)?;
    say("train: bodies, rotors and friction, from torques");
    let training = demo.train(&at(super::CONFIG), &at("run"), output)?;
    say("export: the weights as a model file, and as Rust source");
    let (model, model_bytes) = write_model(&at("run"), &at("arm.postcard"), &at("arm.rs"))?;
    let torques = torques(&model, &unseen).ok_or_else(|| Failure::Work("the log is too short".to_owned()))?;
    robot::draw_torques(&at("torques.svg"), &model, demo.seed, &unseen)?;
    say("simulate: a motion followed in the firmware loop, by the model and by PD with gravity compensation");
    let plant = robot::plant()?;
    atomic::write(&at("plant.postcard"), &plant)
        .map_err(|error| Failure::file(&at("plant.postcard"), error))?;
    let plant = decode(&plant).map_err(|error| Failure::Work(error.to_string()))?;
    text("motion.toml", &robot::motion(demo.seed))?;
    let follow = |law, name: &str| {
        let motion = TrackArgs::along(at("motion.toml"), law, BANDWIDTH);
        follow(
            (&model, &at("arm.postcard")),
            (&plant, &at("plant.postcard")),
            &motion,
            (demo.seed, &at(name)),
        )
    };
    let (computed_torque, by_model) = follow(LawName::ComputedTorque, "track")?;
    let (pd_gravity, by_pd) = follow(LawName::PdGravity, "track-pd")?;
    draw_errors(&at("errors.svg"), [&by_model, &by_pd])?;
    Ok(Report {
        out: demo.out.clone(),
        seconds: started.elapsed().as_secs_f64(),
        samples: log.samples(),
        pictures: vec![at("torques.svg"), computed_torque.picture.clone(), at("errors.svg")],
        training,
        model: at("arm.postcard"),
        model_bytes,
        torques,
        computed_torque,
        pd_gravity,
    })
}

fn follow(
    (model, file): (&Model, &Path),
    (plant, plant_file): (&Model, &Path),
    motion: &TrackArgs,
    (seed, name): (u64, &Path),
) -> Result<(simulate::Report, Trace), Failure> {
    let request = Request {
        model,
        plant: Plant::Model { file: plant_file, model: plant },
        scenario: Scenario::Track,
        seed,
        seconds: None,
        tick: None,
        world: &World::default(),
        motion,
        floats: &Floats::default(),
        follows: &PlanArgs::default(),
        decides: &MpcArgs::default(),
        adaptive: None,
        plans: &[],
        config: None,
        on: None,
    };
    simulate(file, &request, [name.with_extension("csv"), name.with_extension("svg")])
}

/// Plots the tracking error over time: the root mean square over the joints.
fn draw_errors(file: &Path, [by_model, by_pd]: [&Trace; 2]) -> Result<(), Failure> {
    let curve = |label: &str, trace: &Trace| {
        let point = |row: &simulate::Row| {
            let square =
                row.q.iter().zip(&row.reference).map(|(q, wanted)| (q - wanted).powi(2)).sum::<f32>();
            (f64::from(row.time), 1e3 * f64::from((square / row.q.len() as f32).sqrt()))
        };
        Series::new(label, trace.rows.iter().step_by(SHOWN).map(point))
    };
    let series = [
        curve("PD and gravity compensation", by_pd).with_stroke(Stroke::Wide),
        curve("inverse dynamics of the model, and PD", by_model),
    ];
    let title = format!("A motion of six joints followed, feedback of {BANDWIDTH} rad/s");
    time_series(file, &title, &[Panel::new("error (mrad)", &series)])
        .map_err(|error| Failure::Work(error.to_string()))
}

/// Tracking error, root mean square over the joints, mrad.
fn mrad(report: &simulate::Report) -> f32 {
    let square = report.rms_error.iter().map(|error| error * error).sum::<f32>();
    1e3 * (square / report.rms_error.len() as f32).sqrt()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let line = |f: &mut fmt::Formatter, name: &str, value: String| writeln!(f, "{name:<34} {value}");
        line(f, "logged", format!("{} samples of q, v and torques", self.samples))?;
        let Self { training, torques, computed_torque, pd_gravity, .. } = self;
        line(f, "learned", format!("{} numbers", training.learned_parameters))?;
        line(f, "model file", format!("{} bytes", self.model_bytes))?;
        line(
            f,
            "torques of motion not seen",
            format!("squared error over variance {:.1e}", torques.torque_nmse),
        )?;
        line(
            f,
            "motion followed, error",
            format!(
                "{:.2} mrad by the model, {:.2} mrad by PD and gravity",
                mrad(computed_torque),
                mrad(pd_gravity)
            ),
        )?;
        line(f, "trace hash", computed_torque.trace_hash.clone())?;
        line(f, "all of it took", format!("{:.1} s", self.seconds))?;
        writeln!(f, "\nModel: {}. Trace: {}.", self.model.display(), computed_torque.trace.display())?;
        let pictures: Vec<_> = self.pictures.iter().map(|picture| picture.display().to_string()).collect();
        writeln!(f, "Pictures: {}", pictures.join(", "))
    }
}
