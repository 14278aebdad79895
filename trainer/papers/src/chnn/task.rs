//! Chains as tasks, and their results as records.

use super::super::record::{Measure, Record};
use super::super::task::{Task, TaskError, with_seeds};
use super::{Options, Outcome, run};
use std::path::Path;

/// A chain with one seed.
struct Experiment {
    count: usize,
    options: Options,
    /// Command-line options other than chain and seed.
    arguments: String,
}

/// Creates the tasks of chains with these numbers of pendulums, each with `seeds` seeds from that of the options on; `arguments` are the
/// remaining options of the command line.
pub fn tasks(counts: &[usize], options: &Options, seeds: usize, arguments: &str) -> Vec<Box<dyn Task>> {
    let one = |count: &usize, seed: u64| Experiment {
        count: *count,
        options: Options { seed, ..*options },
        arguments: arguments.to_owned(),
    };
    with_seeds(counts.iter().copied(), (options.seed, seeds), one)
}

impl Task for Experiment {
    fn name(&self) -> String {
        format!("{}-pendulum-{}", self.count, self.options.seed)
    }

    fn command(&self) -> String {
        let (count, seed) = (self.count, self.options.seed);
        format!("leastaction-papers chnn --pendulums {count} --seed {seed}{}", self.arguments)
    }

    fn data(&self) -> String {
        format!("exact motion of our own generator by the authors' protocol, seed {}", self.options.seed)
    }

    fn settings(&self) -> String {
        serde_json::to_string(&(self.count, self.options)).unwrap_or_default()
    }

    fn options(&self) -> String {
        self.arguments.clone()
    }

    fn expected_seconds(&self) -> f64 {
        3.0 * self.count as f64
    }

    fn run(&self, _: Option<&Path>, tell: &(dyn Fn(&str) + Sync)) -> Result<Vec<Record>, TaskError> {
        Ok(vec![record(&run(self.count, &self.options, tell)?)?])
    }
}

/// Published geometric means of the relative rollout error from 800 trajectories, of CLNN and DeLaN, by the number of pendulums.
fn published(count: usize, trajectories: usize) -> Option<[f64; 2]> {
    match (count, trajectories) {
        (2, 800) => Some([1.14e-4, 1.25e-3]),
        (3, 800) => Some([3.3e-4, 4.1e-2]),
        (5, 800) => Some([9.3e-4, 0.33]),
        _ => None,
    }
}

fn record(row: &Outcome) -> Result<Record, serde_json::Error> {
    let published = published(row.count, row.trajectories);
    let clnn = published.map(|[clnn, _]| clnn);
    let delan = published.map(|[_, delan]| format!("DeLaN in angles, published: rollout error {delan:.2e}"));
    let failed = Some(row.failed).filter(|failed| *failed > 0);
    let failed = failed.map(|failed| format!("{failed} rollouts could not be followed to the end"));
    let notes: Vec<String> = delan.into_iter().chain(failed).collect();
    Ok(Record {
        table: "Chains of pendulums".to_owned(),
        subject: vec![
            ("pendulums".to_owned(), row.count.to_string()),
            ("trajectories".to_owned(), row.trajectories.to_string()),
        ],
        model: "ours".to_owned(),
        is_ours: true,
        parameters: row.parameters,
        paper_parameters: None,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: vec![
            Measure::error("held-back MSE", row.validation_mse, None),
            Measure::error("masses", row.mass_error, None),
            Measure::error("rollout error", row.rollout_error, clnn).over(row.floor_rollout_error),
            Measure::error("… at the end", row.last_rollout_error, None),
            Measure::error("energy violation", row.energy_violation, None).over(row.floor_energy_violation),
        ],
        note: Some(notes.join("; ")).filter(|note| !note.is_empty()),
        pictures: Vec::new(),
        details: serde_json::to_value(row)?,
        is_summary: false,
    })
}
