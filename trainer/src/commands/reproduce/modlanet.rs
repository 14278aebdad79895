//! `leastaction reproduce modlanet`.

use crate::commands::Done;
use crate::commands::arguments::seed;
use crate::commands::output::{Failure, Output, folder, object};
use clap::{Args, ValueEnum};
use leastaction::atomic;
use leastaction::data::modlanet;
use leastaction::plot::{Panel, PlotError, Series, time_series};
use leastaction::reproduce::modlanet::{Case, LongRun, Options, Outcome, ReproduceError, Stepped, run};
use leastaction_core::energy::modular::PairInput;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// ModLaNet (Lu et al., ICML 2022): pendulums and bodies from accelerations, extended to more of them.
///
/// Runs every case that the options leave open and prints its errors beside the paper's. Predictions are judged in the
/// paper's measures, which are not mean squares: the Frobenius norm of the errors over the number of comparisons, averaged
/// over 100 starts. Pendulums are chaotic: what exact physics in single precision reaches stands beside.
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
    /// Iterations of Levenberg-Marquardt at most.
    #[arg(long, default_value_t = 150, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
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
    /// Writes table.csv there, and for double-pendulum a picture of the energy over a million steps.
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
            iterations: self.iterations as usize,
            most_samples: self.samples as usize,
            starts: if self.seeds > 1 { 0 } else { self.starts as usize },
            steps: if self.seeds > 1 { 0 } else { LONG_RUN },
            ..Options::new(seed)
        }
    }

    fn write(&self, rows: &[Outcome]) -> Done {
        let Some(folder) = &self.output else { return Ok(()) };
        let table = folder.join("table.csv");
        atomic::write(&table, csv(rows).as_bytes()).map_err(|error| Failure::file(&table, error))?;
        let Some(run) = rows.iter().find_map(|row| row.long_run.as_ref()) else { return Ok(()) };
        let picture = folder.join("energy.svg");
        draw_energy(&picture, run).map_err(|error| Failure::file(&picture, error))
    }
}

/// The energy error of the long runs over time.
fn draw_energy(file: &Path, run: &LongRun) -> Result<(), PlotError> {
    let series = |label: &str, errors: &[(f64, f64)]| Series::new(label, errors.iter().copied());
    let del = [series("DEL, order 2", &run.del_2), series("DEL, order 4", &run.del_4)];
    let rk4 = [series("Runge-Kutta, order 4", &run.rk4)];
    let title = format!("Learned double pendulum, {} steps of {} s in f32", run.steps, run.h);
    let panels = [Panel::new("energy error (J)", &del), Panel::new("energy error (J)", &rk4)];
    time_series(file, &title, &panels)
}

/// The rows as comma-separated values with a header; empty where there is no prediction.
fn csv(rows: &[Outcome]) -> String {
    let mut text = String::from(
        "system,count,kind,samples,parameters,train_mse,test_mse,relative_test_mse,position,energy,valid_seconds,\
         floor_position,floor_energy,floor_valid_seconds,train_seconds,seed,noise\n",
    );
    for row in rows {
        let Outcome { system, count, kind, samples, parameters, train_mse, test_mse, .. } = row;
        let predicted = row.predicted.map_or_else(
            || ",,,,,".to_owned(),
            |p| {
                let floor = format!("{:e},{:e},{}", p.floor_position, p.floor_energy, p.floor_valid_seconds);
                format!("{:e},{:e},{},{floor}", p.position, p.energy, p.valid_seconds)
            },
        );
        text += &format!(
            "{system},{count},{kind},{samples},{parameters},{train_mse:e},{test_mse:e},{:e},{predicted},{:.1},{},{}\n",
            row.relative_test_mse, row.train_seconds, row.seed, row.noise
        );
    }
    text
}

/// Steps of the long run in single precision.
const LONG_RUN: usize = 1_000_000;

/// All rows.
#[derive(Serialize)]
struct Table {
    rows: Vec<Outcome>,
    /// Of the test errors, over the seeds.
    scatter: Option<Vec<Scatter>>,
}

/// How far the test errors of several seeds lie apart, for one row of the table.
#[derive(Serialize)]
struct Scatter {
    system: &'static str,
    count: usize,
    kind: &'static str,
    samples: usize,
    noise: f64,
    least: f64,
    median: f64,
    largest: f64,
    /// The median, relative to the mean squared acceleration of the test set.
    relative_median: f64,
    /// Seeds whose error is not a finite number.
    failed: usize,
}

impl Scatter {
    /// Of every row that the first seed has.
    fn of_all(rows: &[Outcome]) -> Vec<Self> {
        let first = rows.first().map(|row| row.seed);
        rows.iter().filter(|row| Some(row.seed) == first).map(|row| Self::of(row, rows)).collect()
    }

