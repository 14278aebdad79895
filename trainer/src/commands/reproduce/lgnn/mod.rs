//! `leastaction reproduce lgnn`.

mod figures;
mod table;

use crate::commands::Done;
use crate::commands::arguments::seed;
use crate::commands::output::{Failure, Output, folder, object};
use clap::Args;
use leastaction::atomic;
use leastaction::reproduce::lgnn::{Case, Options, run};
use std::path::PathBuf;
use table::{Table, csv};

/// LGNN (Bhattoo et al., MLST 2023): pendulums on rods and rings of springs from accelerations, run on other numbers of them.
///
/// Runs every case that the options leave open and prints its errors beside those of the authors' program: geometric means of the
/// rollout error and of the energy violation. Data and truth are exact motion.
///
/// Example: leastaction reproduce lgnn --case pendulum --json
#[derive(Args)]
pub struct Lgnn {
    /// Only this experiment.
    #[arg(long)]
    case: Option<Case>,
    /// Iterations of Levenberg-Marquardt at most.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Starts of the rollouts; of large systems fewer are taken.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    starts: u32,
    /// No simple law (uniform field, polynomial of the squared distance, viscous drag) beside the networks.
    #[arg(long)]
    networks_alone: bool,
    /// Of the initial weights and of the data.
    #[arg(long, default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Repeats every case with so many seeds from --seed on.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    seeds: u32,
    /// Writes table.csv there, and pictures of every rollout's errors over time.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

impl Lgnn {
    /// Learns, rolls out and prints.
    pub fn run(self, output: Output) -> Done {
        self.output.as_deref().map_or(Ok(()), folder)?;
        let mut rows = Vec::new();
        for case in Case::ALL.into_iter().filter(|case| self.case.is_none_or(|only| only == *case)) {
            for seed in (self.seed..).take(self.seeds as usize) {
                let options = Options {
                    iterations: self.iterations as usize,
                    starts: self.starts as usize,
                    networks_alone: self.networks_alone,
                    seed,
                };
                let outcomes = run(case, &options, &mut |line| output.note(line));
                rows.extend(outcomes.map_err(|error| Failure::Work(error.to_string()))?);
            }
        }
        if let Some(folder) = &self.output {
            let table = folder.join("table.csv");
            atomic::write(&table, csv(&rows).as_bytes()).map_err(|error| Failure::file(&table, error))?;
            figures::draw(folder, &rows)?;
        }
        match &rows[..] {
            // One row as one flat object.
            [row] if output.json => object(row),
            _ => output.report(&Table::new(rows)),
        }
    }
}
