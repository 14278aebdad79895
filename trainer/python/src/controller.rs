//! Policies from anywhere, which a simulator calls.

use crate::attend::attended;
use crate::errors::input;
use crate::model::{Model, OnChip};
use crate::planning::{configured, model_of, refused};
use leastaction_planning::Task;
use leastaction_planning::policy::{Decider, Policy, State};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A policy, and the law of the present run.
struct Run<'c> {
    policy: Policy<'c>,
    law: Decider<'c>,
}

self_cell::self_cell!(
    struct Controlling {
        owner: Arc<OnChip>,
        #[not_covariant]
        dependent: Run,
    }
);

/// Brings a mechanism to a posture from anywhere, and holds it there.
#[pyclass(frozen, module = "leastaction._leastaction")]
pub struct Controller {
    controlling: Mutex<Controlling>,
    task: Task,
    names: Vec<String>,
    notes: Vec<String>,
    interrupted: bool,
}

impl Controller {
    fn controlling(&self) -> MutexGuard<'_, Controlling> {
        self.controlling.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Controller {
    /// Searches the library of a configuration, the TOML file or the text under its name. `callback` hears of the number of searched starts
    /// and that of all. Ctrl-C keeps the motions so far.
    #[new]
    #[pyo3(signature = (config, model, callback))]
    fn new(
        py: Python<'_>,
        config: (PathBuf, Option<String>),
        model: Option<&Model>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (config, machine) = configured(config, model)?;
        let task = Task::new(&config, &machine).map_err(refused)?;
        let (model, starts) = (model_of(&machine)?, task.policy.starts);
        let mut interrupted = false;
        let controlling = Controlling::try_new(model.chip()?.clone(), |chip| {
            let replica = (chip.borrow_dependent(), model.host());
            let (policy, stopped) = attended(py, callback.as_ref(), |stop, send| {
                Policy::new(replica, &task, &|done| {
                    send((done, starts));
                    !stop.load(Ordering::Relaxed)
                })
            })?;
            interrupted = stopped;
            Ok::<_, PyErr>(Run { law: policy.begin(), policy })
        })?;
        let controlling = Mutex::new(controlling);
        Ok(Self { controlling, task, names: machine.names, notes: machine.notes, interrupted })
    }

    /// Returns the command of every coordinate, the state of the law, and whether a motion was searched.
    fn decide<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'py, f64>,
        v: PyReadonlyArray1<'py, f64>,
        t: Option<f64>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, &'static str, bool)> {
        let [q, v] = [q, v].map(|list| list.as_array().to_vec());
        let decided =
            py.detach(|| self.controlling().with_dependent_mut(|_, run| run.law.decide([&q, &v], t)));
        let decision = decided.map_err(input)?;
        let state = match decision.state {
            State::Follow => "follow",
            State::Hold => "hold",
            State::Brake => "brake",
        };
        Ok((PyArray1::from_vec(py, decision.u), state, decision.searched))
    }

    /// Forgets the present run.
    fn reset(&self, py: Python<'_>) {
        py.detach(|| self.controlling().with_dependent_mut(|_, run| run.law = run.policy.begin()));
    }

    /// Returns what is known of the library and of the task.
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seconds = py.detach(|| self.controlling().with_dependent(|_, run| run.policy.seconds()));
        let facts = PyDict::new(py);
        facts.set_item("seconds", PyArray1::from_vec(py, seconds))?;
        facts.set_item("tick", self.task.tick)?;
        let [low, high] = [0, 1].map(|end| self.task.limits.u.iter().map(|u| u[end]).collect::<Vec<_>>());
        facts.set_item("low", PyArray1::from_vec(py, low))?;
        facts.set_item("high", PyArray1::from_vec(py, high))?;
        facts.set_item("interrupted", self.interrupted)?;
        facts.set_item("names", &self.names)?;
        facts.set_item("notes", &self.notes)?;
        Ok(facts)
    }
}
