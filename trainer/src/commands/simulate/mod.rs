//! `leastaction simulate`.

mod adapting;
mod changes;
mod course;
mod drift;
mod follow;
mod gravity;
mod mpc;
mod over_time;
mod picture;
mod plant;
mod recorded;
mod reference;
mod remote;
mod replay;
mod report;
mod scenario;
mod trace;
mod track;
mod world;

pub use adapting::Adaptive;
pub use follow::{PlanArgs, of_model};
pub use gravity::Floats;
pub use mpc::MpcArgs;
pub use picture::draw;
use picture::{draw_moving, moving_beside};
pub use plant::Plant;
pub use remote::{Emulated, Target};
pub use report::Report;
pub use scenario::{Request, Scenario};
pub use trace::{Row, Trace};
pub use track::{LawName, TrackArgs};
pub use world::World;

use super::system::SymoSystem;
use clap::Args;
use drift::Comparison;
use leastaction::cli::arguments::{positive, positive_f32, seed};
use leastaction::cli::{Done, Failure, FileKind, Output, folder, replaceable};
use leastaction::models::{Loaded, load, of_file_or_run, read};
use leastaction_ground_truth::Mechanism;
use leastaction_models::Model;
use replay::{Replay, ReplayReport};
use report::{FORCE, POSITION, median_and_most, unit};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Run a model in the fixed-step firmware loop against a mechanism: an exact one, or that of another model file.
///
/// The loop has quantised, noisy encoders and an actuator with one tick of delay; the firmware knows only the model. Writes trace.csv (one
/// line per tick), run.svg and, if the mechanism can be drawn, run-moving.svg; the same seed gives the same trace, bit for bit. The exit code
/// is 1 if the goal of the scenario is not reached.
///
/// With --on, the firmware is an image for an emulated board, which holds the model in its flash and is asked tick by tick over its serial
/// line; the trace is the same, bit for bit. This needs QEMU, and images built by firmware-sim/chip/run.sh --build.
///
/// With --plant, an inertia network or a tree of up to 8 or of 12 coordinates is stepped beside the mechanism that another model file
/// describes, starting within the range of the model's training data: this shows how far a small model is from a better one, before the
/// robot does.
///
/// Example: leastaction simulate model.postcard --scenario swing-up --seed 3
///
/// Example: leastaction simulate small.postcard --scenario predict --plant robot.postcard
///
/// With --scenario track, --plant and --trajectory, an arm of any of these sizes follows a motion, by default at 1,000 ticks per second.
///
/// Example: leastaction simulate arm.postcard --scenario track --plant robot.postcard --trajectory motion.csv
///
/// With --scenario gravity it floats, held by the model's gravity alone, and is pushed. The report says how far it drifts by errors of the
/// model's gravity, how far the push moves it, and when it is at rest again.
///
/// Example: leastaction simulate arm.postcard --scenario gravity --plant robot.postcard
///
/// With --scenario follow, the firmware follows the plan that `leastaction plan` made for the model, and holds its end. The report says how
/// far the mechanism was from the plan's start, how far it left the plan, and how much of the plan's limits that took.
///
/// Example: leastaction simulate model.postcard --scenario follow --plan plan.postcard
///
/// With --scenario mpc, the firmware decides by itself: at every tick it improves a motion to the goal, which for the pendulum, the cart-pole
/// and the acrobot is upright, and for the mechanism of a model file the end of a plan or --goal. The report says how many commands were
/// decisions, and how many came without one. With --on, a board of at most two coordinates decides.
///
/// Example: leastaction simulate model.postcard --scenario mpc --seed 3
///
/// Example: leastaction simulate arm.postcard --scenario mpc --plant robot.postcard --goal 0.5,-1 --limit 20,10
///
/// With --payload and --friction-drift the mechanism takes up a load and its friction grows while it runs, and the firmware does not know.
///
/// Example: leastaction simulate arm.postcard --scenario gravity --plant robot.postcard --payload 2.5@3s --friction-drift 1.5@60s
///
/// With --replay, the observer runs along a log, and the report says how far the readings were from the model's prediction one tick before;
/// the exit code is 1 if the model cannot be stepped.
///
/// Example: leastaction simulate robot.postcard --replay log.csv --config robot.toml --on cortex-m4
///
/// With the run's folder, or --config or --reference, the report also says whether the machine is still the one that was learned: the errors
/// are compared with those of the training's log, or of another one of the same kind of motion.
///
/// Example: leastaction simulate run --replay today.csv
#[derive(Args)]
pub struct Simulate {
    /// The model file; for --replay also the folder of a training run.
    model: PathBuf,
    /// The scenario of the loop.
    #[arg(long, value_enum, required_unless_present = "replay")]
    scenario: Option<Scenario>,
    /// A log to run the observer along, instead of a scenario: shows how well the firmware's model predicts the next reading.
    #[arg(long, value_name = "LOG", conflicts_with_all = ["scenario", "system", "plant", "seed", "seconds", "plan"])]
    replay: Option<PathBuf>,
    /// The configuration whose [data] says how to read the log of --replay or --trajectory.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// The mechanism that the loop acts on [default: chosen by the model's coordinates].
    #[arg(long)]
    system: Option<SymoSystem>,
    /// The model file of the mechanism that the loop acts on; for all scenarios but swing-up.
    #[arg(long, value_name = "FILE", conflicts_with = "system")]
    plant: Option<PathBuf>,
    /// Seed of the initial state and of all noise.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Length of the run, s [default: 10; 5 for predict; 2 more than the plan for follow].
    #[arg(long, value_parser = positive_f32, allow_negative_numbers = true)]
    seconds: Option<f32>,
    /// Time between ticks, s [default: 0.01; with --plant the model's own step; the plan's].
    #[arg(long, value_parser = positive_f32, allow_negative_numbers = true)]
    tick: Option<f32>,
    /// Let numbers of the firmware's model follow the mechanism: what its last body carries, and its friction. A first run, in which the
    /// mechanism stays as it is, measures how well the model explains it.
    #[arg(long, conflicts_with = "replay")]
    adapt: bool,
    /// Let numbers of the firmware's model follow by these settings of `leastaction adapt --settings`, without a first run.
    #[arg(long, value_name = "FILE", conflicts_with = "adapt")]
    settings: Option<PathBuf>,
    /// Run the controller on an emulated board.
    #[arg(long, value_enum, value_name = "BOARD")]
    on: Option<Emulated>,
    /// The controller's image for the board [default: the one built in the repository].
    #[arg(long, requires = "on", value_name = "FILE")]
    image: Option<PathBuf>,
    /// Longest wait for an answer from the board, s.
    #[arg(long, requires = "on", default_value_t = 20.0, value_parser = positive, allow_negative_numbers = true)]
    timeout: f64,
    #[command(flatten)]
    motion: TrackArgs,
    #[command(flatten)]
    floats: Floats,
    #[command(flatten)]
    follows: PlanArgs,
    #[command(flatten)]
    decides: MpcArgs,
    #[command(flatten)]
    drift: Comparison,
    #[command(flatten)]
    world: World,
    /// The folder to write to.
    #[arg(short, long, default_value = "simulation", value_name = "DIR")]
    output: PathBuf,
}

