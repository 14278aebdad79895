//! Experiments as tasks, with their rows as records.

use super::super::record::{Measure, Record, note};
use super::super::table::number;
use super::super::task::{Task, TaskError, Tell, json, with_seeds};
use super::super::training::Limits;
use super::super::{LGNN, compared, numbered};
use super::growth::Growth;
use super::{Baseline, Case, Options, Outcome, figures, run};
use std::path::Path;

/// Creates the tasks of these cases, each with `seeds` seeds, starting with that of the options. If limits are given,
/// the models that the paper compares with are included. `arguments` are the command-line options other than case and
/// seed.
pub fn tasks(
    cases: &[Case],
    (options, limits): (&Options, Option<Limits>),
    seeds: usize,
    arguments: &str,
) -> Vec<Task> {
    let rows = cases.iter().flat_map(|case| {
        let baselines = if limits.is_some() { Baseline::of(*case) } else { &[] };
        compared::rows(*case, (baselines, limits.unwrap_or_default()))
    });
    with_seeds(rows, (options.seed, seeds), |row, seed| task(*row, Options { seed, ..*options }, arguments))
}

fn task((case, baseline): compared::Row<Case, Baseline>, options: Options, arguments: &str) -> Task {
    let (seed, model) = (options.seed, baseline.map(|(baseline, _)| baseline));
    let switch = options.networks_alone.then_some("networks-alone");
    let models = (model.map(Baseline::name), switch);
    let (name, command) = compared::name_and_command((LGNN.name, &case), models, (seed, arguments));
    let training = json(&(case, model, options));
    Task {
        command,
        data: format!(
            "exact motion of our own generator, seed {seed}; the authors' figures are on that of their own integrator"
        ),
        settings: json(&(case, baseline, options)),
        options: arguments.to_owned(),
        expected_seconds: baseline
            .map_or_else(|| expected_seconds(case, &options), |(_, limits)| limits.expected_seconds()),
        is_timed: case == Case::Scale && baseline.is_none(),
        name: name.clone(),
        run: Box::new(move |folder: Option<&Path>, tell: &Tell| {
            let state = (folder, &*name, &*training);
            let rows = compared::run(baseline, state, |baseline| run((case, baseline), &options, tell))?;
            let with_pictures = |row: &Outcome| {
                let pictures = folder.map_or(Ok(Vec::new()), |folder| figures::draw(folder, &name, row))?;
                Ok(Record { pictures, ..record(row, &options)? })
            };
            let mut records = rows.iter().map(with_pictures).collect::<Result<Vec<_>, TaskError>>()?;
            if let (Some(growth), Some(row)) = (Growth::of(&rows), records.first()) {
                records.push(summary(&growth, row)?);
            }
            Ok(records)
        }),
    }
}

fn expected_seconds(case: Case, options: &Options) -> f64 {
    let seconds = match case {
        Case::Pendulum | Case::Spring => 5.0,
        Case::Scale | Case::DataEfficiency => 30.0,
        Case::Hybrid | Case::HybridForce => 8.0,
        Case::Drag => 40.0,
    };
    if options.networks_alone { 8.0 * seconds } else { seconds }
}

fn table(case: Case) -> &'static str {
    match case {
        Case::Pendulum | Case::Spring => "Pendulums on rods and rings of springs (Figures 3 and 4)",
        Case::Scale => "More springs than were trained on (Figure 5)",
        Case::Hybrid | Case::HybridForce => "Pendulums and springs joined, from two models (Figure 4)",
        Case::Drag => "With drag",
        Case::DataEfficiency => "From few samples and many",
    }
}

fn record(row: &Outcome, options: &Options) -> Result<Record, serde_json::Error> {
    let with_drag = if row.drag > 0.0 { "yes" } else { "no" };
    let alone = if options.networks_alone { ", networks alone" } else { "" };
    let subject = [
        ("system", numbered(row.system, row.count)),
        ("model is", row.kind.to_owned()),
        ("drag", with_drag.to_owned()),
        ("pull, N", row.pull.to_string()),
        ("samples", row.samples.to_string()),
    ];
    Ok(Record {
        model: format!("{}{alone}", row.model),
        is_ours: row.model == "ours",
        parameters: row.parameters,
        paper_parameters: row.published.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures(row),
        note: remarks(row),
        ..Record::of(table(row.case), subject, row)?
    })
}

fn measures(row: &Outcome) -> Vec<Measure> {
    let mut measures = vec![
        Measure::error("train MSE", row.train_mse, None),
        Measure::error("held-back MSE", row.validation_mse, None),
    ];
    measures.extend(row.rolled_out.iter().flat_map(|rolled| rolled.measures(row.published.measures)));
    measures
}

/// Note with the results that do not have their own column.
fn remarks(row: &Outcome) -> Option<String> {
    let failed = row.rolled_out.and_then(|rolled| rolled.failures());
    let drag = row
        .drag_error
        .map(|error| format!("learned drag within {}% of the exact one", number(Some(100.0 * error))));
    let step = row.step_microseconds.map(|time| format!("one step takes {time:.2} µs"));
    note([row.ending.words(), failed, drag, step])
}

/// Summary in the form of a row of the case, with the growth in place of the usual measures.
fn summary(growth: &Growth, row: &Record) -> Result<Record, serde_json::Error> {
    let measures = vec![
        Measure::error("time ∝ springs to the power of", growth.time_exponent, None),
        Measure::error("energy violation to the power of", growth.energy_violation_slope, None),
        Measure::error("µs a step of 500", growth.microseconds_per_step_500, None),
    ];
    Ok(Record {
        model: row.model.clone(),
        is_ours: row.is_ours,
        parameters: row.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures,
        is_summary: true,
        ..Record::of("Growth with the number of springs", [("springs", "5 to 5,000".to_owned())], growth)?
    })
}
