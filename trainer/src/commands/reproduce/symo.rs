//! `leastaction reproduce symo`.

use crate::commands::Done;
use crate::commands::arguments::{order, seed};
use crate::commands::output::{Failure, Output, folder, object};
use clap::Args;
use leastaction::atomic;
use leastaction::data::symo::{self, SymoSet};
use leastaction::ground_truth::{Mechanism, symo_set};
use leastaction::plot::{Series, Stroke, log_log};
use leastaction::reproduce::symo::{Case, Model, Outcome, Published, csv, published};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// SyMo (Santos et al., L4DC 2022): pendulum, cart-pole and acrobot from positions and controls.
///
/// Learns every case that the options leave open (all: three systems, two models, orders 2 and 4, 8 to 128 trajectories)
/// and prints its errors beside the published program's on equal terms. With -o also as CSV and pictures.
///
/// Example: leastaction reproduce symo --system cartpole --model e2e-symo --order 4 --trajectories 32 --json
#[derive(Args)]
pub struct Symo {
    /// Only this mechanism.
    #[arg(long)]
    system: Option<Mechanism>,
    /// Only this loss.
    #[arg(long)]
    model: Option<Model>,
    /// Only this order, 2 or 4.
    #[arg(long, value_parser = order)]
    order: Option<u8>,
    /// Only this many training trajectories.
    #[arg(long, value_name = "N")]
    trajectories: Option<usize>,
    /// Of the initial weights and, without --data, of the data.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// A data set in the layout of the SyMo authors (train_x, test_x, int_x, …) instead of a generated one; needs --system.
    #[arg(long, value_name = "FILE", requires = "system")]
    data: Option<PathBuf>,
    /// Writes table.csv and pictures there.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// A row of the table.
struct Row {
    ours: Outcome,
    theirs: Option<Published>,
}

/// All rows.
#[derive(Serialize)]
struct Table {
    #[serde(serialize_with = "outcomes")]
    rows: Vec<Row>,
}

fn outcomes<S: serde::Serializer>(rows: &[Row], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(rows.iter().map(|row| &row.ours))
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{:<9} {:<9} {:>5} {:>3} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>6}",
            "system",
            "model",
            "order",
            "N",
            "param.",
            "test",
            "integr.",
            "median",
            "100",
            "energy",
            "inertia",
            "s"
        )?;
        self.rows.iter().try_for_each(|row| {
            ours(f, &row.ours)?;
            row.theirs.as_ref().map_or(Ok(()), |published| theirs(f, &row.ours, published))
        })?;
        writeln!(
            f,
            "\nN: training trajectories. Mean squared errors: test, one step ahead; integr., over the free motions, their\n\
             median over trajectories and their first 100 steps; energy along them (J²); inertia matrix. s: of training."
        )
    }
}

fn ours(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    let model = name(row.model);
    write!(f, "{:<9} {model:<9} {:>5} {:>3} {:>6}", row.system, row.order, row.trajectories, row.parameters)?;
    for value in row.measures() {
        write!(f, " {value:>9.2e}")?;
    }
    writeln!(f, " {:>6.1}", row.train_seconds)
}

/// As on the command line.
fn name(model: Model) -> &'static str {
    match model {
        Model::Symo => "symo",
        Model::E2eSymo => "e2e-symo",
    }
}

fn theirs(f: &mut fmt::Formatter, row: &Outcome, published: &Published) -> fmt::Result {
    write!(f, "{:<9} {:<9} {:>5} {:>3} {:>6}", "", "  paper's", 2, row.trajectories, published.parameters)?;
    for value in published.measures {
        match value {
            Some(value) => write!(f, " {value:>9.2e}")?,
            None => write!(f, " {:>9}", "-")?,
        }
    }
    writeln!(f)
}

