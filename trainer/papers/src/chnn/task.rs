//! Chains as tasks, and their results as records.

use super::super::CHNN;
use super::super::published::{Published, Row};
use super::super::record::{Measure, Record, note};
use super::super::task::{Task, json, with_seeds};
use super::{Options, Outcome, run};

/// Creates the tasks of chains with these numbers of pendulums, each with `seeds` seeds, starting with that of the
/// options; `arguments` are the remaining options of the command line.
pub fn tasks(counts: &[usize], options: &Options, seeds: usize, arguments: &str) -> Vec<Task> {
    with_seeds(counts.iter().copied(), (options.seed, seeds), |count, seed| {
        task(*count, Options { seed, ..*options }, arguments)
    })
}

fn task(count: usize, options: Options, arguments: &str) -> Task {
    let (paper, seed) = (CHNN.name, options.seed);
    Task {
        name: format!("{count}-pendulum-{seed}"),
        command: format!("leastaction-papers {paper} --pendulums {count} --seed {seed}{arguments}"),
        data: format!("exact motion of our own generator by the authors' protocol, seed {seed}"),
        settings: json(&(count, options)),
        options: arguments.to_owned(),
        expected_seconds: 3.0 * count as f64,
        is_timed: false,
        run: Box::new(move |_, tell| Ok(vec![record(&run(count, &options, tell)?)?])),
    }
}

/// Published geometric means of the relative rollout error of CLNN and DeLaN, by the numbers of pendulums and of trajectories.
const TABLE: [Row<(usize, usize), 2>; 3] = [
    ((2, 800), None, [1.14e-4, 1.25e-3]),
    ((3, 800), None, [3.3e-4, 4.1e-2]),
    ((5, 800), None, [9.3e-4, 0.33]),
];

fn record(row: &Outcome) -> Result<Record, serde_json::Error> {
    let [clnn, delan] = Published::find(&TABLE, &(row.count, row.trajectories)).measures;
    let delan = delan.map(|delan| format!("DeLaN in angles, published: rollout error {delan:.2e}"));
    let [error, last, energy] = row.rolled_out.measures([clnn, None]);
    let subject = [("pendulums", row.count.to_string()), ("trajectories", row.trajectories.to_string())];
    Ok(Record {
        model: "ours".to_owned(),
        is_ours: true,
        parameters: row.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: vec![
            Measure::error("held-back MSE", row.validation_mse, None),
            Measure::error("masses", row.mass_error, None),
            error,
            last,
            energy,
        ],
        note: note([delan, row.rolled_out.failures()]),
        ..Record::of("Chains of pendulums", subject, row)?
    })
}
