//! `leastaction demo`.

mod acrobot;
mod arm;
mod portrait;

use super::simulate::{
    self, Floats, MpcArgs, PlanArgs, Plant, Request, Scenario, TrackArgs, World, simulate,
};
use super::{interrupt, train};
use clap::{Args, ValueEnum};
use leastaction::cli::arguments::seed;
use leastaction::cli::{Done, Failure, Output, folder, written};
use leastaction::models::encoded;
use leastaction_ground_truth::{Mechanism, Settings, generate};
use leastaction_learning::config::Config;
use leastaction_learning::run::{Ending, Run};
use leastaction_learning::{atomic, data};
use leastaction_models::Model;
use leastaction_models::config::{Coordinates, InertiaNetworkConfig};
use leastaction_models::file::{Precision, decode};
use portrait::{Forecast, forecast};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// From logged motion to a controller, in under a minute.
///
/// Logs the motion of a cart-pole, learns its energies from positions and forces alone, exports the weights as a model file, and swings the
/// pole up in the firmware loop with a controller that knows only the model. Then an acrobot, two links with a drive between them alone, is
/// learned from logs with noise, friction and delay, its swing-up is planned, and the firmware's program follows the plan. An earlier demo
/// in the folder is replaced.
///
/// `demo arm` starts from the description of an arm with six joints and a log of its torques: bodies, rotors and friction are learned, and
/// a motion is followed in the firmware loop by the model's inverse dynamics, compared with PD and gravity compensation.
#[derive(Args)]
pub struct Demo {
    /// The machine.
    #[arg(value_enum, default_value_t = Machine::Cartpole)]
    machine: Machine,
    /// The folder to write to.
    #[arg(long, default_value = "demo", value_name = "DIR")]
    out: PathBuf,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
}

/// Machines with a demo.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Machine {
    /// A pole on a cart, force on the cart.
    Cartpole,
    /// Six joints, torques at all of them.
    Arm,
}

const MECHANISM: Mechanism = Mechanism::Cartpole;
/// Settings with which the energies are learned well within a quarter of a minute on one core.
const TRAJECTORIES: usize = 16;
const WIDTH: u16 = 16;
const ITERATIONS: u64 = 40;
/// Name of the configuration, and its first line, which identifies a demo's folder.
const CONFIG: &str = "train.toml";
const MARK: &str = "# Written by `leastaction demo`.";

/// Results of the demo.
#[derive(Serialize)]
struct Report {
    out: PathBuf,
    seconds: f64,
    samples: usize,
    training: train::Report,
    model: PathBuf,
    model_bytes: usize,
    forecast: Forecast,
    swing_up: simulate::Report,
    acrobot: acrobot::Report,
    pictures: Vec<PathBuf>,
}

impl Demo {
    /// Runs the demo.
    pub fn run(self, output: Output) -> Done {
        self.check()?;
        folder(&self.out)?;
        if self.machine == Machine::Arm {
            return arm::run(&self, output);
        }
        let started = Instant::now();
        let report = self.steps(output, &started)?;
        output.report(&report)?;
        report.swing_up.judge()?;
        report.acrobot.swing_up().judge()
    }

    fn steps(&self, output: Output, started: &Instant) -> Result<Report, Failure> {
        let at = |name: &str| self.out.join(name);
        let say = |step: &str| say(output, started, step);
        self.write_config(&at(CONFIG))?;
        say("generate: a cart-pole under random forces");
        let samples = self.generate(&at("data.npz"))?;
        say("train: the energies, from positions and forces alone");
        let training = self.train(&at(CONFIG), &at("run"), output)?;
        say("export: the weights as a model file, and as Rust source");
        let (model, model_bytes) = write_model(&at("run"), &at("model.postcard"), &at("model.rs"))?;
        say("forecast: the model against the truth, free motion from two positions");
        let forecast = forecast(&model, MECHANISM, self.seed, &at("phase.svg"))?;
        say("simulate: swing-up in the firmware loop");
        let request = Request {
            model: &model,
            plant: Plant::Exact(MECHANISM),
            scenario: Scenario::SwingUp,
            seed: self.seed,
            seconds: None,
            tick: None,
            world: &World::default(),
            motion: &TrackArgs::default(),
            floats: &Floats::default(),
            follows: &PlanArgs::default(),
            decides: &MpcArgs::default(),
            adaptive: None,
            plans: &[],
            config: None,
            on: None,
        };
        let (swing_up, _) = simulate(&at("model.postcard"), &request, [at("trace.csv"), at("swing-up.svg")])?;
        let acrobot = acrobot::run(self, output, say)?;
        let mut pictures = vec![training.loss_curve.clone(), at("phase.svg"), swing_up.picture.clone()];
        pictures.extend(acrobot.pictures().map(Path::to_path_buf));
        Ok(Report {
            out: self.out.clone(),
            seconds: started.elapsed().as_secs_f64(),
            samples,
            pictures,
            training,
            model: at("model.postcard"),
            model_bytes,
            forecast,
            swing_up,
            acrobot,
        })
    }

