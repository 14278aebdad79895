//! `leastaction adapt`.

use clap::Args;
use leastaction::cli::arguments::positive;
use leastaction::cli::{Done, Failure, Output};
use leastaction::evaluation::{Evaluation, LogReading};
use leastaction::models::of_file_or_run;
use leastaction_adaptation::{
    AdaptationError, Choice, Course, Difference, Following, Request, along, deviations, name, on_chip,
};
use leastaction_learning::config::TrainingConfig;
use leastaction_learning::data::Dataset;
use leastaction_learning::torques::torque_errors;
use leastaction_models::Model;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Let numbers of a model follow the machine along a log: what it carries, and how its friction changes.
///
/// The filter is the controller's, in its arithmetic: over windows of the momentum balance it estimates the ten inertial numbers of a body,
/// to which something may be attached, and the friction of every coordinate, with standard errors. It says what is attached as soon as that is
/// sure, at a stated rate of false alarms.
///
/// How uncertain the model is in itself is measured on the log that it learned from: that of --config, or of the run. Without either, it is
/// taken from the log itself, after the numbers have followed it.
///
/// Example: leastaction adapt run --data loaded.csv
///
/// Example: leastaction adapt arm.postcard --data loaded.csv --config arm.toml --json
#[derive(Args)]
pub struct Adapt {
    /// The model file, or the folder of a training run.
    model: PathBuf,
    /// The log.
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    /// The configuration that the model was trained by: its [data] says how logs are read, and names the log on which the model is right.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Body to which something may be attached, counted from 0 [default: the last one].
    #[arg(long, value_name = "BODY")]
    body: Option<usize>,
    /// Standard deviation of what may be attached, kg [default: a quarter of the mechanism].
    #[arg(long, value_name = "KG", value_parser = positive)]
    mass: Option<f64>,
    /// Friction stays what it is.
    #[arg(long)]
    no_friction: bool,
    /// Length of a window, s [default: .2, and at least 40 samples].
    #[arg(long, value_name = "S", value_parser = positive)]
    window: Option<f64>,
    /// Time that is remembered, s.
    #[arg(long, value_name = "S", value_parser = positive, default_value_t = 20.0)]
    memory: f64,
    /// False alarms in an hour.
    #[arg(long, value_name = "RATE", value_parser = positive, default_value_t = 1e-3)]
    false_alarms: f64,
}

/// Findings along a log.
#[derive(Debug, Serialize)]
pub struct AdaptReport {
    /// The model.
    pub model: PathBuf,
    /// The log.
    pub log: PathBuf,
    /// Length of the log, s.
    pub seconds: f64,
    /// Mass that is attached at the end of the log, kg; `None` for a model without bodies.
    pub mass: Option<f64>,
    /// Standard error of the mass, kg.
    pub standard_error: Option<f64>,
    /// Whether something was announced as attached.
    pub announced: bool,
    /// Time in motion before that, s.
    pub seconds_to_announce: Option<f64>,
    /// Mean over coordinates of the torques' squared error over their variance, by the model as it is.
    pub nmse_before: Option<f64>,
    /// Mean error with the numbers at the end of the log.
    pub nmse_after: Option<f64>,
    /// Numbers at the end of the log.
    pub numbers: Vec<NumberReport>,
    /// Times at which something changed at once, s.
    pub changes: Vec<f64>,
    /// Whether no choice of the numbers explains the machine.
    pub unlike: bool,
}

/// A number at the end of a log.
#[derive(Clone, Debug, Serialize)]
pub struct NumberReport {
    /// Name of the number.
    pub name: String,
    /// Value in the model.
    pub model: f32,
    /// Estimated distance from it.
    pub distance: f32,
    /// Standard error of the distance.
    pub standard_error: f32,
    /// Distance in use, within the limits.
    pub used: f32,
}

impl Adapt {
    /// Reads the model and the logs, and lets the numbers follow.
    pub fn run(self, output: Output) -> Done {
        let model = of_file_or_run(&self.model, None)?;
        let log = self.read(&model, Some(&self.data), output)?;
        let choice = Choice::new(&model, log.h, &self.request()).map_err(|error| self.refused(&error))?;
        let choice = self.with_deviations(&model, choice, &log, output)?;
        let course = course(&model, &choice, &log).map_err(|error| self.refused(&error))?;
        let report = self.report((&model, &choice), &log, &course)?;
        output.report(&report)
    }

    fn request(&self) -> Request {
        let Self { body, mass, window, memory, false_alarms, .. } = *self;
        Request { body, mass, window, memory, false_alarms, friction: !self.no_friction }
    }

    fn refused(&self, error: &AdaptationError) -> Failure {
        match error {
            AdaptationError::Nothing | AdaptationError::NoSuchBody { .. } | AdaptationError::Model(_) => {
                Failure::input(&self.model, error)
            }
            _ => Failure::input(&self.data, error),
        }
    }

