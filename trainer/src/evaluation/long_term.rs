//! Predictions over many seconds from accelerations, in ModLaNet's measures, beside the error floor of single
//! precision.

use crate::cli::{Failure, FileKind, folder, replaceable};
use leastaction_ground_truth::{
    BadMechanism, ExactMotion, Horizon, LgnnSettings, LgnnSystem, ManyBody, ModlanetSettings, Start,
    lgnn_starts, starts,
};
use leastaction_learning::atomic;
use leastaction_learning::evaluate::prediction::{Prediction, TOLERANCE, Truth};
use leastaction_models::Model;
use leastaction_plot::{Panel, Series, Vertical, time_series};
use serde::Serialize;
use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

/// An exact system of any size.
#[derive(Clone, Copy)]
pub enum Scalable {
    /// One of ModLaNet's systems.
    Modlanet(ManyBody),
    /// One of LGNN's systems.
    Lgnn(LgnnSystem),
}

impl Scalable {
    fn name(self) -> &'static str {
        match self {
            Self::Modlanet(system) => system.name(),
            Self::Lgnn(system) => system.name(),
        }
    }

    fn count(self) -> usize {
        match self {
            Self::Modlanet(system) => system.count(),
            Self::Lgnn(system) => system.nodes(),
        }
    }

    fn motion(self) -> Result<Box<dyn ExactMotion>, BadMechanism> {
        match self {
            Self::Modlanet(system) => system.motion(),
            Self::Lgnn(system) => Ok(Box::new(LgnnSettings::published(system, 0).truss()?)),
        }
    }

    /// Random starts from the authors' distribution.
    fn starts(self, trajectories: usize, seed: u64) -> Vec<Start> {
        match self {
            Self::Modlanet(system) => {
                starts(&ModlanetSettings { trajectories, ..ModlanetSettings::published(system, seed) })
            }
            Self::Lgnn(system) => {
                lgnn_starts(&LgnnSettings { trajectories, ..LgnnSettings::published(system, seed) })
            }
        }
    }
}

/// Settings of the predictions.
pub struct Request<'a> {
    /// The model.
    pub model: &'a Model,
    /// The exact system.
    pub system: Scalable,
    /// Number of random starts.
    pub starts: usize,
    /// Length of the predictions, s.
    pub seconds: f64,
    /// Seed of the starts.
    pub seed: u64,
}

/// Results of the predictions.
#[derive(Serialize)]
pub struct LongTerm {
    system: &'static str,
    count: usize,
    starts: usize,
    seconds: f64,
    seed: u64,
    learned: Measures,
    /// Errors with the exact accelerations rounded to single precision.
    single_precision: Measures,
    #[serde(skip_serializing_if = "Option::is_none")]
    curves: Option<PathBuf>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PathBuf>,
}

/// Errors of predictions over all starts.
#[derive(Serialize)]
struct Measures {
    /// Mean position error of the predictions that did not break off; the following errors also cover only these.
    position: Option<f64>,
    position_deviation: Option<f64>,
    energy: Option<f64>,
    energy_deviation: Option<f64>,
    valid_mean: f64,
    valid_median: f64,
    failed: usize,
}

impl From<&Prediction> for Measures {
    fn from(prediction: &Prediction) -> Self {
        let [position, energy] = prediction.of_followed().map_or([None; 2], |both| both.map(Some));
        Self {
            position: position.map(|average| average.mean),
            position_deviation: position.map(|average| average.deviation),
            energy: energy.map(|average| average.mean),
            energy_deviation: energy.map(|average| average.deviation),
            valid_mean: prediction.valid().mean,
            valid_median: prediction.valid_median(),
            failed: prediction.failed(),
        }
    }
}