    /// Of the rows of all seeds that are as this one.
    fn of(row: &Outcome, rows: &[Outcome]) -> Self {
        let Outcome { system, count, kind, samples, noise, .. } = *row;
        let what = |row: &Outcome| (row.case, row.system, row.count, row.kind, row.samples, row.noise);
        let (mut sorted, failed): (Vec<&Outcome>, Vec<&Outcome>) =
            rows.iter().filter(|other| what(other) == what(row)).partition(|row| row.test_mse.is_finite());
        sorted.sort_by(|a, b| a.test_mse.total_cmp(&b.test_mse));
        let at = |k: usize| sorted.get(k).map_or([f64::NAN; 2], |row| [row.test_mse, row.relative_test_mse]);
        let [[least, _], [median, relative_median]] = [0, sorted.len() / 2].map(at);
        let [largest, _] = at(sorted.len().saturating_sub(1));
        let failed = failed.len();
        Self { system, count, kind, samples, noise, least, median, largest, relative_median, failed }
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let names =
            ["param.", "test", "rel.", "A_q", "A_E", "valid s", "f32 A_q", "f32 A_E", "f32 v. s", "s"];
        write!(f, "{:<12} {:<10} {:>7} {:>5}", "system", "model", "samples", "noise")?;
        names.iter().try_for_each(|name| write!(f, " {name:>8}"))?;
        writeln!(f)?;
        self.rows.iter().try_for_each(|row| {
            ours(f, row)?;
            theirs(f, row)?;
            row.stepped.as_ref().map_or(Ok(()), |stepped| energies(f, stepped))
        })?;
        if let Some(scatter) = &self.scatter {
            scattered(f, scatter)?;
        }
        writeln!(
            f,
            "\ntest: mean squared error of accelerations; rel.: relative to the mean squared acceleration. A_q, A_E: errors of\n\
             predicted positions and energies in the paper's measure; valid s: median time until the (wrapped) position is 0.1\n\
             off. f32: exact physics in single precision. s: of training. noise: on positions and velocities of the samples, the\n\
             test set has none. mlp: a plain network from the state to the accelerations."
        )
    }
}

/// Of how many of what, by which model, from which data.
fn what(
    f: &mut fmt::Formatter,
    [system, kind]: [&str; 2],
    [count, samples]: [usize; 2],
    noise: f64,
) -> fmt::Result {
    let system = format!("{count}-{}", system.trim_start_matches("n-"));
    write!(f, "{system:<12} {kind:<10} {samples:>7} {noise:>5}")
}

fn scattered(f: &mut fmt::Formatter, scatter: &[Scatter]) -> fmt::Result {
    writeln!(
        f,
        "\ntest over the seeds: least, median, largest, median relative to the mean squared acceleration; failed"
    )?;
    scatter.iter().try_for_each(|row| {
        what(f, [row.system, row.kind], [row.count, row.samples], row.noise)?;
        write!(f, " {:>8.1e} {:>8.1e} {:>8.1e}", row.least, row.median, row.largest)?;
        writeln!(f, " {:>8.1e} {:>8}", row.relative_median, row.failed)
    })
}

fn ours(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    what(f, [row.system, row.kind], [row.count, row.samples], row.noise)?;
    write!(f, " {:>8}", row.parameters)?;
    write!(f, " {:>8.1e} {:>8.1e}", row.test_mse, row.relative_test_mse)?;
    match row.predicted {
        None => write!(f, "{}", format!(" {:>8}", "-").repeat(6))?,
        Some(p) => {
            write!(f, " {:>8.1e} {:>8.1e} {:>8.2}", p.position, p.energy, p.valid_seconds)?;
            write!(f, " {:>8.1e} {:>8.1e} {:>8.2}", p.floor_position, p.floor_energy, p.floor_valid_seconds)?;
        }
    }
    writeln!(f, " {:>8.1}", row.train_seconds)
}

fn energies(f: &mut fmt::Formatter, stepped: &Stepped) -> fmt::Result {
    writeln!(f, "{:<12} {} steps of {} s in f32:", "", stepped.steps, stepped.step_seconds)?;
    let methods = [
        ("DEL, order 2", stepped.energy_del_2),
        ("DEL, order 4", stepped.energy_del_4),
        ("Runge-Kutta", stepped.energy_rk4),
    ];
    methods.iter().try_for_each(|(name, energy)| {
        let (largest, drift) = (energy.largest, energy.drift);
        writeln!(f, "{:<12} {name:<14} energy error at most {largest:.1e} J, drift {drift:+.1e} J", "")
    })
}

fn theirs(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    let paper = row.published;
    let Some(parameters) = paper.parameters else { return Ok(()) };
    let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1e}"));
    let test = paper.test_mse.map_or("fails".to_owned(), |x| format!("{x:.1e}"));
    write!(f, "{:<12} {:<10} {:>7} {:>5} {parameters:>8} {test:>8} {:>8}", "", "  paper's", "", "", "-")?;
    writeln!(f, " {:>8} {:>8}", number(paper.position), number(paper.energy))
}