    /// Refuses a folder with files that are not from an earlier demo.
    fn check(&self) -> Done {
        let is_used = std::fs::read_dir(&self.out).is_ok_and(|mut entries| entries.next().is_some());
        let is_demo =
            || std::fs::read_to_string(self.out.join(CONFIG)).is_ok_and(|config| config.starts_with(MARK));
        if is_used && !is_demo() {
            let message = "there are files that are not of an earlier demo; name another folder with --out";
            return Err(Failure::input(&self.out, message));
        }
        Ok(())
    }

    fn generate(&self, file: &Path) -> Result<usize, Failure> {
        let settings = Settings::symo(MECHANISM, TRAJECTORIES, self.seed);
        let data = generate(&settings).map_err(|error| Failure::Work(error.to_string()))?;
        data::write(file, &data).map_err(written)?;
        Ok(data.samples())
    }

    fn write_config(&self, file: &Path) -> Done {
        let coordinates = Coordinates(MECHANISM.coordinates().to_vec());
        let model = InertiaNetworkConfig { hidden: vec![WIDTH; 2], ..InertiaNetworkConfig::new(coordinates) };
        let mut config = Config::new("data.npz", model);
        (config.training.iterations, config.training.seed) = (ITERATIONS, self.seed);
        let text = format!("{MARK}\n{}", config.to_toml());
        atomic::write(file, text.as_bytes()).map_err(|error| Failure::file(file, error))
    }

    fn train(&self, file: &Path, folder: &Path, output: Output) -> Result<train::Report, Failure> {
        let plan = train::plan(file, Config::read(file)?, output)?;
        let run = Run::begin(plan, folder, true)?;
        let (report, ending) = train::train(run, folder, output, interrupt::flag()?)?;
        if ending == Ending::Interrupted {
            return Err(Failure::Interrupted("interrupted; run the demo again".to_owned()));
        }
        Ok(report)
    }
}

/// Announces the next step.
fn say(output: Output, started: &Instant, step: &str) {
    output.note(&format!("{:5.1} s  {step}", started.elapsed().as_secs_f64()));
}

fn write_model(run: &Path, file: &Path, rust: &Path) -> Result<(Model, usize), Failure> {
    let (_, bytes) = encoded(run, Precision::Single)?;
    atomic::write(file, &bytes).map_err(|error| Failure::file(file, error))?;
    let failed = |error| Failure::file(file, error);
    let source = leastaction_models::file::rust_source(&bytes).map_err(failed)?;
    atomic::write(rust, source.as_bytes()).map_err(|error| Failure::file(rust, error))?;
    Ok((decode(&bytes).map_err(failed)?, bytes.len()))
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let line = |f: &mut fmt::Formatter, name: &str, value: String| writeln!(f, "{name:<34} {value}");
        let Self { training, forecast, swing_up, acrobot, .. } = self;
        line(f, "logged", format!("{TRAJECTORIES} trajectories, {} samples", self.samples))?;
        line(f, "learned", format!("{} parameters in {:.1} s", training.parameters, training.seconds))?;
        line(f, "training loss (m², rad²)", format!("{:.1e}", training.train_loss))?;
        if let Some(loss) = training.validation_loss {
            line(f, "loss on trajectories held back", format!("{loss:.1e}"))?;
        }
        line(f, "model file", format!("{} bytes", self.model_bytes))?;
        let Forecast { seconds, trajectories, mean, median } = forecast;
        line(f, "free motion ahead", format!("{seconds} s from {trajectories} starts"))?;
        line(f, "squared error (m², rad²)", format!("{mean:.1e} mean, {median:.1e} median"))?;
        let settled = swing_up.settled_at.map_or("not reached".to_owned(), |t| format!("{t:.2} s"));
        line(f, "pole upright for good after", settled)?;
        line(
            f,
            "cart from the middle at most",
            format!("{:.2} m", swing_up.max_q.first().unwrap_or(&f32::NAN)),
        )?;
        line(f, "Newton iterations a step at most", swing_up.newton_iterations.to_string())?;
        line(f, "trace hash", swing_up.trace_hash.clone())?;
        write!(f, "\n{acrobot}\n")?;
        line(f, "all of it took", format!("{:.1} s", self.seconds))?;
        writeln!(f, "\nModel: {}. Trace: {}.", self.model.display(), swing_up.trace.display())?;
        let pictures: Vec<_> = self.pictures.iter().map(|picture| picture.display().to_string()).collect();
        writeln!(f, "Pictures: {}", pictures.join(", "))
    }
}
