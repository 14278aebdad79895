//! `leastaction plan`.

use super::interrupt;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget};
use leastaction::cli::{Done, Failure, FileKind, Output, folder, replaceable, written};
use leastaction::models::machine;
use leastaction_core::control::Iteration;
use leastaction_core::forces::ControlKind;
use leastaction_learning::atomic;
use leastaction_learning::data::{self, Dataset, Rows, Trajectory};
use leastaction_planning::{Machine, Plan as Found, PlanConfig, PlanError, Progress, Task, page, plan};
use serde::Serialize;
use std::fmt;
use std::io::{IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Plan a motion from a start to a goal within the limits of drives, joints and speeds, with the gains that follow it.
///
/// The folder receives plan.postcard (shipped like the model, and bound to it), plan.csv (one row a node, and the end), plan.html (the motion
/// drawn over time, commands against their limits, convergence), and model.postcard if the model is a robot description. The dynamics are the steps that the chip takes, so the motion is the one that it computes.
/// Ctrl-C keeps the best motion so far.
///
/// Example: leastaction plan swing-up.toml -o swing-up
#[derive(Args)]
pub struct Plan {
    /// The configuration: model, start, goal, limits, cost.
    #[arg(value_name = "CONFIG.toml")]
    config: PathBuf,
    /// The folder to write to.
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    /// Commands to begin with, instead of start guesses: a log with the columns u1, u2, … and one row a node.
    #[arg(long, value_name = "LOG")]
    guess: Option<PathBuf>,
}

/// Files of a plan.
#[derive(Clone, Debug, Serialize)]
struct Files {
    csv: PathBuf,
    page: PathBuf,
    plan: Option<PathBuf>,
    model: Option<PathBuf>,
}

/// Result of a plan.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    config: PathBuf,
    feasible: bool,
    /// Whether the drives hold the end at rest.
    holds: bool,
    cost: f64,
    violation: f64,
    /// Duration of the motion, s.
    seconds: f64,
    nodes: usize,
    ticks_per_node: u16,
    iterations: u16,
    /// Time of the search from the start guess that was best, s.
    solve_s: f64,
    /// Half-widths of the linear tube of feedback at the start; empty if there is none.
    tube: Vec<f64>,
    /// Starts around the plan from which its law reached the end: of how many, on the plant as it is, and with other masses.
    followed: Option<[usize; 3]>,
    files: Files,
    starts: Vec<Start>,
}

/// Search from one start guess.
#[derive(Clone, Debug, Serialize)]
struct Start {
    guess: String,
    nodes: usize,
    ended: &'static str,
    cost: f64,
    violation: f64,
    iterations: u16,
    seconds: f64,
}

impl Report {
    /// Page that shows the plan.
    pub fn page(&self) -> &Path {
        &self.files.page
    }

    /// Length, and the trial of its law, in a few words.
    pub fn summary(&self) -> String {
        let Self { seconds, nodes, .. } = self;
        let trial = |[starts, exact, _]: [usize; 3]| format!(", followed from {exact} of {starts} starts");
        format!("{seconds:.2} s in {nodes} nodes{}", self.followed.map_or_else(String::new, trial))
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { seconds, nodes, ticks_per_node, cost, violation, .. } = self;
        writeln!(
            f,
            "{seconds:.3} s in {nodes} nodes of {ticks_per_node} ticks, cost {cost:.5}, off by {violation:.1e}"
        )?;
        let holds =
            if self.holds { "the drives hold the end" } else { "the drives do not hold the end at rest" };
        writeln!(f, "{holds}")?;
        writeln!(
            f,
            "{:16} {:>6} {:>12} {:>9} {:>6} {:>8}  ended",
            "start guess", "nodes", "cost", "off by", "steps", "s"
        )?;
        for start in &self.starts {
            let Start { guess, nodes, ended, cost, violation, iterations, seconds } = start;
            writeln!(
                f,
                "{guess:16} {nodes:>6} {cost:>12.5} {violation:>9.1e} {iterations:>6} {seconds:>8.3}  {ended}"
            )?;
        }
        if let Some([starts, exact, off]) = self.followed {
            writeln!(
                f,
                "followed from {exact} of {starts} starts around it, and from {off} with other masses"
            )?;
        }
        let Files { csv, page, plan, model } = &self.files;
        let files = [plan.as_ref(), Some(csv), Some(page), model.as_ref()];
        let names: Vec<_> = files.into_iter().flatten().map(|file| file.display().to_string()).collect();
        writeln!(f, "{}", names.join(", "))
    }
}

