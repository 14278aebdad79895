//! The report on a fit, as one HTML page: errors over horizons, predictions, friction, inertia and potential, residuals, and the learned
//! numbers with their standard errors.

mod friction;
mod numbers;
mod pictures;
mod shape;

use crate::evaluate::horizons::{HorizonErrors, Predictions, Predictor, Spread, WHOLE};
use crate::torque_numbers::TorqueNumbers;
use crate::windows::{CalibrationLayout, Certainty, WindowLogs, WindowLoss, certainty};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;
use leastaction_plot::page::{cell, folded, list, number, paragraph, picture, section, table};
use leastaction_plot::{NotDrawn, Stroke};
use thiserror::Error;

pub use numbers::{NamedEstimate, named};

/// A report that cannot be made.
#[derive(Debug, Error)]
pub enum ReportError {
    /// The shape is inconsistent or does not fit the weights.
    #[error("{0}")]
    Model(#[from] ModelError),
    /// A picture cannot be drawn.
    #[error("{0}")]
    Picture(#[from] NotDrawn),
    /// The page cannot be written.
    #[error("the page cannot be written: {0}")]
    Write(#[from] std::io::Error),
}

/// Largest number of windows whose residuals are drawn.
const WINDOWS: usize = 4096;
/// Quantiles of the window errors for which a window is drawn, with their captions.
const DRAWN: [(f64, &str); 2] =
    [(0.5, "a window of the median error"), (0.9, "a window of the 90th percentile")];
/// Range of a coordinate, as a multiple of its noise, below which the log says little about it.
const MOVES: f64 = 20.0;

/// Residuals of windows with their best start states, and the standard errors of the learned numbers.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Residuals q̂ + z − q̃ of every coordinate, m or rad.
    residuals: Vec<Vec<f64>>,
    /// Robust standard deviations of the residuals.
    deviations: Vec<f64>,
    /// Length of a window, s.
    seconds: f64,
    certainty: Option<(Certainty, CalibrationLayout)>,
}

impl Fit {
    /// Evaluates a model over the windows of a loss. `weights` are the weight block followed by the calibration numbers, or all parameters of
    /// the loss. The standard errors are those of the learned numbers of `learned`, as these windows give them; without `learned` there are
    /// none.
    pub fn new(loss: &WindowLoss, weights: &[f64], seconds: f64, learned: Option<&Architecture>) -> Self {
        let weights = loss.settled(weights);
        let deviations = loss.residual_scales(&weights);
        let scaled = loss.scaled_residuals(&weights, WINDOWS);
        let residuals =
            scaled.iter().zip(&deviations).map(|(of, s)| of.iter().map(|x| s * x).collect()).collect();
        let ranges = learned.map(Architecture::ranges);
        let certainty = ranges.and_then(|ranges| certainty(loss, &weights, &ranges));
        Self { residuals, deviations, seconds, certainty: certainty.map(|of| (of, loss.layout())) }
    }
}

/// Contents of a report page.
pub struct Page<'a> {
    /// The title.
    pub title: String,
    /// Facts about the run, as pairs of name and plain text.
    pub facts: Vec<(&'static str, String)>,
    /// The model and the logs on which it is evaluated.
    pub predictor: Predictor<'a>,
    /// Name of a simpler model, and that model with the same logs.
    pub beside: Option<(String, Predictor<'a>)>,
    /// Residuals on the training data; `None` if unknown.
    pub fit: Option<Fit>,
    /// Parameters of an arm as determined by its torques, in place of those determined by windows.
    pub torques: Option<&'a TorqueNumbers>,
}

/// The unit of a force on a coordinate of this unit ([`unit_of`]).
pub fn force_unit(unit: &str) -> &'static str {
    match unit {
        "m" => "N",
        "rad" => "N m",
        _ => "N or N m",
    }
}

/// The unit of coordinate i: m for a translation, rad for an angle; a cyclic coordinate may have either.
pub fn unit_of(letters: &str, i: usize) -> &'static str {
    match letters.as_bytes().get(i) {
        Some(b't') => "m",
        Some(b'c') => "m or rad",
        _ => "rad",
    }
}

impl Page<'_> {
    /// Renders the page.
    ///
    /// # Errors
    /// [`ReportError::Model`], [`ReportError::Picture`].
    pub fn html(&self) -> Result<String, ReportError> {
        let predictions = self.predictor.predict()?;
        let beside = self.beside.as_ref().map(|(name, model)| Ok::<_, ModelError>((name, model.predict()?)));
        let beside = beside.transpose()?;
        let beside = beside.as_ref().map(|(name, predictions)| (name.as_str(), predictions));
        let mut body = self.facts();
        body += &section("Errors of predictions", &self.errors(&predictions, beside)?);
        body += &section("Measured and predicted", &self.motions(&predictions)?);
        body += &section("Friction", &self.friction(&predictions)?);
        body += &section("Inertia and potential", &self.shape()?);
        body += &section("Residuals", &self.residuals()?);
        body += &self.numbers();
        body += &section("What hardly moved", &[list(&self.still())]);
        Ok(leastaction_plot::page::page(&self.title, &body))
    }

