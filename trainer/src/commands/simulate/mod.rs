//! `leastaction simulate`.

mod picture;
mod plant;
mod remote;
mod replay;
mod scenario;
mod trace;
mod world;

pub use picture::draw;
pub use plant::Plant;
pub use remote::{Emulated, Target};
pub use scenario::{Request, Scenario};
pub use trace::{Row, Trace};
pub use world::World;

use super::inspect::load;
use super::system::SymoSystem;
use clap::Args;
use leastaction::cli::arguments::{positive, positive_f32, seed};
use leastaction::cli::{Done, Failure, FileKind, Output, folder, replaceable};
use leastaction_core::energy::rigid::Coordinate;
use leastaction_firmware_sim::{Incidents, Summary};
use leastaction_learning::ground_truth::Mechanism;
use leastaction_learning::model_file::HostModel;
use replay::{Replay, ReplayReport};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Run a model in the fixed-step firmware loop against a mechanism: an exact one, or that of another model file.
///
/// The loop has quantised, noisy encoders and an actuator with one tick of delay; the firmware knows nothing but the
/// model. Writes trace.csv (one line a tick) and run.svg; the same seed gives the same trace, bit for bit. Exit code 1
/// where the goal of the scenario is not reached.
///
/// With --on, the firmware is the image of an emulated board, which holds the model in its flash and is asked tick by
/// tick over its serial line; the trace is the same, bit for bit. It takes QEMU, and images built by
/// firmware-sim/chip/run.sh --build.
///
/// With --plant, any rigid model or tree of up to 8, or of 12, coordinates is stepped beside the mechanism that another file
/// describes, from within what the training data of the model covered: how far a small model is from a better one, before the
/// robot says it.
///
/// Example: leastaction simulate model.postcard --scenario swing-up --seed 3
///
/// Example: leastaction simulate small.postcard --scenario predict --plant robot.postcard
///
/// With --replay, the observer runs along a log, and the report says how far the readings were from what the model predicted a tick
/// before; exit code 1 where the model cannot be stepped.
///
/// Example: leastaction simulate robot.postcard --replay log.csv --config robot.toml --on cortex-m4
#[derive(Args)]
pub struct Simulate {
    /// The model file.
    model: PathBuf,
    /// What the loop does.
    #[arg(long, value_enum, required_unless_present = "replay")]
    scenario: Option<Scenario>,
    /// A log to run the observer along, instead of a scenario: how well the firmware's model predicts the next reading.
    #[arg(long, value_name = "LOG", conflicts_with_all = ["scenario", "system", "plant", "seed", "seconds"])]
    replay: Option<PathBuf>,
    /// The configuration whose [data] says how the log is read.
    #[arg(long, value_name = "FILE", requires = "replay")]
    config: Option<PathBuf>,
    /// The mechanism that the loop acts on [default: by the model's coordinates].
    #[arg(long)]
    system: Option<SymoSystem>,
    /// The model file of the mechanism that the loop acts on; for predict.
    #[arg(long, value_name = "FILE", conflicts_with = "system")]
    plant: Option<PathBuf>,
    /// Of the initial state and of all noise.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Length of the run, s [default: 10; 5 for predict].
    #[arg(long, value_parser = positive_f32, allow_negative_numbers = true)]
    seconds: Option<f32>,
    /// Time from tick to tick, s [default: 0.01; with --plant the model's own step].
    #[arg(long, value_parser = positive_f32, allow_negative_numbers = true)]
    tick: Option<f32>,
    /// Run the controller on an emulated board.
    #[arg(long, value_enum, value_name = "BOARD")]
    on: Option<Emulated>,
    /// The controller's image for the board [default: the one built in the repository].
    #[arg(long, requires = "on", value_name = "FILE")]
    image: Option<PathBuf>,
    /// Longest wait for an answer of the board, s.
    #[arg(long, requires = "on", default_value_t = 20.0, value_parser = positive, allow_negative_numbers = true)]
    timeout: f64,
    #[command(flatten)]
    world: World,
    /// The folder to write to.
    #[arg(short, long, default_value = "simulation", value_name = "DIR")]
    output: PathBuf,
}

/// What came out of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The model file.
    pub model: PathBuf,
    /// What the loop did.
    pub scenario: Scenario,
    /// What it acted on.
    pub system: String,
    /// Units of its positions and of the forces on them.
    #[serde(skip)]
    units: [String; 2],
    /// Of all noise.
    pub seed: u64,
    /// What ran the controller.
    pub processor: String,
    /// Median and largest number of instructions in a tick, where they are counted.
    pub tick_instructions: Option<[u32; 2]>,
    /// Whether the goal was reached.
    pub success: bool,
    /// How many.
    pub ticks: u32,
    /// When the error came within the tolerance for good, s.
    pub settled_at: Option<f32>,
    /// Largest |q|.
    pub max_q: Vec<f32>,
    /// Largest |error|.
    pub max_error: Vec<f32>,
    /// Root mean square of the error.
    pub rms_error: Vec<f32>,
    /// Root mean square of estimated minus true position.
    pub rms_estimate_q: Vec<f32>,
    /// Root mean square of estimated minus true velocity.
    pub rms_estimate_v: Vec<f32>,
    /// Largest |force|.
    pub max_force: Vec<f32>,
    /// Most in a step.
    pub newton_iterations: u8,
    /// Largest relative residual of an accepted step.
    pub newton_residual: f32,
    /// Encoder readings dropped.
    pub dropped: u32,
    /// Late ticks.
    pub late: u32,
    /// Missed ticks.
    pub missed: u32,
    /// Errors of the model.
    pub model_errors: u32,
    /// Fingerprint of the trace.
    pub trace_hash: String,
    /// The file of the trace.
    pub trace: PathBuf,
    /// The picture.
    pub picture: PathBuf,
}

