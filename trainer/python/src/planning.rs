//! Plans with the command's behaviour, and a callback for every iteration.

use crate::arrays::{rows, tables};
use crate::attend::attended;
use crate::errors::{Kind, failure, input};
use crate::model::Model;
use leastaction::models::{self, Loaded};
use leastaction_core::control::Iteration;
use leastaction_planning::{self as planning, Machine, PlanConfig, PlanError, PlanNode, Progress, Task};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;

/// Start guess, number of nodes, iteration, cost, violation.
type Row = (String, usize, u16, f64, f64);

/// Sends iterations from the threads of a search to that of Python.
struct Sent<'s>(&'s (dyn Fn(Row) + Sync));

impl Progress for Sent<'_> {
    fn iteration(&self, guess: &str, nodes: usize, iteration: &Iteration<f64>) {
        let Iteration { count, cost, violation, .. } = *iteration;
        (self.0)((guess.to_owned(), nodes, count, cost, violation));
    }
}

/// A plan with the machine that it is for.
#[pyclass(frozen, module = "leastaction._leastaction")]
pub struct Plan {
    machine: Machine,
    found: planning::Plan,
}

/// The exception for an error of a plan or of a policy.
pub fn refused(error: PlanError) -> PyErr {
    match error {
        PlanError::Motion(message) => Kind::Work.says(message),
        error => input(error),
    }
}

/// A configuration, the TOML file or the text under its name, and its machine.
pub fn configured(
    (file, text): (PathBuf, Option<String>),
    model: Option<&Model>,
) -> PyResult<(PlanConfig, Machine)> {
    let config = match text {
        Some(text) => PlanConfig::parse(&text, &file),
        None => PlanConfig::read(&file),
    };
    let config = config.map_err(refused)?;
    let machine = machine(&config, model)?;
    Ok((config, machine))
}

/// The model of a machine, as a model file.
pub fn model_of(machine: &Machine) -> PyResult<Model> {
    let bytes = machine.shipped().map_err(refused)?;
    Ok(Model::new(Loaded { model: machine.model.clone(), bytes }))
}

/// The machine of a configuration; a model of Python stands for its file.
fn machine(config: &PlanConfig, model: Option<&Model>) -> PyResult<Machine> {
    let Some(model) = model else { return models::machine(config).map_err(failure) };
    Ok(Machine { file: Some(model.bytes().to_vec()), ..Machine::new(model.host().clone()) })
}

/// Commands of a start guess.
fn given(guess: &PyReadonlyArray2<'_, f64>, n: usize) -> PyResult<Vec<Vec<f64>>> {
    let array = guess.as_array();
    if array.ncols() != n || array.nrows() == 0 {
        let shape = array.shape();
        return Err(input(format!("guess has the shape {shape:?}; it must be [nodes, {n}]")));
    }
    if array.iter().any(|u| !u.is_finite()) {
        return Err(input("guess has a number that is not finite"));
    }
    Ok(array.rows().into_iter().map(|row| row.to_vec()).collect())
}

/// Plans from a configuration, the TOML file `file` or `text`. Ctrl-C keeps the best motion so far; an exception of `callback` stops the
/// search and is raised.
#[pyfunction]
pub fn plan_motion(
    py: Python<'_>,
    config: (PathBuf, Option<String>),
    model: Option<&Model>,
    guess: Option<PyReadonlyArray2<'_, f64>>,
    callback: Option<Py<PyAny>>,
) -> PyResult<Plan> {
    let (config, machine) = configured(config, model)?;
    let task = Task::new(&config, &machine).map_err(refused)?;
    let given = guess.map(|guess| given(&guess, machine.n())).transpose()?;
    let (found, _) = attended(py, callback.as_ref(), |stop, send| {
        planning::plan(&machine, &task, given, (stop, &Sent(send)))
    })?;
    Ok(Plan { found, machine })
}

#[pymethods]
impl Plan {
    /// Returns arrays over the nodes and the end, and what is known of the search.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (found, n) = (&self.found, self.machine.n());
        let nodes: Vec<&PlanNode> = found.nodes.iter().chain([&found.end]).collect();
        let of = |get: &dyn Fn(&PlanNode) -> Vec<f64>| nodes.iter().flat_map(|node| get(node)).collect();
        let facts = PyDict::new(py);
        facts.set_item("x", rows(py, of(&|node| node.x.clone()), [nodes.len(), 2 * n])?)?;
        facts.set_item("u", rows(py, of(&|node| node.u.clone()), [nodes.len(), n])?)?;
        facts.set_item("gains", tables(py, of(&|node| node.gain.concat()), [nodes.len(), n, 2 * n])?)?;
        let tube = &found.tube.widths;
        facts.set_item("tube", rows(py, tube.concat(), [tube.len(), 2 * n])?)?;
        facts.set_item("node_seconds", found.task.node_seconds())?;
        facts.set_item("tick", found.task.tick)?;
        facts.set_item("order", found.task.order.number())?;
        facts.set_item("ticks_per_node", found.task.ticks_per_node)?;
        facts.set_item("cost", found.cost)?;
        facts.set_item("feasible", found.is_feasible())?;
        facts.set_item("violation", found.solution.violation)?;
        facts.set_item("worst", found.worst(&self.machine))?;
        facts.set_item("seconds", found.seconds())?;
        facts.set_item("iterations", found.solution.iterations)?;
        facts.set_item("ending", found.ending())?;
        facts.set_item("holds", found.holds)?;
        facts.set_item("interrupted", found.interrupted)?;
        facts.set_item("names", &self.machine.names)?;
        facts.set_item("notes", &self.machine.notes)?;
        Ok(facts)
    }

    /// Returns guess, nodes, ending, cost, violation, iterations and seconds of every search; the first one is that of the plan.
    fn starts(&self) -> Vec<(String, usize, &'static str, f64, f64, u16, f64)> {
        let start = |of: &planning::StartReport| {
            let (solution, seconds) = (of.solution, of.seconds);
            let ended = of.ending();
            (
                of.guess.clone(),
                of.nodes,
                ended,
                solution.cost,
                solution.violation,
                solution.iterations,
                seconds,
            )
        };
        self.found.starts.iter().map(start).collect()
    }

    /// Returns the model of the machine.
    fn model(&self) -> PyResult<Model> {
        model_of(&self.machine)
    }

    /// Returns the bytes of the plan's file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.found.to_bytes(&self.machine).map_err(refused)?))
    }
}
