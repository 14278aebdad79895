//! Cases as tasks, with their rows as records.

use super::super::record::{Measure, Record};
use super::super::task::{Task, TaskError, Tell, json, watch};
use super::super::{SYMO, option_name};
use super::floor::floor;
use super::published::published;
use super::{Case, Outcome, portrait};
use leastaction_ground_truth::{IntegrationError, Mechanism, symo_set};
use leastaction_learning::data::symo::SymoSet;
use leastaction_models::Model;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Data of a mechanism: generated when the first task needs it, or read from a file.
#[derive(Clone, Debug)]
pub struct SymoData {
    set: Arc<OnceLock<Result<SymoSet, IntegrationError>>>,
    /// Errors of exact physics on this data at order 2 and at order 4, computed when the first task needs them.
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

    fn description(&self) -> String {
        let noise = if self.noise > 0.0 { format!(", with noise of {}", self.noise) } else { String::new() };
        let generated = || format!("exact motion of our own generator, seed {}{noise}", self.seed);
        self.file.clone().unwrap_or_else(generated)
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

/// Creates the tasks of these cases on the data of their mechanism; `arguments` are the command-line options other than
/// those that identify a case.
pub fn tasks(cases: &[Case], data: &SymoData, arguments: &str) -> Vec<Task> {
    cases.iter().map(|case| task(*case, data.clone(), arguments)).collect()
}

fn task(case: Case, data: SymoData, arguments: &str) -> Task {
    let Case { mechanism, model, order, trajectories, seed, noise, .. } = case;
    let (paper, system, method) = (SYMO.name, mechanism.name(), option_name(&model));
    let noisy = |before: &str| if noise > 0.0 { format!("{before}{noise}") } else { String::new() };
    let name = format!("{system}-{method}-{order}-{trajectories}{}-{seed}", noisy("-noise-"));
    let options = format!(
        "--system {system} --model {method} --order {order} --trajectories {trajectories}{}",
        noisy(" --noise ")
    );
    let source = data.description();
    let per_trajectory = if order == 4 && model.is_discrete() { 1.0 } else { 0.1 };
    Task {
        command: format!("leastaction-papers {paper} {options} --seed {seed}{arguments}"),
        settings: json(&(case, &source)),
        data: source,
        options: arguments.to_owned(),
        expected_seconds: per_trajectory * (trajectories + 8) as f64,
        is_timed: false,
        name: name.clone(),
        run: Box::new(move |folder, tell| Ok(vec![learned(&case, &data, (folder, &name), tell)?])),
    }
}

/// Learns a case and evaluates the result.
fn learned(
    case: &Case,
    data: &SymoData,
    (folder, name): (Option<&Path>, &str),
    tell: &Tell,
) -> Result<Record, TaskError> {
    let mut watch = watch(tell, 20, (String::new(), ": loss".to_owned()));
    let set = data.get()?;
    if !case.model.is_discrete() {
        return Ok(record(case, &case.run_from_states(set, &mut watch)?, [f64::NAN; 6])?);
    }
    let (clock, recipe) = (Instant::now(), case.recipe());
    let (architecture, weights) = case.learn(recipe, set, &mut watch)?;
    let model = Model::new(architecture, weights);
    let outcome = case.outcome(&model, set, clock.elapsed().as_secs_f64())?;
    let drawn = folder.filter(|_| case.trajectories == PORTRAYED && case.noise == 0.0);
    let drawn = drawn.map(|folder| portrait::draw(folder, name, case, &model)).transpose()?;
    Ok(Record { pictures: drawn.into_iter().collect(), ..record(case, &outcome, data.floor(case.order)?)? })
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
    let measures = names.into_iter().zip(row.measures()).zip(published.measures).zip(floor);
    let table = if case.noise > 0.0 { format!("{system}, noisy") } else { system.to_owned() };
    let subject = [("trajectories", case.trajectories.to_string()), ("noise", case.noise.to_string())];
    Ok(Record {
        model: label(case),
        is_ours: case.model.is_discrete(),
        parameters: row.parameters,
        paper_parameters: published.parameters,
        seed: row.seed,
        train_seconds: row.train_seconds,
        measures: measures
            .map(|(((name, ours), paper), floor)| Measure::error(name, ours, paper).over(floor))
            .collect(),
        ..Record::of(&table, subject, row)?
    })
}
