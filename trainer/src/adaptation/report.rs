//! Findings along a log.

use crate::evaluation::Log;
use leastaction_adaptation::{Choice, Course, Followed};
use leastaction_learning::config::TrainingConfig;
use leastaction_learning::torques::torque_errors;
use leastaction_models::Model;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Findings along a log.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
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
    /// Unit; empty for a number without one.
    pub unit: &'static str,
    /// Value in the model.
    pub model: f32,
    /// Standard deviation of the distance from it, before anything was seen; 0 for a number that stays.
    pub prior: f32,
    /// Estimated distance from the model.
    pub distance: f32,
    /// Standard error of the distance.
    pub standard_error: f32,
    /// Distance in use, within the limits.
    pub used: f32,
}

/// Share of the prior deviation below which the standard error of a number counts as found.
const FOUND: f32 = 0.5;

impl NumberReport {
    /// Standard error as a share of the deviation before anything was seen; `None` for a number that stays.
    pub fn share(&self) -> Option<f32> {
        (self.prior > 0.0).then(|| self.standard_error / self.prior)
    }

    /// Whether the log shows the number: half of what was open before is known.
    pub fn is_found(&self) -> bool {
        self.share().is_some_and(|share| share < FOUND)
    }
}

impl Report {
    /// Reports on numbers of a model from `file` that have followed a log.
    pub fn new((file, model): (&Path, &Model), log: &Log, followed: &Followed) -> Self {
        let Followed { choice, course, model: adapted } = followed;
        let mass = course.mass(choice);
        let cut_off = TrainingConfig::default().cut_off;
        let nmse = |model: &Model| Some(torque_errors(model, &log.data, cut_off)?.nmse);
        Self {
            model: file.to_owned(),
            log: log.file.clone(),
            seconds: log.data.samples() as f64 * log.data.h,
            mass: mass.map(|mass| f64::from(mass.estimate)),
            standard_error: mass.map(|mass| f64::from(mass.error)),
            announced: course.announced.is_some(),
            seconds_to_announce: course.announced.map(|_| course.moving),
            nmse_before: nmse(model),
            nmse_after: nmse(adapted),
            numbers: numbers((model, choice), course),
            changes: course.changes(),
            unlike: course.unlike(),
        }
    }

    /// The number of the mass that may be attached, if the model has bodies.
    pub fn attached(&self) -> Option<&NumberReport> {
        self.mass.and(self.numbers.first())
    }
}

/// The numbers of a model at the end of a course.
pub fn numbers((model, choice): (&Model, &Choice), course: &Course) -> Vec<NumberReport> {
    let Some(last) = course.entries.last() else { return Vec::new() };
    let labels = choice.labels(&model.architecture.coordinates());
    let found = last.estimates.iter().zip(&last.applied);
    let all = labels.into_iter().zip(&choice.settings.numbers).zip(found);
    all.map(|((label, following), (found, used))| NumberReport {
        name: label.name(),
        unit: label.unit,
        model: following.model,
        prior: following.prior,
        distance: found.estimate,
        standard_error: found.error,
        used: *used,
    })
    .collect()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}: {:.1} s", self.log.display(), self.seconds)?;
        if let (Some(mass), Some(error)) = (self.mass, self.standard_error) {
            writeln!(f, "attached {mass:.3} kg, standard error {error:.3} kg")?;
            match self.seconds_to_announce {
                Some(seconds) => writeln!(f, "announced after {seconds:.1} s of motion")?,
                None => writeln!(f, "nothing announced")?,
            }
        }
        if let (Some(before), Some(after)) = (self.nmse_before, self.nmse_after) {
            writeln!(
                f,
                "squared error of torques over their variance: {before:.4} before, {after:.4} after"
            )?;
        }
        let found = self.numbers.iter().filter(|number| number.is_found()).count();
        writeln!(f, "the log shows {found} of {} numbers", self.numbers.len())?;
        writeln!(
            f,
            "changes at {:?} s{}",
            self.changes,
            if self.unlike { "; not the machine that was learned" } else { "" }
        )
    }
}
