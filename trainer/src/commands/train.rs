//! `leastaction train`.

use super::interrupt;
use super::notes::tell;
use super::progress::Progress;
use clap::{Args, ValueEnum};
use leastaction::cli::{Done, Failure, Output, print};
use leastaction_learning::config::{
    ARM_DEFAULTS, BODIES_DEFAULTS, Config, DEFAULTS, GRAPH_DEFAULTS, MODULAR_DEFAULTS,
};
use leastaction_learning::run::{ChoiceError, Chosen, Ending, Plan, PlanError, Run, choose};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Learn a model from a log, as a TOML file says.
///
/// The run folder receives checkpoint.postcard, history.csv, config.toml and, at the end, loss.svg, and of a loss over
/// windows report.html, a page on what the fit is worth; `leastaction export` makes a model file of it. Ctrl-C finishes the iteration, saves and exits with 130; a second Ctrl-C stops at once.
/// A resumed run gives the same bits as one that was never interrupted; iterations, target, patience, max_seconds,
/// threads and the checkpoint intervals may be changed before resuming.
///
/// Example: leastaction train cartpole.toml -o run
#[derive(Args)]
pub struct Train {
    /// The configuration.
    #[arg(value_name = "CONFIG.toml", required_unless_present = "print_defaults")]
    config: Option<PathBuf>,
    /// The folder of the run.
    #[arg(short, long, value_name = "RUN", required_unless_present = "print_defaults")]
    output: Option<PathBuf>,
    /// Go on with the run in the folder, bit for bit.
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the run in the folder, as soon as the new one has a finite loss.
    #[arg(long)]
    force: bool,
    /// Show no progress.
    #[arg(short, long)]
    quiet: bool,
    /// Print a configuration with every key explained, and do nothing else; `modular`: one for trees of elements, `graph`: one for
    /// particles.
    #[arg(long, exclusive = true, value_name = "FAMILY", num_args = 0..=1, default_missing_value = "rigid")]
    print_defaults: Option<Family>,
}

/// Families of models.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Family {
    /// One network for the inertia matrix and the potential.
    Rigid,
    /// Trees of elements.
    Modular,
    /// Graphs of particles.
    Graph,
    /// Rigid bodies on joints.
    Bodies,
    /// Rigid bodies in space, from a robot description.
    Arm,
}

/// What came out of training.
#[derive(Serialize)]
pub struct Report {
    /// The folder.
    pub run: PathBuf,
    /// Why training ended.
    pub ending: &'static str,
    /// Done, over all stages.
    pub iterations: u64,
    /// Numbers in the weight block.
    pub parameters: usize,
    /// Those that are not known numbers.
    pub learned_parameters: usize,
    /// Samples of the last stage.
    pub training_samples: usize,
    /// Samples held back.
    pub validation_samples: usize,
    /// The iteration that gave the best weights.
    pub best_iteration: u64,
    /// Of the best weights.
    pub train_loss: f64,
    /// Of the best weights.
    pub validation_loss: Option<f64>,
    /// Of training.
    pub seconds: f64,
    /// The picture.
    pub loss_curve: PathBuf,
    /// The page on what was learned over windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<PathBuf>,
    /// The iteration of the checkpoint.
    #[serde(skip)]
    pub saved: Option<u64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let validation =
            self.validation_loss.map_or(String::new(), |loss| format!(", validation loss {loss:.3e}"));
        let known = self.parameters - self.learned_parameters;
        let known = if known > 0 { format!(" ({known} of them known)") } else { String::new() };
        writeln!(
            f,
            "{} parameters{known}, {} + {} samples",
            self.parameters, self.training_samples, self.validation_samples
        )?;
        writeln!(f, "{} iterations in {:.1} s, ended by: {}", self.iterations, self.seconds, self.ending)?;
        writeln!(
            f,
            "best at iteration {}: training loss {:.3e}{validation}",
            self.best_iteration, self.train_loss
        )?;
        writeln!(f, "run in {}, loss curve in {}", self.run.display(), self.loss_curve.display())?;
        self.report.iter().try_for_each(|page| writeln!(f, "what it is worth: {}", page.display()))
    }
}

impl Train {
    /// Trains, or prints the defaults.
    pub fn run(self, output: Output) -> Done {
        let (Some(file), Some(folder)) = (&self.config, &self.output) else {
            return print(match self.print_defaults {
                Some(Family::Modular) => MODULAR_DEFAULTS,
                Some(Family::Graph) => GRAPH_DEFAULTS,
                Some(Family::Bodies) => BODIES_DEFAULTS,
                Some(Family::Arm) => ARM_DEFAULTS,
                _ => DEFAULTS,
            });
        };
        let config = Config::read(file)?;
        let plan = plan(file, config, output)?;
        let stop = interrupt::flag()?;
        let run = if self.resume { Run::resume(plan, folder) } else { Run::begin(plan, folder, self.force) }?;
        let (report, ending) = train(run, folder, self.quiet, stop)?;
        if ending == Ending::Interrupted {
            return Err(Failure::Interrupted(interrupted(file, folder, report.saved)));
        }
        output.report(&report)
    }
}

/// What there is after Ctrl-C, the last iteration that was `saved`, and how to go on.
fn interrupted(file: &Path, folder: &Path, saved: Option<u64>) -> String {
    let (file, folder) = (file.display(), folder.display());
    match saved {
        Some(iteration) => format!(
            "interrupted; iteration {iteration} is saved. Go on with: leastaction train {file} -o {folder} --resume"
        ),
        None => {
            format!("interrupted before a checkpoint was written; the earlier run in {folder} is as it was")
        }
    }
}

/// Reads the data that a configuration file names and prepares the losses, telling what should be known.
pub fn plan(file: &Path, config: Config, output: Output) -> Result<Plan, Failure> {
    let log = PathBuf::from(config.data.file.to_string());
    let refused = |error: PlanError| match error {
        PlanError::Data(_) => Failure::input(&log, error),
        _ => Failure::input(file, error),
    };
    let Chosen { config, data, notes, choices } = choose(config).map_err(|error| match error {
        ChoiceError::Data(error) => error.into(),
        ChoiceError::Plan(error) => refused(error),
    })?;
    tell(&notes, output);
    choices.sentences().iter().for_each(|sentence| output.note(&format!("note: {sentence}")));
    let plan = Plan::new(config, &data).map_err(refused)?;
    plan.notices().iter().for_each(|notice| output.note(&format!("note: {notice}")));
    Ok(plan)
}

/// Trains with progress on stderr.
pub fn train(
    mut run: Run,
    folder: &Path,
    quiet: bool,
    stop: &AtomicBool,
) -> Result<(Report, Ending), Failure> {
    let mut progress = Progress::new(quiet, &run);
    let ending = run.train(&mut progress, stop);
    progress.finish();
    let ending = ending?;
    let (training_samples, validation_samples) = run.plan().samples();
    let best = run.best();
    let report = Report {
        run: folder.to_owned(),
        ending: ending.name(),
        iterations: run.iteration(),
        parameters: run.plan().parameters(),
        learned_parameters: run.plan().learned_parameters(),
        training_samples,
        validation_samples,
        best_iteration: best.iteration,
        train_loss: best.train,
        validation_loss: best.validation,
        seconds: run.seconds(),
        loss_curve: run.loss_curve(),
        report: run.report(),
        saved: run.saved(),
    };
    Ok((report, ending))
}
