//! Numbers of a model that follow a log: reading of the logs, the report, and its page.

mod course;
mod page;
mod report;
mod verdict;

pub use report::{NumberReport, Report, numbers};

use crate::cli::Failure;
use crate::evaluation::{Evaluation, Log, LogReading, Tell};
use crate::models::fingerprint_of;
use leastaction_adaptation::{AdaptationError, Choice, Followed, Request};
use leastaction_learning::atomic;
use leastaction_models::Model;
use std::path::Path;

const NO_NETWORKS: &str = "the model has no network whose numbers can follow the machine: neither a correcting potential nor dissipation by \
                           a network";

/// A model whose numbers are to follow a log.
pub struct Adaptation<'a> {
    /// File of the model, or folder of its run.
    pub file: &'a Path,
    /// The model.
    pub model: &'a Model,
    /// Configuration that names the log on which the model is right; without it that of the run, if there is one.
    pub config: Option<&'a Path>,
    /// Wishes.
    pub request: Request,
}

/// A model whose numbers have followed a log.
pub struct Adapted<'a> {
    of: Adaptation<'a>,
    log: Log,
    is_measured: bool,
    /// The numbers and their course.
    pub followed: Followed,
    /// Findings.
    pub report: Report,
}

impl<'a> Adaptation<'a> {
    /// Lets the numbers follow a log; reports what the user should know about the logs.
    ///
    /// # Errors
    /// [`Failure::Input`] if a log cannot be read, or if no number can follow it.
    pub fn along(self, reading: &LogReading, tell: Tell) -> Result<Adapted<'a>, Failure> {
        if self.request.networks && self.model.architecture.corrections.is_none() {
            return Err(Failure::input(self.file, NO_NETWORKS));
        }
        let log = self.read(reading, tell)?;
        let training = self.training(tell)?;
        if training.is_none() {
            tell(
                "how uncertain the model is in itself is taken from this log, after its numbers have followed it; name the configuration \
                 that it was trained by"
                    .to_owned(),
            );
        }
        let right = training.as_ref().map(|training| &training.data);
        let followed = Followed::new(self.model, &log.data, right, &self.request);
        let followed = followed.map_err(|error| self.refused(&error, &log.file))?;
        let report = Report::new((self.file, self.model), &log, &followed);
        Ok(Adapted { of: self, log, is_measured: training.is_some(), followed, report })
    }

    fn read(&self, reading: &LogReading, tell: Tell) -> Result<Log, Failure> {
        let Self { file, model, .. } = *self;
        Evaluation { file, model, order: None, control: None }.read(reading, tell)
    }

    /// The log that the model learned from, if its configuration is known.
    fn training(&self, tell: Tell) -> Result<Option<Log>, Failure> {
        let reading = LogReading::of_training(self.config, self.file)?;
        reading.map(|reading| self.read(&reading, tell)).transpose()
    }

    fn refused(&self, error: &AdaptationError, log: &Path) -> Failure {
        match error {
            AdaptationError::Nothing | AdaptationError::NoSuchBody { .. } | AdaptationError::Model(_) => {
                Failure::input(self.file, error)
            }
            _ => Failure::input(log, error),
        }
    }
}

impl Adapted<'_> {
    /// Writes the page on the course of the numbers.
    ///
    /// # Errors
    /// [`Failure::Work`] if it cannot be drawn or written.
    pub fn write_page(&self, path: &Path) -> Result<(), Failure> {
        let page = page::Page::new(self).map_err(|error| self.of.refused(&error, &self.log.file))?;
        let html = page.html().map_err(|error| Failure::file(path, error))?;
        atomic::write(path, html.as_bytes()).map_err(|error| Failure::file(path, error))
    }
    /// Writes the numbers in use at the end of the log as a patch of the model.
    ///
    /// # Errors
    /// [`Failure`] if the model has no file, or the patch cannot be written.
    pub fn write_patch(&self, path: &Path) -> Result<(), Failure> {
        let patch = self.followed.patch(fingerprint_of(self.of.file)?);
        let patch = patch.map_err(|error| self.of.refused(&error, &self.log.file))?;
        atomic::write(path, &patch).map_err(|error| Failure::file(path, error))
    }

    /// Settings of an adapter for a control loop with ticks of `tick` seconds, whose uncertainty is that measured here.
    ///
    /// # Errors
    /// [`Failure`] if no number can follow.
    fn of_loop(&self, tick: f64) -> Result<Choice, Failure> {
        let choice = Choice::of_loop(self.of.model, tick, &self.of.request);
        let mut choice = choice.map_err(|error| self.of.refused(&error, &self.log.file))?;
        choice.settings.deviation.clone_from(&self.followed.choice.settings.deviation);
        Ok(choice)
    }

    /// Writes the settings of an adapter for a control loop with ticks of `tick` seconds as Rust source.
    ///
    /// # Errors
    /// [`Failure`] if no number can follow, or the source cannot be written.
    pub fn write_source(&self, path: &Path, tick: f64) -> Result<(), Failure> {
        let source = self.of_loop(tick)?.source(self.of.model.n());
        atomic::write(path, source.as_bytes()).map_err(|error| Failure::file(path, error))
    }

    /// Writes the settings of an adapter for a control loop with ticks of `tick` seconds as a file that a controller reads.
    ///
    /// # Errors
    /// [`Failure`] if no number can follow, or the file cannot be written.
    pub fn write_settings(&self, path: &Path, tick: f64) -> Result<(), Failure> {
        let file = self.of_loop(tick)?.settings_file(fingerprint_of(self.of.file)?);
        let file = file.map_err(|error| self.of.refused(&error, &self.log.file))?;
        atomic::write(path, &file).map_err(|error| Failure::file(path, error))
    }
}