impl Symo {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        self.output.as_deref().map_or(Ok(()), folder)?;
        let mut rows = Vec::new();
        for mechanism in self.systems() {
            let set = self.data_set(mechanism)?;
            for case in self.cases(mechanism, &set)? {
                rows.push(learn(&case, &set, output)?);
            }
        }
        self.write(&rows)?;
        match &rows[..] {
            // One case as one flat object.
            [row] if output.json => object(&row.ours),
            _ => output.report(&Table { rows }),
        }
    }

    fn systems(&self) -> Vec<Mechanism> {
        let all = [Mechanism::Pendulum, Mechanism::Cartpole, Mechanism::Acrobot];
        all.into_iter().filter(|system| self.system.is_none_or(|only| only == *system)).collect()
    }

    fn data_set(&self, mechanism: Mechanism) -> Result<SymoSet, Failure> {
        match &self.data {
            Some(file) => symo::read(file, mechanism.step(), mechanism.actuated())
                .map_err(|error| Failure::Input(error.to_string())),
            None => symo_set(mechanism, self.seed).map_err(|error| Failure::Work(error.to_string())),
        }
    }

    fn cases(&self, mechanism: Mechanism, set: &SymoSet) -> Result<Vec<Case>, Failure> {
        let available = set.train.trajectories.len();
        if let Some(wanted) = self.trajectories.filter(|wanted| *wanted == 0 || *wanted > available) {
            return Err(Failure::Input(format!(
                "--trajectories {wanted}: it must be from 1 to the {available} of the training set"
            )));
        }
        let sizes = self.trajectories.map_or_else(|| vec![8, 16, 32, 64, 128], |only| vec![only]);
        let orders = self.order.map_or_else(|| vec![2, 4], |only| vec![only]);
        let models = self.model.map_or_else(|| vec![Model::Symo, Model::E2eSymo], |only| vec![only]);
        let mut cases = Vec::new();
        for trajectories in sizes.into_iter().filter(|size| *size <= available) {
            for model in &models {
                for order in &orders {
                    let (model, order, seed) = (*model, *order, self.seed);
                    cases.push(Case { mechanism, model, order, trajectories, seed });
                }
            }
        }
        Ok(cases)
    }

    fn write(&self, rows: &[Row]) -> Done {
        let Some(folder) = &self.output else { return Ok(()) };
        let table = folder.join("table.csv");
        let outcomes: Vec<&Outcome> = rows.iter().map(|row| &row.ours).collect();
        atomic::write(&table, csv(&outcomes).as_bytes()).map_err(|error| Failure::file(&table, error))?;
        for mechanism in self.systems() {
            let file = folder.join(format!("{}.svg", mechanism.name()));
            draw(&file, mechanism, rows).map_err(|error| Failure::file(&file, error))?;
        }
        Ok(())
    }
}

fn learn(case: &Case, set: &SymoSet, output: Output) -> Result<Row, Failure> {
    let mut last = (0, f64::NAN);
    let outcome = case.run(set, |iteration, loss| last = (iteration, loss));
    let ours = outcome.map_err(|error| Failure::Work(error.to_string()))?;
    output.note(&format!(
        "{} {} order {}, {} trajectories: {} iterations, loss {:.2e}, {:.1} s",
        ours.system,
        name(ours.model),
        ours.order,
        ours.trajectories,
        last.0,
        last.1,
        ours.train_seconds
    ));
    let theirs = published(case);
    Ok(Row { ours, theirs })
}

/// Test error against the number of trajectories, ours and the paper's.
fn draw(
    file: &std::path::Path,
    mechanism: Mechanism,
    rows: &[Row],
) -> Result<(), leastaction::plot::PlotError> {
    let of = |model: Model, order: u8| {
        let rows = rows.iter().map(|row| &row.ours).filter(move |row| row.system == mechanism.name());
        rows.filter(move |row| row.model == model && row.order == order)
            .map(|row| (row.trajectories as f64, row.test_mse))
    };
    let mut series = Vec::new();
    for (model, name) in [(Model::Symo, "SyMo"), (Model::E2eSymo, "E2E-SyMo")] {
        series.push(Series::new(format!("{name}, order 2"), of(model, 2)));
        series.push(Series::new(format!("{name}, order 4"), of(model, 4)));
        let paper = rows.iter().filter(|row| row.ours.system == mechanism.name() && row.ours.model == model);
        let paper =
            paper.filter_map(|row| Some((row.ours.trajectories as f64, row.theirs.as_ref()?.measures[0]?)));
        series.push(Series::new(format!("{name}, published"), paper));
    }
    series.retain(|series| !series.points.is_empty());
    let series: Vec<_> = series.into_iter().map(|series| series.with_stroke(Stroke::Dotted)).collect();
    let title = format!("{}: error one step ahead", mechanism.name());
    log_log(file, &title, ("training trajectories", "mean squared error"), &series, &[])
}
