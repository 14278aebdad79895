//! `leastaction reproduce modlanet`.

mod figures;
mod table;

use crate::commands::Done;
use crate::commands::arguments::{positive, seed};
use crate::commands::output::{Failure, Output, folder, object, refuse};
use clap::{Args, ValueEnum};
use leastaction::atomic;
use leastaction::data::modlanet;
use leastaction::reproduce::modlanet::{Case, Limits, Options, Outcome, ReproduceError, run};
use leastaction_core::energy::modular::PairInput;
use std::path::PathBuf;
use std::time::Duration;
pub use table::numbered;
use table::{Scatter, Table, csv};

/// ModLaNet (Lu et al., ICML 2022): pendulums and bodies from accelerations, extended to more of them.
///
/// Runs every case that the options leave open and prints its errors beside the paper's. Predictions are judged in the
/// paper's measures, which are not mean squares: the Frobenius norm of the errors over the number of comparisons, averaged
/// over 100 starts. Pendulums are chaotic: what exact physics in single precision reaches stands beside.
///
/// With --baselines the models that the paper compares with (HNN, LNN and MLP, and light ones of about ModLaNet's size) are
/// trained by their authors' recipes beside ours: Adam with 10,000 epochs of pendulums, 3,000 of bodies, which takes an hour and
/// more for some. A row that ran out of time, or diverged, says so.
///
/// Example: leastaction reproduce modlanet --case double-pendulum --json
#[derive(Args)]
pub struct Modlanet {
    /// Only this experiment.
    #[arg(long)]
    case: Option<Case>,
    /// A data set in the layout of the ModLaNet authors (x, v, ac, test_x, …) instead of a generated one, of two pendulums or
    /// three bodies; needs --case.
    #[arg(long, value_name = "FILE", requires = "case")]
    data: Option<PathBuf>,
    /// What the bodies' pair potential sees of two positions.
    #[arg(long, default_value = "inverse-distance")]
    pair: Pair,
    /// Iterations of Levenberg-Marquardt at most; by default as many as the case needs.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: Option<u32>,
    /// The most samples of dataset-size.
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(10_000..))]
    samples: u32,
    /// Starts of the predictions.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    starts: u32,
    /// Of the initial weights and, without --data, of the data.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Repeats every case with so many seeds from --seed on, and says how far the errors scatter; more than one without
    /// predictions.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    seeds: u32,
    /// Also trains the models that the paper compares with, in double-pendulum and three-body.
    #[arg(long)]
    baselines: bool,
    /// Epochs of the baselines at most; by default as many as their authors'.
    #[arg(long, requires = "baselines", value_parser = clap::value_parser!(u64).range(1..))]
    epochs: Option<u64>,
    /// Minutes of training of each baseline at most, and again of its predictions; by default no limit.
    #[arg(long, requires = "baselines", value_parser = positive)]
    minutes: Option<f64>,
    /// Writes table.csv there, and pictures: errors and paths of every prediction, and for double-pendulum the energy over a
    /// million steps.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Pair {
    /// One over the distance of the two: 1/|a - b|.
    InverseDistance,
    /// The distance of the two: |a - b|.
    Distance,
    /// The difference: a - b.
    Difference,
    /// Both positions (the authors').
    Concat,
}

impl Modlanet {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        if let Some(case) = self.case.filter(|case| self.baselines && !case.has_baselines()) {
            let name = case.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
            refuse(&name, &[(true, "--baselines")])?;
        }
        self.output.as_deref().map_or(Ok(()), folder)?;
        let mut rows = Vec::new();
        for case in Case::ALL.into_iter().filter(|case| self.case.is_none_or(|only| only == *case)) {
            for seed in (self.seed..).take(self.seeds as usize) {
                rows.extend(self.rows(case, seed, output)?);
            }
        }
        self.write(&rows)?;
        match &rows[..] {
            // One row as one flat object.
            [row] if output.json => object(row),
            _ => {
                let scatter = (self.seeds > 1).then(|| Scatter::of_all(&rows));
                output.report(&Table { rows, scatter })
            }
        }
    }

    fn rows(&self, case: Case, seed: u64, output: Output) -> Result<Vec<Outcome>, Failure> {
        let read = |file: &PathBuf| modlanet::read(file).map_err(|error| Failure::Input(error.to_string()));
        let data = self.data.as_ref().map(read).transpose()?;
        if let (Some(file), None) = (&self.data, case.system()) {
            let reason = "this case generates its data; leave out --data".to_owned();
            return Err(Failure::Input(format!("{}: {reason}", file.display())));
        }
        let rows = run(case, &self.options(seed), data, &mut |line| output.note(line));
        rows.map_err(|error| match (&self.data, error) {
            (Some(file), error @ ReproduceError::Coordinates { .. }) => {
                Failure::Input(format!("{}: {error}", file.display()))
            }
            (_, error) => Failure::Work(error.to_string()),
        })
    }

    fn options(&self, seed: u64) -> Options {
        Options {
            pair: match self.pair {
                Pair::InverseDistance => PairInput::InverseDistance,
                Pair::Distance => PairInput::Distance,
                Pair::Difference => PairInput::Difference,
                Pair::Concat => PairInput::Concat,
            },
            iterations: self.iterations.map(|iterations| iterations as usize),
            most_samples: self.samples as usize,
            starts: if self.seeds > 1 { 0 } else { self.starts as usize },
            steps: if self.seeds > 1 { 0 } else { LONG_RUN },
            baselines: self.baselines.then(|| Limits {
                epochs: self.epochs,
                time: self.minutes.map(|minutes| Duration::from_secs_f64(60.0 * minutes.min(LONGEST))),
            }),
            ..Options::new(seed)
        }
    }

    fn write(&self, rows: &[Outcome]) -> Done {
        let Some(folder) = &self.output else { return Ok(()) };
        let table = folder.join("table.csv");
        atomic::write(&table, csv(rows).as_bytes()).map_err(|error| Failure::file(&table, error))?;
        figures::draw(folder, rows)
    }
}

/// More minutes than anyone waits.
const LONGEST: f64 = 1e9;
/// Steps of the long run in single precision.
const LONG_RUN: usize = 1_000_000;