impl Plan {
    /// The plan of a configuration, with its files in a folder, made without progress.
    pub fn of(config: PathBuf, output: PathBuf) -> Self {
        Self { config, output, guess: None }
    }

    /// Plans and writes the files.
    pub fn run(self, output: Output) -> Done {
        let (report, verdict) = self.make(output)?;
        output.report(&report)?;
        verdict
    }

    /// Plans and writes the files; the second result says why the motion is no plan, if it is none.
    pub fn make(&self, output: Output) -> Result<(Report, Done), Failure> {
        let config = PlanConfig::read(&self.config).map_err(|error| refused(&self.config, error))?;
        let machine = machine(&config)?;
        output.notes(&machine.notes);
        let task = Task::new(&config, &machine).map_err(|error| refused(&self.config, error))?;
        let given = self.guess.as_deref().map(|file| commands(file, &machine)).transpose()?;
        self.check_files()?;
        let stop = interrupt::flag()?;
        let shown = Shown::new(output.quiet);
        let found = plan(&machine, &task, given, (stop as &AtomicBool, &shown));
        shown.finish();
        let found = found.map_err(|error| Failure::Work(error.to_string()))?;
        let failed = found
            .failed
            .iter()
            .map(|(guess, error)| format!("the start guess {guess} gave no motion: {error}"));
        output.notes(&failed.collect::<Vec<_>>());
        let files = self.write(&machine, &found, &config)?;
        let followed = followed(&machine, &found)?;
        Ok((Report { followed, ..self.report(&found, files) }, self.verdict(&machine, &found)))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.output.join(name)
    }

    /// Refuses to replace other files.
    fn check_files(&self) -> Done {
        folder(&self.output)?;
        replaceable(&self.path("plan.csv"), FileKind::Log)?;
        replaceable(&self.path("plan.postcard"), FileKind::Plan)?;
        replaceable(&self.path("plan.html"), FileKind::Page)?;
        replaceable(&self.path("model.postcard"), FileKind::Model)
    }

    /// Writes the files; a motion that misses its goal is no plan to be shipped.
    fn write(&self, machine: &Machine, found: &Found, config: &PlanConfig) -> Result<Files, Failure> {
        let csv = self.path("plan.csv");
        let log =
            log(found).ok_or_else(|| Failure::Work("the motion has rows of unequal length".to_owned()))?;
        data::write(&csv, &log).map_err(written)?;
        let save = |name: &str, bytes: &[u8]| {
            let path = self.path(name);
            atomic::write(&path, bytes).map_err(|error| Failure::file(&path, error)).map(|()| path)
        };
        let failed = |error: &dyn fmt::Display| Failure::Work(error.to_string());
        let plan = match found.is_feasible() {
            true => Some(save("plan.postcard", &found.to_bytes(machine).map_err(|error| failed(&error))?)?),
            false => None,
        };
        let model = match Machine::is_description(&config.model) {
            true => Some(save("model.postcard", &machine.model.to_bytes().map_err(|error| failed(&error))?)?),
            false => None,
        };
        let html = page(found, machine).map_err(|error| failed(&error))?;
        let page = save("plan.html", html.as_bytes())?;
        Ok(Files { csv, page, plan, model })
    }

