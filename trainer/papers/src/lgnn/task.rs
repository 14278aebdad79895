//! Experiments as tasks, with their rows as records.

use super::super::interrupted::Interrupted;
use super::super::record::{Measure, Record};
use super::super::table::number;
use super::super::task::{Task, TaskError, compared, with_seeds};
use super::super::training::{Bounds, Limits};
use super::super::{numbered, option_name};
use super::growth::Growth;
use super::{Baseline, Case, Options, Outcome, figures, run, run_baseline};
use std::path::Path;

/// A case with one seed: our model, or one that the paper compares with.
struct Experiment {
    case: Case,
    baseline: Option<(Baseline, Limits)>,
    options: Options,
    /// Command-line options other than case and seed.
    arguments: String,
}

/// Creates the tasks of these cases, each with `seeds` seeds from that of the options on; given limits, also those of the models that the
/// paper compares with. `arguments` are the command-line options other than case and seed.
pub fn tasks(
    cases: &[Case],
    (options, limits): (&Options, Option<Limits>),
    seeds: usize,
    arguments: &str,
) -> Vec<Box<dyn Task>> {
    let one = |(case, baseline): &(Case, Option<(Baseline, Limits)>), seed: u64| {
        let (options, arguments) = (Options { seed, ..*options }, arguments.to_owned());
        Experiment { case: *case, baseline: *baseline, options, arguments }
    };
    let rows = cases.iter().flat_map(|case| {
        let of_case = |limits| Baseline::of(*case).iter().map(move |baseline| (*baseline, limits));
        compared(*case, limits.into_iter().flat_map(of_case))
    });
    with_seeds(rows, (options.seed, seeds), one)
}

impl Task for Experiment {
    fn name(&self) -> String {
        let model = self.baseline.map_or(String::new(), |(baseline, _)| format!("-{}", baseline.name()));
        let alone = if self.options.networks_alone { "-networks-alone" } else { "" };
        format!("{}{model}{alone}-{}", option_name(&self.case), self.options.seed)
    }

    fn command(&self) -> String {
        let (case, seed) = (option_name(&self.case), self.options.seed);
        let only = self.baseline.map_or(String::new(), |_| format!(" --baselines --only {}", self.name()));
        let alone = if self.options.networks_alone { " --networks-alone" } else { "" };
        format!("leastaction-papers lgnn --case {case}{only}{alone} --seed {seed}{}", self.arguments)
    }

    fn data(&self) -> String {
        let seed = self.options.seed;
        format!(
            "exact motion of our own generator, seed {seed}; the authors' figures are on that of their own integrator"
        )
    }

    fn settings(&self) -> String {
        serde_json::to_string(&(self.case, self.baseline, self.options)).unwrap_or_default()
    }

    fn options(&self) -> String {
        self.arguments.clone()
    }

    fn expected_seconds(&self) -> f64 {
        if let Some((_, limits)) = self.baseline {
            return limits.expected_seconds();
        }
        let longer = if self.options.networks_alone { 8.0 } else { 1.0 };
        longer
            * match self.case {
                Case::Pendulum | Case::Spring => 5.0,
                Case::Scale => 30.0,
                Case::Hybrid | Case::HybridForce => 8.0,
                Case::Drag => 40.0,
                Case::DataEfficiency => 30.0,
            }
    }

    fn is_timed(&self) -> bool {
        self.case == Case::Scale && self.baseline.is_none()
    }

    fn run(&self, folder: Option<&Path>, tell: &(dyn Fn(&str) + Sync)) -> Result<Vec<Record>, TaskError> {
        let rows = match self.baseline {
            None => run(self.case, &self.options, tell)?,
            Some((baseline, limits)) => {
                let settings = serde_json::to_string(&(self.case, baseline, self.options))?;
                let run = |interrupted: Option<&Interrupted>| {
                    run_baseline((self.case, baseline), (&self.options, Bounds { limits, interrupted }), tell)
                };
                Interrupted::resume(folder, &self.name(), settings, run)?
            }
        };
        let mut records = Vec::new();
        for row in &rows {
            let drawn = folder.map_or(Ok(Vec::new()), |folder| figures::draw(folder, &self.name(), row))?;
            let alone = if self.options.networks_alone { ", networks alone" } else { "" };
            let record = record(row)?;
            let model = format!("{}{alone}", record.model);
            records.push(Record { pictures: drawn, model, ..record });
        }
        if let (Some(growth), Some(row)) = (Growth::of(&rows), records.first()) {
            records.push(summary(&growth, row)?);
        }
        Ok(records)
    }
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

fn record(row: &Outcome) -> Result<Record, serde_json::Error> {
    let with_drag = if row.drag > 0.0 { "yes" } else { "no" };
    let subject = [
        ("system", numbered(row.system, row.count)),
        ("model is", row.kind.to_owned()),
        ("drag", with_drag.to_owned()),
        ("pull, N", row.pull.to_string()),
        ("samples", row.samples.to_string()),
    ];
    Ok(Record {
        table: table(row.case).to_owned(),
        subject: subject.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        model: row.model.to_owned(),
        is_ours: row.model == "ours",
        parameters: row.parameters,
        paper_parameters: row.published.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures(row),
        note: note(row),
        pictures: Vec::new(),
        details: serde_json::to_value(row)?,
        is_summary: false,
    })
}

fn measures(row: &Outcome) -> Vec<Measure> {
    let mut measures = vec![
        Measure::error("train MSE", row.train_mse, None),
        Measure::error("held-back MSE", row.validation_mse, None),
    ];
    if let Some(rolled) = &row.rolled_out {
        let (re, ev) = (row.published.rollout_error, row.published.energy_violation);
        measures
            .push(Measure::error("rollout error", rolled.rollout_error, re).over(rolled.floor_rollout_error));
        measures.push(Measure::error("… at the end", rolled.last_rollout_error, None));
        measures.push(
            Measure::error("energy violation", rolled.energy_violation, ev)
                .over(rolled.floor_energy_violation),
        );
    }
    measures
}

/// Note with the results that have no column.
fn note(row: &Outcome) -> Option<String> {
    let failed = row.rolled_out.map(|rolled| rolled.failed).filter(|failed| *failed > 0);
    let failed = failed.map(|failed| format!("{failed} rollouts could not be followed to the end"));
    let drag = row
        .drag_error
        .map(|error| format!("learned drag within {}% of the exact one", number(Some(100.0 * error))));
    let step = row.step_microseconds.map(|time| format!("one step takes {time:.2} µs"));
    let notes: Vec<String> = [row.ending.words(), failed, drag, step].into_iter().flatten().collect();
    Some(notes.join("; ")).filter(|note| !note.is_empty())
}

/// Summary in the form of a row of the case, with the growth in place of its measures.
fn summary(growth: &Growth, row: &Record) -> Result<Record, serde_json::Error> {
    let measures = vec![
        Measure::error("time ∝ springs to the power of", growth.time_exponent, None),
        Measure::error("energy violation to the power of", growth.energy_violation_slope, None),
        Measure::error("µs a step of 500", growth.microseconds_per_step_500, None),
    ];
    Ok(Record {
        table: "Growth with the number of springs".to_owned(),
        subject: vec![("springs".to_owned(), "5 to 5,000".to_owned())],
        measures,
        note: None,
        pictures: Vec::new(),
        paper_parameters: None,
        details: serde_json::to_value(growth)?,
        is_summary: true,
        ..row.clone()
    })
}