impl Simulate {
    /// Runs the loop and writes trace and picture.
    pub fn run(self, output: Output) -> Done {
        match (self.scenario, &self.replay) {
            (Some(scenario), _) => self.run_scenario(scenario, output),
            (None, Some(log)) => self.run_replay(log, output),
            (None, None) => Err(Failure::Input("name a --scenario, or a log to --replay".to_owned())),
        }
    }

    fn run_replay(&self, log: &Path, output: Output) -> Done {
        let (model, _) = load(&self.model)?;
        let target = self.target()?;
        let (config, on) = (self.config.as_deref(), target.as_ref());
        let learn_zeros = self.world.only_zeros()?;
        let replay = Replay { model: &model, log, config, tick: self.tick, learn_zeros, on };
        folder(&self.output)?;
        let file = self.output.join("trace.csv");
        replaceable(&file, FileKind::Table(trace::BEGINNING))?;
        let mut rows = Trace::default();
        let report = replay.run(output, &mut rows).map_err(|failure| cut(failure, &rows, &file))?;
        rows.write(&file).map_err(|error| Failure::file(&file, error))?;
        let report = ReplayReport { model: self.model.clone(), log: log.to_owned(), trace: file, ..report };
        output.report(&report)?;
        report.judge()
    }

    fn run_scenario(&self, scenario: Scenario, output: Output) -> Done {
        let (model, _) = load(&self.model)?;
        let plant_model = self.plant.as_deref().map(load).transpose()?;
        let plant = match (self.plant.as_deref(), &plant_model) {
            (Some(file), Some((model, _))) => Plant::Model { file, model },
            _ => Plant::Exact(match self.system {
                Some(system) => system.into(),
                None => mechanism(&self.model, &model)?,
            }),
        };
        let Self { seed, seconds, tick, .. } = *self;
        let target = self.target()?;
        let on = target.as_ref();
        let world = &self.world;
        let request = Request { model: &model, plant, scenario, seed, seconds, tick, world, on };
        folder(&self.output)?;
        let files = [self.output.join("trace.csv"), self.output.join("run.svg")];
        replaceable(&files[0], FileKind::Table(trace::BEGINNING))?;
        replaceable(&files[1], FileKind::Picture)?;
        let report = simulate(&self.model, &request, files)?;
        output.report(&report)?;
        report.judge()
    }

    fn target(&self) -> Result<Option<Target>, Failure> {
        let patience = Duration::try_from_secs_f64(self.timeout)
            .map_err(|error| Failure::Input(format!("--timeout: {error}")))?;
        let (image, model) = (self.image.clone(), self.model.clone());
        Ok(self.on.map(|on| Target { board: on.into(), image, model, patience }))
    }
}

/// Runs a scenario and writes its trace and its picture.
pub fn simulate(file: &Path, request: &Request, [trace, picture]: [PathBuf; 2]) -> Result<Report, Failure> {
    let mut rows = Trace::default();
    let mut report = scenario::run(request, &mut rows).map_err(|failure| cut(failure, &rows, &trace))?;
    rows.write(&trace).map_err(|error| Failure::file(&trace, error))?;
    draw(&picture, request, &rows)?;
    (report.model, report.trace, report.picture) = (file.to_owned(), trace, picture);
    Ok(report)
}

/// A run that did not come to its end: what there is of its trace is kept.
fn cut(failure: Failure, rows: &Trace, file: &Path) -> Failure {
    if rows.rows.is_empty() {
        return failure;
    }
    let kept = match rows.write(file) {
        Ok(()) => format!("the ticks before are in {}", file.display()),
        Err(error) => format!("{}: {error}", file.display()),
    };
    match failure {
        Failure::Work(message) => Failure::Work(format!("{message}; {kept}")),
        Failure::Interrupted(message) => Failure::Interrupted(format!("{message}; {kept}")),
        other => other,
    }
}

/// The mechanism whose coordinates are those of the model.
fn mechanism(file: &Path, model: &HostModel) -> Result<Mechanism, Failure> {
    match model.architecture.coordinates().as_str() {
        "a" => Ok(Mechanism::Pendulum),
        "ta" | "ca" => Ok(Mechanism::Cartpole),
        "aa" => Ok(Mechanism::Acrobot),
        other => Err(Failure::input(
            file,
            format!(
                "no mechanism has coordinates {other:?}; name one with --system, or a model file with --plant"
            ),
        )),
    }
}

