//! Training for commands and for programs in other languages: from a configuration to a finished run.

use crate::cli::Failure;
use crate::notes;
use leastaction_learning::config::Config;
use leastaction_learning::report::NamedEstimate;
use leastaction_learning::run::{ChoiceError, Chosen, Ending, Monitor, Plan, PlanError, Run, choose};
use leastaction_learning::torques::SplitErrors;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Result of training.
#[derive(Serialize)]
pub struct Report {
    /// Run folder.
    pub run: PathBuf,
    /// Reason why training ended.
    pub ending: &'static str,
    /// Number of iterations done, over all stages.
    pub iterations: u64,
    /// Size of the weight block.
    pub parameters: usize,
    /// Number of learned parameters.
    pub learned_parameters: usize,
    /// Number of training samples in the last stage.
    pub training_samples: usize,
    /// Number of held-back samples.
    pub validation_samples: usize,
    /// Iteration that gave the best weights.
    pub best_iteration: u64,
    /// Training loss of the best weights.
    pub train_loss: f64,
    /// Validation loss of the best weights.
    pub validation_loss: Option<f64>,
    /// Torque errors of the best weights, if torques are the loss.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torques: Option<SplitErrors>,
    /// Learned numbers of bodies, friction and drives with their standard errors, if windows were learned from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub numbers: Vec<NamedEstimate>,
    /// Number of starts from which the model was fitted, if the first ended badly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub starts: Option<u64>,
    /// Messages on doubtful results, as they were printed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The way in which the model is of no use: numbers that ran away, or no better than a trivial one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poor: Option<String>,
    /// Time of the iterations, s.
    pub seconds: f64,
    /// Time before them, for reading, choices and first fits, s.
    pub preparation_seconds: f64,
    /// Path of the loss curve.
    pub loss_curve: PathBuf,
    /// Path of the report, if windows were learned from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub report: Option<PathBuf>,
    /// Iteration of the last checkpoint.
    #[serde(skip)]
    pub saved: Option<u64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let validation =
            self.validation_loss.map_or(String::new(), |loss| format!(", validation loss {loss:.3e}"));
        let unit = if self.report.is_some() && self.torques.is_none() { "windows" } else { "samples" };
        let known = self.parameters - self.learned_parameters;
        let known = if known > 0 { format!(" ({known} of them known)") } else { String::new() };
        writeln!(
            f,
            "{} parameters{known}, {} + {} {}",
            self.parameters, self.training_samples, self.validation_samples, unit
        )?;
        if self.iterations == 0 && self.torques.is_some() {
            writeln!(
                f,
                "fitted to the torques in {:.1} s: training loss {:.3e}{validation}",
                self.preparation_seconds + self.seconds,
                self.train_loss
            )?;
        } else {
            self.iterations(f, &validation)?;
        }
        self.starts.iter().try_for_each(|starts| writeln!(f, "the best of {starts} starts"))?;
        self.torques.iter().try_for_each(|torques| writeln!(f, "torques: {torques}"))?;
        writeln!(f, "run in {}, loss curve in {}", self.run.display(), self.loss_curve.display())?;
        self.report.iter().try_for_each(|page| writeln!(f, "what it is worth: {}", page.display()))
    }
}

impl Report {
    /// Writes how training went on and ended.
    fn iterations(&self, f: &mut fmt::Formatter, validation: &str) -> fmt::Result {
        let Self { iterations, seconds, preparation_seconds, ending, .. } = self;
        let before = match *preparation_seconds {
            ..1.0 => String::new(),
            seconds => format!(" after {seconds:.1} s of preparation"),
        };
        writeln!(f, "{iterations} iterations in {seconds:.1} s{before}, ended by: {ending}")?;
        writeln!(
            f,
            "best at iteration {}: training loss {:.3e}{validation}",
            self.best_iteration, self.train_loss
        )
    }
}

/// Reads the data that a configuration file names and prepares the losses; reports facts that the user should know,
/// each as a sentence.
///
/// # Errors
/// [`Failure::Input`] if a log cannot be read, or if a run with it cannot begin.
pub fn plan(file: &Path, config: Config, tell: &mut dyn FnMut(String)) -> Result<Plan, Failure> {
    let (log, begun) = (PathBuf::from(config.data.file.to_string()), Instant::now());
    let refused = |error: PlanError| match error {
        PlanError::Data(_) => Failure::input(&log, error),
        _ => Failure::input(file, error),
    };
    let Chosen { config, data, notes, choices } = choose(config).map_err(|error| match error {
        ChoiceError::Data(error) => error.into(),
        ChoiceError::Plan(error) => refused(error),
    })?;
    notes::sentences(&notes).into_iter().chain(choices.sentences()).for_each(&mut *tell);
    let plan = Plan::new(config, &data).map_err(refused)?;
    plan.notices().iter().for_each(|notice| tell(notice.to_string()));
    Ok(plan.prepared_in(begun.elapsed()))
}

/// Trains; returns the result, and the reason why training ended.
///
/// # Errors
/// [`Failure::Work`] if training cannot go on.
pub fn train(
    run: &mut Run,
    folder: &Path,
    monitor: &mut dyn Monitor,
    stop: &AtomicBool,
) -> Result<(Report, Ending), Failure> {
    let ending = run.train(monitor, stop)?;
    let best = run.best();
    let torques = run.torque_errors();
    let (training_samples, validation_samples) = match &torques {
        Some(SplitErrors { train, held_back }) => {
            (train.samples, held_back.as_ref().map_or(0, |held_back| held_back.samples))
        }
        None => run.plan().samples(),
    };
    let poor = if ending == Ending::Interrupted { None } else { run.poor(torques.as_ref()) };
    let numbers = if ending == Ending::Interrupted { Vec::new() } else { run.numbers() };
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
        torques,
        numbers,
        starts: Some(run.starts()).filter(|starts| *starts > 1),
        warnings: run.warnings().to_vec(),
        poor: poor.map(|poor| poor.to_string()),
        seconds: run.seconds(),
        preparation_seconds: run.plan().preparation().as_secs_f64(),
        loss_curve: run.loss_curve(),
        report: run.report(),
        saved: run.saved(),
    };
    Ok((report, ending))
}
