//! The table, as text, JSON and comma-separated values.

use leastaction::reproduce::modlanet::{Outcome, Stepped};
use serde::Serialize;
use std::fmt;

/// The rows as comma-separated values with a header; empty where there is no prediction.
pub fn csv(rows: &[Outcome]) -> String {
    let mut text = String::from(
        "system,count,kind,samples,parameters,train_mse,test_mse,relative_test_mse,position,energy,valid_seconds,\
         floor_position,floor_energy,floor_valid_seconds,train_seconds,seed,noise,epochs,stopped,unpredicted\n",
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
            "{system},{count},{kind},{samples},{parameters},{train_mse:e},{test_mse:e},{:e},{predicted},{:.1},{},{},",
            row.relative_test_mse, row.train_seconds, row.seed, row.noise
        );
        let epochs = row.epochs.map_or(String::new(), |epochs| epochs.to_string());
        let stopped = row.ending.words().unwrap_or_default();
        text += &format!("{epochs},{stopped},{}\n", row.unpredicted.unwrap_or_default());
    }
    text
}

/// All rows.
#[derive(Serialize)]
pub struct Table {
    /// In the order of the cases.
    pub rows: Vec<Outcome>,
    /// Of the test errors, over the seeds.
    pub scatter: Option<Vec<Scatter>>,
}

/// How far the test errors of several seeds lie apart, for one row of the table.
#[derive(Serialize)]
pub struct Scatter {
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
    pub fn of_all(rows: &[Outcome]) -> Vec<Self> {
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
            remarks(f, row)?;
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
             test set has none. mlp: a plain network from the state to the accelerations; hnn: momenta from the true mass matrix. The\n\
             losses of HNN and MLP that the ModLaNet authors' program prints are of the rate of the momenta alone."
        )
    }
}

/// A system with its number of elements: 2-pendulum.
pub fn numbered(system: &str, count: usize) -> String {
    format!("{count}-{}", system.trim_start_matches("n-"))
}

/// Of how many of what, by which model, from which data.
fn what(
    f: &mut fmt::Formatter,
    [system, kind]: [&str; 2],
    [count, samples]: [usize; 2],
    noise: f64,
) -> fmt::Result {
    write!(f, "{:<12} {kind:<10} {samples:>7} {noise:>5}", numbered(system, count))
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

/// How training ended, and why there is no prediction.
fn remarks(f: &mut fmt::Formatter, row: &Outcome) -> fmt::Result {
    let stopped = row.ending.words();
    let unpredicted = row.unpredicted.map(|why| format!("no prediction: {why}"));
    let remarks: Vec<String> = stopped.into_iter().chain(unpredicted).collect();
    if remarks.is_empty() { Ok(()) } else { writeln!(f, "{:<12}   {}", "", remarks.join("; ")) }
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
