//! `leastaction simulate`.

mod picture;
mod scenario;
mod trace;

pub use picture::draw;
pub use scenario::{Request, Scenario};
pub use trace::{Row, Trace};

use super::Done;
use super::inspect::load;
use super::output::{Failure, Output};
use clap::Args;
use leastaction::ground_truth::Mechanism;
use leastaction::model_file::HostModel;
use leastaction_firmware_sim::{Incidents, Summary};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Run a model in the fixed-step firmware loop against the exact mechanism.
///
/// The loop has quantised, noisy encoders and an actuator with one tick of delay; the firmware knows nothing but the
/// model. Writes trace.csv (one line a tick) and run.svg; the same seed gives the same trace, bit for bit. Exit code 1
/// where the goal of the scenario is not reached.
///
/// Example: leastaction simulate model.postcard --scenario swing-up --seed 3
#[derive(Args)]
pub struct Simulate {
    /// The model file.
    model: PathBuf,
    /// What the loop does.
    #[arg(long, value_enum)]
    scenario: Scenario,
    /// The mechanism that the loop acts on [default: by the model's coordinates].
    #[arg(long)]
    system: Option<Mechanism>,
    /// Of the initial state and of all noise.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Length of the run, s [default: 10; 5 for predict].
    #[arg(long)]
    seconds: Option<f32>,
    /// Time from tick to tick, s [default: 0.01].
    #[arg(long)]
    tick: Option<f32>,
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
    pub system: &'static str,
    /// Of all noise.
    pub seed: u64,
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
        let (model, _) = load(&self.model)?;
        let mechanism = self.system.map_or_else(|| mechanism(&self.model, &model), Ok)?;
        let Self { scenario, seed, seconds, tick, .. } = self;
        let request = Request { model: &model, mechanism, scenario, seed, seconds, tick };
        std::fs::create_dir_all(&self.output).map_err(|error| Failure::file(&self.output, error))?;
        let files = [self.output.join("trace.csv"), self.output.join("run.svg")];
        let report = simulate(&self.model, &request, files)?;
        output.report(&report)?;
        report.judge()
    }
}

/// Runs a scenario and writes its trace and its picture.
pub fn simulate(file: &Path, request: &Request, [trace, picture]: [PathBuf; 2]) -> Result<Report, Failure> {
    let mut rows = Trace::default();
    let mut report = scenario::run(request, &mut rows)?;
    rows.write(&trace).map_err(|error| Failure::file(&trace, error))?;
    let title = format!("{} of the {}", request.scenario, request.mechanism.name());
    draw(&picture, &title, &request.model.architecture.coordinates(), &rows)?;
    (report.model, report.trace, report.picture) = (file.to_owned(), trace, picture);
    Ok(report)
}

/// The mechanism whose coordinates are those of the model.
fn mechanism(file: &Path, model: &HostModel) -> Result<Mechanism, Failure> {
    match model.architecture.coordinates().as_str() {
        "a" => Ok(Mechanism::Pendulum),
        "ta" | "ca" => Ok(Mechanism::Cartpole),
        "aa" => Ok(Mechanism::Acrobot),
        other => Err(Failure::input(
            file,
            format!("no mechanism has coordinates {other:?}; name one with --system"),
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
            system: request.mechanism.name(),
            seed: request.seed,
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

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let settled = self.settled_at.map_or("never settled".to_owned(), |t| format!("settled at {t:.2} s"));
        let goal = if self.success { "goal reached" } else { "goal NOT reached" };
        writeln!(f, "{} of the {}, seed {}: {goal}, {settled}", self.scenario, self.system, self.seed)?;
        let line =
            |f: &mut fmt::Formatter, name: &str, values: &[f32]| writeln!(f, "{name:<28} {}", list(values));
        writeln!(f, "{:<28} {} (model errors: {})", "ticks", self.ticks, self.model_errors)?;
        line(f, "error, rms (m, rad)", &self.rms_error)?;
        line(f, "error, at most", &self.max_error)?;
        line(f, "estimate's error, rms", &self.rms_estimate_q)?;
        line(f, "its velocity's", &self.rms_estimate_v)?;
        line(f, "position, at most", &self.max_q)?;
        line(f, "force, at most (N, N m)", &self.max_force)?;
        let (iterations, residual) = (self.newton_iterations, self.newton_residual);
        writeln!(f, "{:<28} {iterations} iterations at most, residual {residual:.1e}", "Newton")?;
        writeln!(f, "{:<28} {} in {}", "trace", self.trace_hash, self.trace.display())?;
        writeln!(f, "{:<28} {}", "picture", self.picture.display())
    }
}

/// Three digits of each.
fn list(values: &[f32]) -> String {
    let digits = |x: &f32| if *x == 0.0 || x.abs() >= 0.01 { format!("{x:.3}") } else { format!("{x:.1e}") };
    values.iter().map(digits).collect::<Vec<_>>().join(", ")
}