    fn report(&self, found: &Found, files: Files) -> Report {
        let start = |of: &leastaction_planning::StartReport| Start {
            guess: of.guess.clone(),
            nodes: of.nodes,
            ended: of.ending(),
            cost: of.solution.cost,
            violation: of.solution.violation,
            iterations: of.solution.iterations,
            seconds: of.seconds,
        };
        Report {
            config: self.config.clone(),
            feasible: found.is_feasible(),
            holds: found.holds,
            cost: found.cost,
            violation: found.solution.violation,
            seconds: found.seconds(),
            nodes: found.nodes.len(),
            ticks_per_node: found.task.ticks_per_node,
            iterations: found.solution.iterations,
            solve_s: found.starts.first().map_or(0.0, |start| start.seconds),
            tube: found.tube.widths.first().cloned().unwrap_or_default(),
            followed: None,
            files,
            starts: found.starts.iter().map(start).collect(),
        }
    }

    fn verdict(&self, machine: &Machine, found: &Found) -> Done {
        let folder = self.output.display();
        if found.interrupted {
            return Err(Failure::Interrupted(format!("interrupted; the best motion so far is in {folder}")));
        }
        let Some(worst) = found.worst(machine) else { return Ok(()) };
        let seconds = found.seconds();
        Err(Failure::Work(format!(
            "no motion within the limits reaches the goal in {seconds:.2} s: in the best one, {worst}. Allow more time, larger limits or \
             more starts; the motion is in {folder}/plan.csv, and there is no plan.postcard"
        )))
    }
}

/// Trial of a plan that meets its goal.
fn followed(machine: &Machine, found: &Found) -> Result<Option<[usize; 3]>, Failure> {
    let check = &found.task.check;
    if !found.is_feasible() || check.starts == 0 {
        return Ok(None);
    }
    let trials = found.trials(machine, check).map_err(|error| Failure::Work(error.to_string()))?;
    Ok(Some([trials.starts, trials.exact, trials.off]))
}

/// The failure to use a configuration.
fn refused(file: &Path, error: PlanError) -> Failure {
    match error {
        PlanError::Value { .. } => Failure::input(file, error),
        error => Failure::Input(error.to_string()),
    }
}

/// Commands of a log.
fn commands(file: &Path, machine: &Machine) -> Result<Vec<Vec<f64>>, Failure> {
    let (log, _) = data::read(file)?;
    let [one] = log.trajectories.as_slice() else {
        return Err(Failure::input(file, "a guess is a log of one motion"));
    };
    let Some(u) = one.u.as_ref().filter(|u| u.width() == machine.n()) else {
        return Err(Failure::input(file, format!("a guess has {} columns u1, u2, …", machine.n())));
    };
    Ok(u.iter().map(<[f64]>::to_vec).collect())
}

/// The motion as a log; `None` if nodes have different numbers of coordinates.
fn log(found: &Found) -> Option<Dataset> {
    let n = found.task.n();
    let nodes = || found.nodes.iter().chain([&found.end]);
    let one = Trajectory {
        id: 0,
        t0: 0.0,
        q: Rows::from_rows(n, nodes().map(|node| &node.x[..n]))?,
        v: Some(Rows::from_rows(n, nodes().map(|node| &node.x[n..]))?),
        a: None,
        u: Some(Rows::from_rows(n, nodes().map(|node| &node.u))?),
    };
    let h = found.task.node_seconds();
    Some(Dataset { n, h, control: Some(ControlKind::Held), trajectories: vec![one] })
}

/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(2);

/// Progress on stderr: one line that is redrawn on a terminal, lines elsewhere.
struct Shown {
    quiet: bool,
    bar: Option<ProgressBar>,
    last: Mutex<Instant>,
}

impl Shown {
    fn new(quiet: bool) -> Self {
        let terminal = !quiet && stderr().is_terminal();
        let bar = terminal.then(|| ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()));
        Self { quiet, bar, last: Mutex::new(Instant::now()) }
    }

    fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Shown {
    fn iteration(&self, guess: &str, nodes: usize, iteration: &Iteration<f64>) {
        let Iteration { count, cost, violation, .. } = iteration;
        let line =
            || format!("{guess}, {nodes} nodes: {count} steps, cost {cost:.4}, off by {violation:.1e}");
        if let Some(bar) = &self.bar {
            bar.set_message(line());
            bar.tick();
        } else if !self.quiet
            && let Ok(mut last) = self.last.lock()
            && last.elapsed() >= PAUSE
        {
            *last = Instant::now();
            Output::default().note(&line());
        }
    }
}