    /// Reads a log, or else that of the training.
    fn read(&self, model: &Model, file: Option<&PathBuf>, output: Output) -> Result<Dataset, Failure> {
        let of_run = self.model.join("config.toml");
        let config = self.config.clone().or_else(|| of_run.is_file().then_some(of_run));
        let reading = match config {
            Some(config) => LogReading::new(Some(&config), file.cloned().map(Into::into), &self.model)?,
            None => LogReading::new(None, file.cloned().map(Into::into), &self.model)?,
        };
        let evaluation = Evaluation { file: &self.model, model, order: None, control: None };
        let tell = &mut |sentence: String| output.note(&format!("note: {sentence}"));
        Ok(evaluation.read(&reading, tell)?.data)
    }

    /// Sets how uncertain the model is in itself.
    fn with_deviations(
        &self,
        model: &Model,
        mut choice: Choice,
        log: &Dataset,
        output: Output,
    ) -> Result<Choice, Failure> {
        let is_known = self.config.is_some() || self.model.join("config.toml").is_file();
        if is_known {
            let training = self.read(model, None, output)?;
            choice.settings.deviation =
                measured(model, &choice, &training).map_err(|error| self.refused(&error))?;
            return Ok(choice);
        }
        output.note(
            "note: how uncertain the model is in itself is taken from this log, after its numbers have followed it; name the configuration \
             that it was trained by with --config",
        );
        choice.settings.deviation = measured(model, &choice, log).map_err(|error| self.refused(&error))?;
        for _ in 0..ROUNDS {
            let course = course(model, &choice, log).map_err(|error| self.refused(&error))?;
            let adapted = adapted(model, &choice, &course).map_err(|error| self.refused(&error))?;
            choice.settings.deviation =
                measured(&adapted, &choice, log).map_err(|error| self.refused(&error))?;
        }
        Ok(choice)
    }

    fn report(
        &self,
        (model, choice): (&Model, &Choice),
        log: &Dataset,
        course: &Course,
    ) -> Result<AdaptReport, Failure> {
        let adapted = adapted(model, choice, course).map_err(|error| self.refused(&error))?;
        let mass = course.mass(choice);
        let cut_off = TrainingConfig::default().cut_off;
        let nmse = |model: &Model| Some(torque_errors(model, log, cut_off)?.nmse);
        Ok(AdaptReport {
            model: self.model.clone(),
            log: self.data.clone(),
            seconds: log.samples() as f64 * log.h,
            mass: mass.map(|mass| f64::from(mass.estimate)),
            standard_error: mass.map(|mass| f64::from(mass.error)),
            announced: course.announced.is_some(),
            seconds_to_announce: course.announced.map(|_| course.moving),
            nmse_before: nmse(model),
            nmse_after: nmse(&adapted),
            numbers: numbers(choice, course),
            changes: course.changes(),
            unlike: course.unlike(),
        })
    }
}

/// The numbers at the end of a course.
pub fn numbers(choice: &Choice, course: &Course) -> Vec<NumberReport> {
    let Some(last) = course.entries.last() else { return Vec::new() };
    let all = choice.settings.numbers.iter().zip(&last.estimates).zip(&last.applied);
    let report = |((following, found), used): ((&Following, &Difference<f32>), &f32)| NumberReport {
        name: name(following.number),
        model: following.model,
        distance: found.estimate,
        standard_error: found.error,
        used: *used,
    };
    all.map(report).collect()
}

/// Rounds in which the uncertainty of the model is taken from the log itself.
const ROUNDS: usize = 3;

fn course(model: &Model, choice: &Choice, log: &Dataset) -> Result<Course, AdaptationError> {
    on_chip(model, |chip| along((model, chip), choice, log))
}

fn measured(model: &Model, choice: &Choice, log: &Dataset) -> Result<Vec<f32>, AdaptationError> {
    on_chip(model, |chip| deviations((model, chip), choice, log))
}

/// The model with the numbers in use at the end of a log.
fn adapted(model: &Model, choice: &Choice, course: &Course) -> Result<Model, AdaptationError> {
    let distances = course.entries.last().map(|entry| entry.applied.as_slice()).unwrap_or_default();
    choice.adapted(model, distances)
}

impl fmt::Display for AdaptReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}: {:.1} s", self.log.display(), self.seconds)?;
        if let (Some(mass), Some(error)) = (self.mass, self.standard_error) {
            writeln!(f, "attached {mass:.3} kg, standard error {error:.3} kg")?;
        }
        match self.seconds_to_announce {
            Some(seconds) => writeln!(f, "announced after {seconds:.1} s of motion")?,
            None => writeln!(f, "nothing announced")?,
        }
        if let (Some(before), Some(after)) = (self.nmse_before, self.nmse_after) {
            writeln!(
                f,
                "squared error of torques over their variance: {before:.4} before, {after:.4} after"
            )?;
        }
        writeln!(
            f,
            "changes at {:?} s{}",
            self.changes,
            if self.unlike { "; not the machine that was learned" } else { "" }
        )
    }
}