impl Simulate {
    /// Runs the loop, and writes trace and picture.
    pub fn run(self, output: Output) -> Done {
        match (self.scenario, &self.replay) {
            (Some(scenario), _) => self.run_scenario(scenario, output),
            (None, Some(log)) => self.run_replay(log, output),
            (None, None) => Err(Failure::Input("name a --scenario, or a log to --replay".to_owned())),
        }
    }

    fn run_replay(&self, log: &Path, output: Output) -> Done {
        let model = of_file_or_run(&self.model, None)?;
        let target = self.target()?;
        let (config, on) = (self.config.as_deref(), target.as_ref());
        let learn_zeros = self.world.only_zeros()?;
        folder(&self.output)?;
        let adaptive = self.adaptive(&model)?;
        let replay = Replay {
            model: &model,
            file: &self.model,
            log,
            config,
            drift: &self.drift,
            tick: self.tick,
            learn_zeros,
            on,
            adaptive: adaptive.as_ref(),
        };
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
        let Loaded { model, bytes } = read(&self.model)?;
        self.follows.check(scenario)?;
        self.decides.check(scenario)?;
        let files = self.follows.read()?;
        let plans = of_model(&files, &bytes)?;
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
        folder(&self.output)?;
        let adaptive = self.adaptive(&model)?;
        let (world, motion, floats) = (&self.world, &self.motion, &self.floats);
        let config = self.config.as_deref();
        let request = Request {
            model: &model,
            plant,
            scenario,
            seed,
            seconds,
            tick,
            world,
            motion,
            floats,
            follows: &self.follows,
            decides: &self.decides,
            plans: &plans,
            config,
            on,
            adaptive: adaptive.as_ref(),
        };
        let files = [self.output.join("trace.csv"), self.output.join("run.svg")];
        replaceable(&files[0], FileKind::Table(trace::BEGINNING))?;
        replaceable(&files[1], FileKind::Picture)?;
        replaceable(&moving_beside(&files[1]), FileKind::Picture)?;
        let (report, _) = simulate(&self.model, &request, files)?;
        output.report(&report)?;
        report.judge()
    }

    /// The numbers that follow, if any do.
    fn adaptive<'m>(&self, model: &'m Model) -> Result<Option<Adaptive<'m>>, Failure> {
        let wanted = self.adapt || self.settings.is_some();
        wanted
            .then(|| Adaptive::new((&self.model, model), self.settings.as_deref(), &self.output))
            .transpose()
    }

    fn target(&self) -> Result<Option<Target>, Failure> {
        let patience = Duration::try_from_secs_f64(self.timeout)
            .map_err(|error| Failure::Input(format!("--timeout: {error}")))?;
        let (image, model, plans) = (self.image.clone(), self.model.clone(), self.follows.plan.clone());
        Ok(self.on.map(|on| Target { board: on.into(), image, model, plans, patience }))
    }
}

/// Runs a scenario, and writes its trace, which it also returns, its picture, and a moving one beside it.
pub fn simulate(
    file: &Path,
    request: &Request,
    [trace, picture]: [PathBuf; 2],
) -> Result<(Report, Trace), Failure> {
    if let Some(adaptive) = request.adaptive {
        adaptive.commission(request)?;
    }
    let mut rows = Trace::default();
    let mut report = scenario::run(request, &mut rows).map_err(|failure| cut(failure, &rows, &trace))?;
    rows.write(&trace).map_err(|error| Failure::file(&trace, error))?;
    draw(&picture, request, &rows)?;
    report.moving = draw_moving(moving_beside(&picture), request, &rows)?;
    (report.model, report.trace, report.picture) = (file.to_owned(), trace, picture);
    Ok((report, rows))
}

/// The failure of a run that was interrupted; the part of its trace that exists is kept.
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

/// The mechanism with the model's coordinates.
fn mechanism(file: &Path, model: &Model) -> Result<Mechanism, Failure> {
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
