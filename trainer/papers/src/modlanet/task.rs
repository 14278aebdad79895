//! Experiments as tasks, with their rows as records.

use super::super::interrupted::Interrupted;
use super::super::record::{Measure, Record};
use super::super::task::{Task, TaskError, compared, with_seeds};
use super::super::training::{Bounds, Limits};
use super::super::{numbered, option_name};
use super::{Baseline, Case, Options, Outcome, Predicted, Stepped, figures, run, run_baseline};
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

/// A case with one seed: our model, or one that the paper compares with.
struct Experiment {
    case: Case,
    baseline: Option<(Baseline, Limits)>,
    options: Options,
    data: Option<ModlanetData>,
    /// Command-line options other than case and seed.
    arguments: String,
}

/// Creates the tasks of these cases, each with `seeds` seeds from that of the options on, and those of the baselines within the limits, in
/// cases that have them; without data it is generated. `arguments` are the command-line options other than case and seed.
pub fn tasks(
    cases: &[Case],
    options: &Options,
    (baselines, limits): (&[Baseline], Limits),
    seeds: usize,
    data: Option<&ModlanetData>,
    arguments: &str,
) -> Vec<Box<dyn Task>> {
    let one = |(case, baseline): &(Case, Option<(Baseline, Limits)>), seed: u64| {
        let (options, arguments) = (Options { seed, ..options.clone() }, arguments.to_owned());
        Experiment { case: *case, baseline: *baseline, options, data: data.cloned(), arguments }
    };
    let rows = cases.iter().flat_map(|case| {
        let baselines = if case.has_baselines() { baselines } else { &[] };
        compared(*case, baselines.iter().map(|baseline| (*baseline, limits)))
    });
    with_seeds(rows, (options.seed, seeds), one)
}

impl Task for Experiment {
    fn name(&self) -> String {
        let model = self.baseline.map_or(String::new(), |(baseline, _)| format!("-{}", baseline.name()));
        format!("{}{model}-{}", option_name(&self.case), self.options.seed)
    }

    fn command(&self) -> String {
        let (case, seed) = (option_name(&self.case), self.options.seed);
        let only = self.baseline.map_or(String::new(), |_| format!(" --baselines --only {}", self.name()));
        format!("leastaction-papers modlanet --case {case}{only} --seed {seed}{}", self.arguments)
    }

    fn data(&self) -> String {
        let generated = || format!("exact motion of our own generator, seed {}", self.options.seed);
        self.data.as_ref().map_or_else(generated, |data| data.file.clone())
    }

    fn settings(&self) -> String {
        serde_json::to_string(&(self.case, self.baseline, &self.options, self.data())).unwrap_or_default()
    }

    fn options(&self) -> String {
        self.arguments.clone()
    }

    fn expected_seconds(&self) -> f64 {
        if let Some((_, limits)) = self.baseline {
            return limits.expected_seconds();
        }
        match self.case {
            Case::DoublePendulum | Case::ExtendPendulum => 40.0,
            Case::ThreeBody => 10.0,
            Case::ExtendBody => 20.0,
            Case::DatasetSize => 90.0,
            Case::DirectLarge | Case::Noise => 30.0,
        }
    }

    fn run(&self, folder: Option<&Path>, tell: &(dyn Fn(&str) + Sync)) -> Result<Vec<Record>, TaskError> {
        let data = self.data.as_ref().map(|data| &*data.set);
        let rows = match self.baseline {
            None => run(self.case, &self.options, data, tell)?,
            Some((baseline, limits)) => {
                let settings = serde_json::to_string(&(self.case, baseline, &self.options, self.data()))?;
                let run = |interrupted: Option<&Interrupted>| {
                    let bounds = Bounds { limits, interrupted };
                    run_baseline((self.case, baseline), (&self.options, bounds), data, tell)
                };
                vec![Interrupted::resume(folder, &self.name(), settings, run)?]
            }
        };
        let mut records = Vec::new();
        for row in rows {
            let drawn = folder.map_or(Ok(Vec::new()), |folder| figures::draw(folder, &row))?;
            records.push(Record { pictures: drawn, ..record(&row)? });
        }
        Ok(records)
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
    let subject = [
        ("system", numbered(row.system, row.count)),
        ("samples", row.samples.to_string()),
        ("noise", row.noise.to_string()),
    ];
    let (model, is_ours) = model(row.kind);
    Ok(Record {
        table: table.to_owned(),
        subject: subject.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        model,
        is_ours,
        parameters: row.parameters,
        paper_parameters: row.published.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures(row, has_predictions),
        note: note(row),
        pictures: Vec::new(),
        details: serde_json::to_value(row)?,
        is_summary: false,
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
    let mut measures = vec![
        Measure::error("train MSE", row.train_mse, None),
        Measure::error("test MSE", row.test_mse, row.published.test_mse),
        Measure::error("relative test MSE", row.relative_test_mse, None),
    ];
    if has_predictions {
        let of = |value: fn(&Predicted) -> f64| row.predicted.as_ref().map_or(f64::NAN, value);
        let paper = |value: Option<f64>| value.filter(|_| row.predicted.is_some());
        let (position, energy) = (paper(row.published.position), paper(row.published.energy));
        measures.push(Measure::error("A_q", of(|p| p.position), position).over(of(|p| p.floor_position)));
        measures.push(Measure::error("A_E", of(|p| p.energy), energy).over(of(|p| p.floor_energy)));
        let valid = Measure::error("valid, s", of(|p| p.valid_seconds), None).more_is_better();
        measures.push(valid.over(of(|p| p.floor_valid_seconds)));
    }
    measures
}

/// Note on the end of the training, the reason for missing predictions, and the energies of the long run.
fn note(row: &Outcome) -> Option<String> {
    let unpredicted = row.unpredicted.map(|why| format!("no predictions: {why}"));
    let notes = [row.ending.words(), unpredicted, row.stepped.as_ref().map(energies)];
    Some(notes.into_iter().flatten().collect::<Vec<_>>().join("; ")).filter(|note| !note.is_empty())
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
