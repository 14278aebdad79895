//! `leastaction-papers control`.

use super::selection::cases;
use clap::{Args, ValueEnum};
use leastaction::cli::{Done, Failure, Output};
use leastaction_models::parallel;
use leastaction_papers::control::{
    ControlError, Controller, Known, Model, Report, Robot, Table, from_real, rows,
};
use std::ops::Range;
use std::path::PathBuf;
use std::slice;

/// RealAIGym (DFKI, ICRA 2025): a double pendulum with one drive comes upright, from anywhere, fast, or with faults.
///
/// Runs our controllers in the competition's simulator by its rules, and prints their scores beside the published ones (one run each). The
/// policy is judged by the part of 60 s in which the tip is up, with fifteen disturbances that differ between seeds; a single swing-up by
/// time, energy, torque, smoothness and velocity; robustness by the shares of 722 faulty machines on which the swing-up succeeds, its score
/// their mean.
///
/// Example: leastaction-papers control --robot acrobot --seeds 0..20 --json
#[derive(Args)]
pub struct Control {
    /// The table.
    #[arg(long, default_value = "policy")]
    table: Tables,
    /// Only this robot.
    #[arg(long)]
    robot: Option<Robot>,
    /// Only this controller of ours; by default those that are made for the table.
    #[arg(long)]
    controller: Option<Controller>,
    /// Only with this model.
    #[arg(long)]
    model: Option<Known>,
    /// Also with a model that is learned from all .csv logs of the real robot in DIR (time, pos_meas1 …, tau_meas1 …), without its friction, which
    /// the simulated robot has not.
    #[arg(long, value_name = "DIR")]
    real_logs: Option<PathBuf>,
    /// Seeds of the disturbances, the end excluded; robustness takes the first for its random numbers, a single swing-up needs none.
    #[arg(long, value_name = "FROM..TO", default_value = "0..20", value_parser = seeds)]
    seeds: Range<u64>,
    /// Number of threads, at most four per processor; by default one per processor. The results are the same on any number.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Tables {
    /// One policy for every state.
    Policy,
    /// One swing-up from hanging.
    Single,
    /// Swing-ups of machines with faults.
    Robustness,
    /// All three.
    All,
}

impl Tables {
    fn tables(self) -> &'static [Table] {
        match self {
            Self::Policy => &[Table::Policy],
            Self::Single => &[Table::Single],
            Self::Robustness => &[Table::Robustness],
            Self::All => &[Table::Policy, Table::Single, Table::Robustness],
        }
    }
}

/// Most seeds of a call.
const MOST_SEEDS: u64 = 1_000_000;

/// A range of seeds.
fn seeds(text: &str) -> Result<Range<u64>, String> {
    let ends = text.split_once("..").and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    ends.filter(|seeds: &Range<u64>| !seeds.is_empty() && seeds.end - seeds.start <= MOST_SEEDS).ok_or_else(
        || {
            format!(
                "it must be FROM..TO, such as 0..20, with 1 to {MOST_SEEDS} whole numbers; TO is excluded"
            )
        },
    )
}

impl Control {
    /// Runs, judges and prints.
    pub fn run(self, output: Output) -> Done {
        let threads = parallel::threads(self.threads.map_or(0, usize::from))
            .map_err(|error| Failure::Work(format!("the threads cannot be created: {error}")))?;
        let report = threads.install(|| self.report(output))?;
        output.report(&report)
    }

    fn report(&self, output: Output) -> Result<Report, Failure> {
        let mut report = Report { rows: Vec::new() };
        let note = |line: &str| output.note(line);
        let refused =
            |robot: Robot| move |error: ControlError| Failure::Work(format!("{}: {error}", robot.name()));
        let real = self.real_logs.as_ref().map(|folder| from_real(folder, &note)).transpose();
        let real = real.map_err(|error| Failure::Work(error.to_string()))?;
        let known = |robot: Robot| {
            let known = cases(self.model).into_iter().map(|known| known.model(robot, &note));
            let real = real.iter().map(|pendulum| Model::of("real logs", *pendulum));
            Ok((robot, known.chain(real).collect::<Result<Vec<_>, _>>().map_err(refused(robot))?))
        };
        let robots = cases(self.robot).into_iter().map(known).collect::<Result<Vec<_>, Failure>>()?;
        for table in self.table.tables() {
            let controllers = self.controller.as_ref().map_or(Controller::of_table(*table), slice::from_ref);
            for (robot, models) in &robots {
                let found = rows(*table, *robot, (controllers, models), &self.seeds, &note);
                report.rows.extend(found.map_err(refused(*robot))?);
            }
        }
        Ok(report)
    }
}