    fn logs(&self) -> &WindowLogs {
        self.predictor.logs
    }

    fn letters(&self) -> String {
        self.predictor.model.architecture.coordinates()
    }

    fn noise(&self, i: usize) -> f64 {
        self.logs().noise(0..self.logs().count(), i)
    }

    /// Noise over all coordinates: the root mean square.
    fn whole_noise(&self) -> f64 {
        let squares: f64 = (0..self.logs().n).map(|i| self.noise(i).powi(2)).sum();
        (squares / self.logs().n.max(1) as f64).sqrt()
    }

    /// The unit of errors over all coordinates.
    fn unit(&self) -> &'static str {
        let letters = self.letters();
        match (letters.contains(['t', 'c']), letters.chars().all(|letter| letter == 't')) {
            (_, true) => "m",
            (true, false) => "m, rad",
            (false, false) => "rad",
        }
    }

    fn facts(&self) -> String {
        leastaction_plot::page::facts(&self.facts)
    }

    fn errors(
        &self,
        predictions: &Predictions,
        beside: Option<(&str, &Predictions)>,
    ) -> Result<Vec<String>, NotDrawn> {
        let errors = predictions.errors(self.logs());
        let others = beside.map(|(name, predictions)| (name, predictions.errors(self.logs())));
        let others = others.as_ref().map(|(name, errors)| (*name, &errors[..]));
        if errors.is_empty() {
            return Ok(vec![paragraph(
                "The logs are too short to predict 0.1 s from a start that is known.",
            )]);
        }
        let about = "Each prediction starts from the parabola nearest to seven measured positions and sees the control alone. Its error is \
                     the root mean square over all samples up to the horizon; the median over predictions, and below it what nine of ten \
                     are better than. A perfect model would be off by the noise, and by what the noise does to the start.";
        let whole = format!("Whole logs are predicted from their start, {WHOLE} s at most.");
        let of = |column: usize, noise: f64, unit: &str| error_table(&errors, others, column, (noise, unit));
        let letters = self.letters();
        let each = (0..self.logs().n).map(|i| {
            let unit = unit_of(&letters, i);
            folded(&format!("q{i} alone"), &of(i + 1, self.noise(i), unit))
        });
        let each: String = if self.logs().n > 1 { each.collect() } else { String::new() };
        let noise = self.whole_noise();
        let growth = pictures::growth(predictions, beside, self.logs(), (noise, self.unit()))?;
        Ok(vec![
            paragraph(about),
            of(0, noise, self.unit()),
            paragraph(&whole),
            each,
            if predictions.windows.is_empty() { String::new() } else { picture(&growth) },
        ])
    }

    fn motions(&self, predictions: &Predictions) -> Result<Vec<String>, NotDrawn> {
        let (logs, letters) = (self.logs(), self.letters());
        let mut pictures = Vec::new();
        for (part, what) in DRAWN {
            if let Some(of) = predictions.window_at(logs, part) {
                let title = format!("Log {}: {what}", of.log);
                pictures.push(picture(&pictures::motion(&title, of, (logs, &letters, Stroke::Points))?));
            }
        }
        if let Some(of) = predictions.logs.last() {
            let title = format!("Log {} from its start", of.log);
            pictures.push(picture(&pictures::motion(&title, of, (logs, &letters, Stroke::Wide))?));
        }
        Ok(pictures)
    }

    fn friction(&self, predictions: &Predictions) -> Result<Vec<String>, ReportError> {
        let drawn = friction::pictures(&self.predictor, predictions)?;
        let mut parts = Vec::new();
        if !drawn.is_empty() {
            let about = "What the model's friction does against one velocity alone. Where it depends on the position or on the force of \
                         the drive, it is drawn at some of those that the logs have.";
            parts.push(paragraph(about));
        }
        for svg in drawn {
            parts.push(picture(&svg?));
        }
        Ok(parts)
    }

    fn shape(&self) -> Result<Vec<String>, ReportError> {
        let drawn = shape::pictures(self.predictor.model, self.logs())?;
        let mut parts = Vec::new();
        if !drawn.is_empty() {
            let about = "Over what the logs covered; a second coordinate is where it mostly was.";
            parts.push(paragraph(about));
        }
        for svg in drawn {
            parts.push(picture(&svg?));
        }
        Ok(parts)
    }

    fn residuals(&self) -> Result<Vec<String>, NotDrawn> {
        let Some(Fit { residuals, deviations, seconds, .. }) = &self.fit else { return Ok(Vec::new()) };
        let letters = self.letters();
        let spread = |i: usize| {
            let (unit, noise) = (unit_of(&letters, i), number(self.noise(i)));
            format!(
                "q{i}: robust standard deviation {} {unit}, noise of the sensor {noise} {unit}",
                number(deviations[i])
            )
        };
        let about = format!(
            "Over windows of {seconds} s, each from the start state that fits it best. What is larger than the noise is motion that the \
             model does not explain."
        );
        let count = residuals.len();
        let mut parts = vec![paragraph(&about), list(&(0..count).map(spread).collect::<Vec<_>>())];
        for (i, (of, deviation)) in residuals.iter().zip(deviations).take(pictures::MOST).enumerate() {
            parts.push(picture(&pictures::histogram(i, of, (*deviation, unit_of(&letters, i)))?));
        }
        Ok(parts)
    }

    fn numbers(&self) -> String {
        if let Some(of_torques) = self.torques {
            return numbers::of_torques(of_torques);
        }
        let Some((certainty, layout)) = self.fit.as_ref().and_then(|fit| fit.certainty.as_ref()) else {
            return String::new();
        };
        let names = numbers::Names::of_windows(&self.predictor.model.architecture, layout);
        numbers::sections(certainty, &names).concat()
    }

    /// A sentence for each coordinate that hardly moved, so that the logs say little about its part of the model.
    fn still(&self) -> Vec<String> {
        let moves = |i: usize| {
            let (range, noise) = (self.predictor.range(i), self.noise(i));
            let hardly = range < MOVES * noise;
            hardly
                .then(|| format!("q{i} moved by {} in all, its noise being {}", number(range), number(noise)))
        };
        (0..self.logs().n).filter_map(moves).collect()
    }
}

