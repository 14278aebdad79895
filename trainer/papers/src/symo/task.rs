//! Cases as tasks, with their rows as records.

use super::super::option_name;
use super::super::record::{Measure, Record};
use super::super::task::{Task, TaskError};
use super::floor::floor;
use super::{Case, Outcome, portrait, published};
use leastaction_ground_truth::{IntegrationError, Mechanism, symo_set};
use leastaction_learning::data::symo::SymoSet;
use leastaction_models::Model;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

pub use super::figures::overview;

/// Data of a mechanism: generated when the first task needs it, or read from a file.
#[derive(Clone, Debug)]
pub struct SymoData {
    set: Arc<OnceLock<Result<SymoSet, IntegrationError>>>,
    /// Errors of exact physics on this data at order 2 and at order 4, measured when the first task needs them.
    floors: Arc<[OnceLock<[f64; 6]>; 2]>,
    mechanism: Mechanism,
    seed: u64,
    noise: f64,
    /// File that the data was read from.
    file: Option<String>,
}

impl SymoData {
    /// Creates data by our own generator, with noise on the training and the test set.
    pub fn generated(mechanism: Mechanism, seed: u64, noise: f64) -> Self {
        Self { set: Arc::default(), floors: Arc::default(), mechanism, seed, noise, file: None }
    }

    /// Creates data that was read from a file.
    pub fn read(mechanism: Mechanism, file: String, set: SymoSet) -> Self {
        let set = Arc::new(Ok(set).into());
        Self { set, floors: Arc::default(), mechanism, seed: 0, noise: 0.0, file: Some(file) }
    }

    fn floor(&self, order: u8) -> Result<[f64; 6], IntegrationError> {
        let (set, [two, four]) = (self.get()?, &*self.floors);
        let of_order = if order == 4 { four } else { two };
        Ok(*of_order.get_or_init(|| floor(self.mechanism, order, set)))
    }

    fn get(&self) -> Result<&SymoSet, IntegrationError> {
        let generate = || symo_set(self.mechanism, self.seed, self.noise);
        self.set.get_or_init(generate).as_ref().map_err(Clone::clone)
    }
}

/// A case on its data.
struct Experiment {
    case: Case,
    data: SymoData,
    /// Command-line options other than those that name the case.
    arguments: String,
}

/// Creates the tasks of these cases on the data of their mechanism; `arguments` are the command-line options other than those that name a
/// case.
pub fn tasks(cases: &[Case], data: &SymoData, arguments: &str) -> Vec<Box<dyn Task>> {
    let one = |case: &Case| -> Box<dyn Task> {
        Box::new(Experiment { case: *case, data: data.clone(), arguments: arguments.to_owned() })
    };
    cases.iter().map(one).collect()
}

impl Task for Experiment {
    fn name(&self) -> String {
        let Case { mechanism, model, order, trajectories, seed, noise, .. } = &self.case;
        let noise = if *noise > 0.0 { format!("-noise-{noise}") } else { String::new() };
        format!("{}-{}-{order}-{trajectories}{noise}-{seed}", mechanism.name(), option_name(model))
    }

    fn command(&self) -> String {
        let Case { mechanism, model, order, trajectories, seed, noise, .. } = &self.case;
        let noise = if *noise > 0.0 { format!(" --noise {noise}") } else { String::new() };
        let (system, model) = (mechanism.name(), option_name(model));
        let case = format!("--system {system} --model {model} --order {order} --trajectories {trajectories}");
        format!("leastaction-papers symo {case}{noise} --seed {seed}{}", self.arguments)
    }

    fn data(&self) -> String {
        let noise = if self.data.noise > 0.0 {
            format!(", with noise of {}", self.data.noise)
        } else {
            String::new()
        };
        let generated = || format!("exact motion of our own generator, seed {}{noise}", self.data.seed);
        self.data.file.clone().unwrap_or_else(generated)
    }

    fn settings(&self) -> String {
        let data = self.data();
        serde_json::to_string(&(self.case, data)).unwrap_or_default()
    }

    fn options(&self) -> String {
        self.arguments.clone()
    }

    fn expected_seconds(&self) -> f64 {
        let per_trajectory = if self.case.order == 4 && self.case.model.is_discrete() { 1.0 } else { 0.1 };
        per_trajectory * (self.case.trajectories + 8) as f64
    }

    fn run(&self, folder: Option<&Path>, tell: &(dyn Fn(&str) + Sync)) -> Result<Vec<Record>, TaskError> {
        let watch = |iteration: usize, loss: f64| {
            if iteration.is_multiple_of(20) {
                tell(&format!("iteration {iteration}: loss {loss:.2e}"));
            }
        };
        let (case, set) = (&self.case, self.data.get()?);
        if !case.model.is_discrete() {
            let outcome = case.run_from_states(set, &mut { watch })?;
            return Ok(vec![record(case, &outcome, [f64::NAN; 6])?]);
        }
        let (clock, recipe) = (Instant::now(), case.recipe());
        let (architecture, weights) = case.learn(recipe, set, &mut { watch })?;
        let model = Model::new(architecture, weights);
        let outcome = case.outcome(&model, set, clock.elapsed().as_secs_f64())?;
        let drawn = folder.filter(|_| case.trajectories == PORTRAYED && case.noise == 0.0);
        let drawn = drawn.map(|folder| portrait::draw(folder, &self.name(), case, &model));
        let record = record(case, &outcome, self.data.floor(case.order)?)?;
        Ok(vec![Record { pictures: drawn.transpose()?.into_iter().collect(), ..record }])
    }
}

/// Number of training trajectories of the models whose motion is drawn.
const PORTRAYED: usize = 32;

/// Name of a model in the tables; that of a baseline includes its integrator.
fn label(case: &Case) -> String {
    let name = option_name(&case.model);
    if case.model.is_discrete() { format!("{name}, order {}", case.order) } else { name }
}

fn record(case: &Case, row: &Outcome, floor: [f64; 6]) -> Result<Record, serde_json::Error> {
    let (published, system) = (published(case), case.mechanism.name());
    let names = ["test", "integration", "… median", "… 100 steps", "energy", "inertia"];
    let paper = published.map_or([None; 6], |published| published.measures);
    let measures = names.into_iter().zip(row.measures()).zip(paper).zip(floor);
    Ok(Record {
        table: if case.noise > 0.0 { format!("{system}, noisy") } else { system.to_owned() },
        subject: vec![
            ("trajectories".to_owned(), case.trajectories.to_string()),
            ("noise".to_owned(), case.noise.to_string()),
        ],
        model: label(case),
        is_ours: case.model.is_discrete(),
        parameters: row.parameters,
        paper_parameters: published.map(|published| published.parameters),
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures
            .map(|(((name, ours), paper), floor)| Measure::error(name, ours, paper).over(floor))
            .collect(),
        note: None,
        pictures: Vec::new(),
        details: serde_json::to_value(row)?,
        is_summary: false,
    })
}