impl Report {
    /// The part that the loop knows; the files are filled in later.
    fn new<const N: usize>(request: &Request, summary: &Summary<N>) -> Self {
        let Incidents { dropped, late, missed, model, .. } = summary.incidents;
        Self {
            model: PathBuf::new(),
            scenario: request.scenario,
            system: request.plant.name(),
            units: [POSITION, FORCE].map(|units| units_of(&request.plant, units)),
            seed: request.seed,
            processor: "host".to_owned(),
            tick_instructions: None,
            success: summary.success,
            ticks: summary.ticks,
            settled_at: summary.settled_at,
            max_q: summary.max_q.to_vec(),
            max_error: summary.max_error.to_vec(),
            rms_error: summary.rms_error.to_vec(),
            rms_estimate_q: summary.rms_estimate_q.to_vec(),
            rms_estimate_v: summary.rms_estimate_v.to_vec(),
            max_force: summary.max_force.to_vec(),
            newton_iterations: summary.newton.iterations,
            newton_residual: summary.newton.residual,
            dropped,
            late,
            missed,
            model_errors: model,
            trace_hash: format!("{:016x}", summary.hash),
            trace: PathBuf::new(),
            picture: PathBuf::new(),
        }
    }

    fn controller(&self) -> String {
        let processor = &self.processor;
        match self.tick_instructions {
            None | Some([_, 0]) => processor.clone(),
            Some([median, largest]) => {
                format!("{processor}, {median} instructions a tick (median), {largest} at most")
            }
        }
    }

    /// Names what ran the controller, and what its ticks took.
    fn on_processor(&mut self, name: &str, instructions: &[u32]) {
        name.clone_into(&mut self.processor);
        self.tick_instructions = median_and_most(instructions);
    }

    /// An error where the goal was not reached.
    pub fn judge(&self) -> Done {
        if self.success {
            return Ok(());
        }
        Err(Failure::Work(format!(
            "{} of the {} did not reach its goal; see {}",
            self.scenario,
            self.system,
            self.picture.display()
        )))
    }
}

/// Median and largest; none of nothing.
fn median_and_most(instructions: &[u32]) -> Option<[u32; 2]> {
    let mut sorted = instructions.to_vec();
    sorted.sort_unstable();
    let both = sorted.get(sorted.len() / 2).zip(sorted.last());
    both.map(|(median, largest)| [*median, *largest])
}

/// Units by kind of coordinate: translation, angle.
const POSITION: [&str; 2] = ["m", "rad"];
const FORCE: [&str; 2] = ["N", "N m"];

/// The unit of a coordinate of this kind.
fn unit(kind: Coordinate, [translation, angle]: [&'static str; 2]) -> &'static str {
    if kind == Coordinate::Angle { angle } else { translation }
}

/// The units of all coordinates, in order.
fn units_of(plant: &Plant, units: [&'static str; 2]) -> String {
    let units: Vec<_> = plant.coordinates().iter().map(|kind| unit(*kind, units)).collect();
    units.join(", ")
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let goal = if self.success { "goal reached" } else { "goal NOT reached" };
        let settled = match self.settled_at {
            None => "not within the tolerance at the end".to_owned(),
            Some(0.0) => "within the tolerance throughout".to_owned(),
            Some(t) => format!("within the tolerance for good after {t:.2} s"),
        };
        writeln!(f, "{} of the {}, seed {}: {goal}, {settled}", self.scenario, self.system, self.seed)?;
        let [q, u] = &self.units;
        let line = |f: &mut fmt::Formatter, name: &str, value: &str| writeln!(f, "{name:<32} {value}");
        line(f, "controller on", &self.controller())?;
        line(f, "ticks", &format!("{} (model errors: {})", self.ticks, self.model_errors))?;
        line(f, &format!("error, rms ({q})"), &list(&self.rms_error))?;
        line(f, "error, largest", &list(&self.max_error))?;
        line(f, "estimated position, rms error", &list(&self.rms_estimate_q))?;
        line(f, "estimated velocity, rms error", &list(&self.rms_estimate_v))?;
        line(f, &format!("position, largest ({q})"), &list(&self.max_q))?;
        line(f, &format!("force, largest ({u})"), &list(&self.max_force))?;
        let (iterations, residual) = (self.newton_iterations, self.newton_residual);
        line(f, "Newton", &format!("{iterations} iterations at most, residual {residual:.1e}"))?;
        line(f, "trace", &format!("{} in {}", self.trace_hash, self.trace.display()))?;
        line(f, "picture", &self.picture.display().to_string())
    }
}

/// Three digits of each.
fn list(values: &[f32]) -> String {
    let digits = |x: &f32| if *x == 0.0 || x.abs() >= 0.01 { format!("{x:.3}") } else { format!("{x:.1e}") };
    values.iter().map(digits).collect::<Vec<_>>().join(", ")
}