/// Table of the errors over all horizons, for one column of the error lists, beside those of another model with the
/// same horizons.
fn error_table(
    errors: &[HorizonErrors],
    others: Option<(&str, &[HorizonErrors])>,
    column: usize,
    (noise, unit): (f64, &str),
) -> String {
    let spread = |of: &Spread| cell(number(of.median), &number(of.percentile_90));
    let row = |(k, of): (usize, &HorizonErrors)| {
        let horizon = of.seconds.map_or_else(|| "whole logs".to_owned(), |seconds| format!("{seconds} s"));
        let other = others.and_then(|(_, errors)| errors.get(k)).map(|of| spread(&of.model[column]));
        let mut row = vec![horizon, of.predictions.to_string(), spread(&of.model[column])];
        row.extend(other);
        row.extend([spread(&of.constant_velocity[column]), number(noise)]);
        row
    };
    let mut names = vec!["this model"];
    names.extend(others.map(|(name, _)| name));
    names.extend(["constant velocity", "noise"]);
    let names: Vec<String> = names.iter().map(|name| format!("{name}, {unit}")).collect();
    let head: Vec<&str> =
        ["horizon", "predictions"].into_iter().chain(names.iter().map(String::as_str)).collect();
    table(&head, &[0], &errors.iter().enumerate().map(row).collect::<Vec<_>>())
}
