//! Experiments as tasks, with their rows as records.

use super::super::record::{Measure, Record, note};
use super::super::task::{Task, Tell, json, with_seeds};
use super::super::training::Limits;
use super::super::{MODLANET, compared, numbered};
use super::{Baseline, Case, Options, Outcome, Predicted, Stepped, figures, run};
use leastaction_learning::data::modlanet::ModlanetSet;
use std::path::Path;
use std::sync::Arc;

/// A data set from a file.
#[derive(Clone, Debug)]
pub struct ModlanetData {
    /// File of the data.
    pub file: String,
    /// Content of the file.
    pub set: Arc<ModlanetSet>,
}

/// Creates the tasks of these cases, each with `seeds` seeds, starting with that of the options, and those of the
/// baselines within the limits, in cases that have baselines. If no data is given, it is generated. `arguments` are the
/// command-line options other than case and seed.
pub fn tasks(
    cases: &[Case],
    options: &Options,
    (baselines, limits): (&[Baseline], Limits),
    seeds: usize,
    data: Option<&ModlanetData>,
    arguments: &str,
) -> Vec<Task> {
    let rows = cases.iter().flat_map(|case| {
        let baselines = if case.has_baselines() { baselines } else { &[] };
        compared::rows(*case, (baselines, limits))
    });
    with_seeds(rows, (options.seed, seeds), |row, seed| {
        task(*row, (Options { seed, ..options.clone() }, data.cloned()), arguments)
    })
}

fn task(
    (case, baseline): compared::Row<Case, Baseline>,
    (options, data): (Options, Option<ModlanetData>),
    arguments: &str,
) -> Task {
    let model = baseline.map(|(baseline, _)| baseline);
    let (models, seed) = ((model.map(Baseline::name), None), options.seed);
    let (name, command) = compared::name_and_command((MODLANET.name, &case), models, (seed, arguments));
    let generated = || format!("exact motion of our own generator, seed {}", options.seed);
    let source = data.as_ref().map_or_else(generated, |data| data.file.clone());
    let training = json(&(case, model, &options, &source));
    Task {
        command,
        settings: json(&(case, baseline, &options, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: baseline
            .map_or_else(|| expected_seconds(case), |(_, limits)| limits.expected_seconds()),
        is_timed: false,
        name: name.clone(),
        run: Box::new(move |folder: Option<&Path>, tell: &Tell| {
            let set = data.as_ref().map(|data| &*data.set);
            let state = (folder, &*name, &*training);
            let rows = compared::run(baseline, state, |baseline| run((case, baseline), &options, set, tell))?;
            let with_pictures = |row: Outcome| {
                let pictures = folder.map_or(Ok(Vec::new()), |folder| figures::draw(folder, &row))?;
                Ok(Record { pictures, ..record(&row)? })
            };
            rows.into_iter().map(with_pictures).collect()
        }),
    }
}

fn expected_seconds(case: Case) -> f64 {
    match case {
        Case::DoublePendulum | Case::ExtendPendulum => 40.0,
        Case::ThreeBody => 10.0,
        Case::ExtendBody => 20.0,
        Case::DatasetSize => 90.0,
        Case::DirectLarge | Case::Noise => 30.0,
    }
}

/// Title of a case's table, and whether it has predictions.
fn table(case: Case) -> (&'static str, bool) {
    match case {
        Case::DoublePendulum | Case::ThreeBody => {
            ("Accelerations, and predictions of 30 s (Table 2, Figure 5)", true)
        }
        Case::ExtendPendulum | Case::ExtendBody => {
            ("More elements than were trained on, 10 s (Figures 6 and 7)", true)
        }
        Case::DatasetSize => ("Two pendulums by the number of samples (Table 4)", false),
        Case::DirectLarge => ("Large systems learned directly (Figure 8)", false),
        Case::Noise => ("Few and noisy samples of two pendulums", false),
    }
}

fn record(row: &Outcome) -> Result<Record, serde_json::Error> {
    let (table, has_predictions) = table(row.case);
    let (model, is_ours) = model(row.kind);
    let subject = [
        ("system", numbered(row.system, row.count)),
        ("samples", row.samples.to_string()),
        ("noise", row.noise.to_string()),
    ];
    Ok(Record {
        model,
        is_ours,
        parameters: row.parameters,
        paper_parameters: row.published.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures(row, has_predictions),
        note: remarks(row),
        ..Record::of(table, subject, row)?
    })
}

/// Name of the model in the table, and whether it is ours.
fn model(kind: &str) -> (String, bool) {
    if let Some(baseline) = Baseline::ALL.into_iter().find(|baseline| baseline.name() == kind) {
        return (baseline.title().to_owned(), false);
    }
    match kind {
        "trained" => ("ours".to_owned(), true),
        other => (format!("ours, {other}"), true),
    }
}

fn measures(row: &Outcome, has_predictions: bool) -> Vec<Measure> {
    let [test_mse, position, energy] = row.published.measures;
    let mut measures = vec![
        Measure::error("train MSE", row.train_mse, None),
        Measure::error("test MSE", row.test_mse, test_mse),
        Measure::error("relative test MSE", row.relative_test_mse, None),
    ];
    if has_predictions {
        let of = |value: fn(&Predicted) -> f64| row.predicted.as_ref().map_or(f64::NAN, value);
        let paper = |value: Option<f64>| value.filter(|_| row.predicted.is_some());
        let (position, energy) = (paper(position), paper(energy));
        measures.push(Measure::error("A_q", of(|p| p.position), position).over(of(|p| p.floor_position)));
        measures.push(Measure::error("A_E", of(|p| p.energy), energy).over(of(|p| p.floor_energy)));
        let valid = Measure::error("valid, s", of(|p| p.valid_seconds), None).more_is_better();
        measures.push(valid.over(of(|p| p.floor_valid_seconds)));
    }
    measures
}

/// Note on an early end of the training, the reason for missing predictions, and the energies of the long run.
fn remarks(row: &Outcome) -> Option<String> {
    let unpredicted = row.unpredicted.map(|why| format!("no predictions: {why}"));
    note([row.ending.words(), unpredicted, row.stepped.as_ref().map(energies)])
}

fn energies(stepped: &Stepped) -> String {
    let Stepped { steps, step_seconds, energy_del_2, energy_del_4, energy_rk4 } = stepped;
    let [two, four, rk4] = [energy_del_2, energy_del_4, energy_rk4].map(|energy| {
        let (largest, drift) = (energy.largest, energy.drift);
        format!("at most {largest:.1e} J off, drift {drift:+.1e} J")
    });
    format!(
        "energy along {steps} steps of {step_seconds} s in f32: DEL of order 2 {two}; order 4 {four}; Runge-Kutta {rk4}"
    )
}
