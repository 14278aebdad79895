//! `leastaction train`.

use super::interrupt;
use super::progress::{Progress, waiting};
use clap::Args;
use clap::builder::PossibleValuesParser;
use leastaction::cli::{Done, Failure, Output, print};
use leastaction::training;
pub use leastaction::training::Report;
use leastaction_learning::config::Config;
use leastaction_learning::run::{Ending, Plan, Run};
use leastaction_models::config::ModelConfig;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Learn a model from a log, as configured in a TOML file.
///
/// The run folder receives checkpoint.postcard, history.csv, config.toml and, at the end, loss.svg; for a loss over windows also
/// report.html, a page that reports how good the fit is. `leastaction export` makes a model file of the run. Ctrl-C finishes the iteration,
/// saves, and exits with 130; a second Ctrl-C stops at once. A resumed run gives the same bits as an uninterrupted one; iterations, target,
/// patience, max_seconds, threads and the checkpoint intervals may be changed before resuming.
///
/// Example: leastaction train cartpole.toml -o run
#[derive(Args)]
pub struct Train {
    /// The configuration.
    #[arg(value_name = "CONFIG.toml", required_unless_present = "print_defaults")]
    config: Option<PathBuf>,
    /// The run folder.
    #[arg(short, long, value_name = "RUN", required_unless_present = "print_defaults")]
    output: Option<PathBuf>,
    /// Resume the run in the folder, bit for bit.
    #[arg(long, conflicts_with = "force")]
    resume: bool,
    /// Replace the run in the folder as soon as the new one has a finite loss.
    #[arg(long)]
    force: bool,
    /// Exit with 0 even if the model is no better than a trivial one (a constant velocity, or the mean of the torques), or its numbers ran away.
    #[arg(long)]
    accept_poor: bool,
    /// Only print a configuration of a family, with every key explained.
    #[arg(long, exclusive = true, value_name = "FAMILY", num_args = 0..=1, default_missing_value = "inertia-network", value_parser = PossibleValuesParser::new(ModelConfig::FAMILIES))]
    print_defaults: Option<String>,
}

impl Train {
    /// Trains, or prints the defaults.
    pub fn run(self, output: Output) -> Done {
        let (Some(file), Some(folder)) = (&self.config, &self.output) else {
            let family = self.print_defaults.as_deref().unwrap_or_default();
            return print(ModelConfig::defaults(family).unwrap_or_default());
        };
        let config = Config::read(file)?;
        let plan = plan(file, config, output)?;
        let stop = interrupt::flag()?;
        let run = if self.resume { Run::resume(plan, folder) } else { Run::begin(plan, folder, self.force) }?;
        let (report, ending) = train(run, folder, output, stop)?;
        if ending == Ending::Interrupted {
            return Err(Failure::Interrupted(interrupted(file, folder, report.saved)));
        }
        output.report(&report)?;
        match report.poor {
            Some(poor) if !self.accept_poor => Err(Failure::Work(worthless(&poor, folder))),
            poor => {
                poor.iter().for_each(|poor| output.note(&format!("warning: {poor}")));
                output.next(&format!("export {} -o model.postcard", folder.display()));
                Ok(())
            }
        }
    }
}

/// The message after training that gave a model of no use.
fn worthless(poor: &str, folder: &Path) -> String {
    format!(
        "{poor}. The run is in {}; compare the columns, units, signs and joints of the configuration with the log (`leastaction look` \
         lists them). With --accept-poor this is a warning",
        folder.display()
    )
}

/// The message after Ctrl-C: the last saved iteration, and how to resume.
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

/// Prepares the run of a configuration file; prints notes on stderr.
pub fn plan(file: &Path, config: Config, output: Output) -> Result<Plan, Failure> {
    let waiting = waiting(output);
    let plan = training::plan(file, config, &mut |sentence| {
        waiting.suspend(|| output.note(&format!("note: {sentence}")));
    });
    waiting.finish_and_clear();
    plan
}

/// Trains with progress on stderr.
pub fn train(
    mut run: Run,
    folder: &Path,
    output: Output,
    stop: &AtomicBool,
) -> Result<(Report, Ending), Failure> {
    let mut progress = Progress::new(output, &run);
    let trained = training::train(&mut run, folder, &mut progress, stop);
    progress.finish();
    trained
}