impl Request<'_> {
    /// Predicts, and writes the curves into a folder if one is given.
    pub fn run(&self, output: Option<&Path>) -> Result<LongTerm, Failure> {
        let failed = |error: &dyn fmt::Display| Failure::Work(error.to_string());
        let files = output.map(files).transpose()?;
        let motion = self.system.motion().map_err(|error| Failure::Input(error.to_string()))?;
        let starts = self.system.starts(self.starts, self.seed);
        let truth = Truth::new(motion.as_ref(), starts, Horizon::of_seconds(self.seconds))
            .map_err(|error| failed(&error))?;
        let learned = self
            .model
            .with_accelerations(|accelerations| truth.compare(TOLERANCE, motion.as_ref(), accelerations))
            .map_err(|error| failed(&error))?;
        let floor = truth.single_precision(motion.as_ref());
        let mut report = LongTerm {
            system: self.system.name(),
            count: self.system.count(),
            starts: self.starts,
            seconds: self.seconds,
            seed: self.seed,
            learned: Measures::from(&learned),
            single_precision: Measures::from(&floor),
            curves: None,
            picture: None,
        };
        if let Some([table, picture]) = files {
            let curves = Curves { h: truth.horizon().h, learned: &learned, floor: &floor };
            curves.write(&table).map_err(|error| Failure::file(&table, error))?;
            curves.draw(&picture).map_err(|error| Failure::file(&picture, error))?;
            (report.curves, report.picture) = (Some(table), Some(picture));
        }
        Ok(report)
    }
}

/// Paths of the table and the plot in a folder; refuses to replace other files.
fn files(path: &Path) -> Result<[PathBuf; 2], Failure> {
    let files = [path.join("prediction.csv"), path.join("prediction.svg")];
    folder(path)?;
    replaceable(&files[0], FileKind::Table(HEAD))?;
    replaceable(&files[1], FileKind::Picture)?;
    Ok(files)
}

/// The first line of the table.
const HEAD: &str = "t,mse_q,mse_energy,single_precision_mse_q,single_precision_mse_energy\n";

/// Error curves over time.
struct Curves<'a> {
    h: f64,
    learned: &'a Prediction,
    floor: &'a Prediction,
}

impl Curves<'_> {
    fn write(&self, file: &Path) -> std::io::Result<()> {
        let mut text = HEAD.to_owned();
        let learned = self.learned.mse_q.iter().zip(&self.learned.mse_energy);
        let floor = self.floor.mse_q.iter().zip(&self.floor.mse_energy);
        for (k, ((q, energy), (floor_q, floor_energy))) in learned.zip(floor).enumerate() {
            // Writing to a string cannot fail.
            let _infallible =
                writeln!(text, "{},{q:e},{energy:e},{floor_q:e},{floor_energy:e}", k as f64 * self.h);
        }
        atomic::write(file, text.as_bytes())
    }

    fn draw(&self, file: &Path) -> Result<(), leastaction_plot::PlotError> {
        let series = |label: &str, values: &[f64]| {
            Series::new(label, values.iter().enumerate().map(|(k, value)| (k as f64 * self.h, *value)))
        };
        let both = |pick: fn(&Prediction) -> &[f64]| {
            [series("learned", pick(self.learned)), series("exact, single precision", pick(self.floor))]
        };
        let (q, energy) = (both(|p| &p.mse_q), both(|p| &p.mse_energy));
        let panels = [("MSE of q", &q), ("MSE of the energy (J²)", &energy)]
            .map(|(label, series)| Panel::new(label, series).with_vertical(Vertical::Logarithmic));
        time_series(file, "Prediction", &panels)
    }
}

impl fmt::Display for LongTerm {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { system, count, starts, seconds, learned, single_precision, .. } = self;
        writeln!(f, "prediction of {system} of {count} over {seconds} s from {starts} starts")?;
        writeln!(f, "{:<30} {:>12} {:>24}", "", "learned", "exact, single precision")?;
        type Row = (&'static str, fn(&Measures) -> Option<f64>);
        let rows: [Row; 4] = [
            ("position error A_q", |m| m.position),
            ("energy error A_E (J)", |m| m.energy),
            ("valid for, mean (s)", |m| Some(m.valid_mean)),
            ("valid for, median (s)", |m| Some(m.valid_median)),
        ];
        for (name, pick) in rows {
            let number = |x: Option<f64>| match x {
                None => "none".to_owned(),
                Some(x) if name.starts_with("valid") => format!("{x:.2}"),
                Some(x) => format!("{x:.3e}"),
            };
            writeln!(f, "{name:<30} {:>12} {:>24}", number(pick(learned)), number(pick(single_precision)))?;
        }
        if learned.failed > 0 {
            writeln!(f, "{} of {starts} predictions broke off, and have no errors", learned.failed)?;
        }
        let files = self.curves.iter().zip(&self.picture);
        files.into_iter().try_for_each(|(curves, picture)| {
            writeln!(f, "curves in {}, picture in {}", curves.display(), picture.display())
        })
    }
}
