//! Training with the command's behaviour, and a callback for every iteration.

use crate::errors::{failure, input};
use crate::tools::parsed;
use leastaction::training::{plan, train};
use leastaction_learning::config::Config;
use leastaction_learning::run::{Ending, Monitor, Plan, Row, Run};
use leastaction_models::config::ModelConfig;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between checks for Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

/// Reports training to Python: rows to `callback`, warnings to `tell`. If either raises an exception, training saves
/// and stops.
struct Teller<'a> {
    callback: Option<Py<PyAny>>,
    tell: Py<PyAny>,
    stop: &'a AtomicBool,
    looked: Instant,
    raised: Option<PyErr>,
}

impl Teller<'_> {
    /// Runs `work` in Python; an exception stops training.
    fn with(&mut self, work: impl FnOnce(Python<'_>) -> PyResult<()>) {
        if let Err(error) = Python::attach(work) {
            self.stop.store(true, Ordering::Relaxed);
            self.raised.get_or_insert(error);
        }
    }

    fn says(&mut self, sentence: String) {
        let tell = Python::attach(|py| self.tell.clone_ref(py));
        self.with(|py| tell.call1(py, (sentence,)).map(|_| ()));
    }
}

impl Monitor for Teller<'_> {
    fn row(&mut self, Row { iteration, stage, seconds, train, validation }: &Row) {
        let callback = self.callback.take();
        if callback.is_some() || self.looked.elapsed() >= PAUSE {
            self.looked = Instant::now();
            self.with(|py| {
                py.check_signals()?;
                let row = (iteration, stage, seconds, train, validation);
                callback.as_ref().map_or(Ok(()), |callback| callback.call1(py, row).map(|_| ()))
            });
        }
        self.callback = callback;
    }

    fn warning(&mut self, message: &str) {
        self.says(format!("warning: {message}"));
    }
}

/// The ways in which a run can begin.
#[derive(Clone, Copy)]
struct Beginning {
    resume: bool,
    force: bool,
}

impl Beginning {
    fn run(self, plan: Plan, folder: &Path) -> Result<Run, leastaction::cli::Failure> {
        let begun =
            if self.resume { Run::resume(plan, folder) } else { Run::begin(plan, folder, self.force) };
        Ok(begun?)
    }
}

/// Trains from a configuration, the TOML file `file` or `text`. Returns the command's report as JSON.
#[pyfunction]
#[pyo3(signature = (file, text, folder, resume, force, callback, tell))]
#[allow(clippy::too_many_arguments)]
pub fn train_run(
    py: Python<'_>,
    file: PathBuf,
    text: Option<String>,
    folder: PathBuf,
    resume: bool,
    force: bool,
    callback: Option<Py<PyAny>>,
    tell: Py<PyAny>,
) -> PyResult<String> {
    let config = match text {
        Some(text) => Config::parse(&text, &file).map_err(input)?,
        None => Config::read(&file).map_err(input)?,
    };
    let stop = AtomicBool::new(false);
    let began = Beginning { resume, force };
    let (report, raised) = py.detach(|| {
        let mut teller = Teller { callback, tell, stop: &stop, looked: Instant::now(), raised: None };
        let plan =
            plan(&file, config, &mut |sentence| teller.says(format!("note: {sentence}"))).map_err(failure)?;
        let mut run = began.run(plan, &folder).map_err(failure)?;
        let trained = train(&mut run, &folder, &mut teller, &stop).map_err(failure)?;
        if let Some(poor) = &trained.0.poor {
            teller.warning(poor);
        }
        Ok::<_, PyErr>((trained, teller.raised))
    })?;
    match (report, raised) {
        ((report, Ending::Interrupted), Some(error)) => Err(interrupted(py, error, &folder, report.saved)),
        ((report, _), _) => serde_json::to_string(&report).map_err(input),
    }
}

/// The exception that stopped training; the message of a KeyboardInterrupt says how to continue.
fn interrupted(py: Python<'_>, error: PyErr, folder: &Path, saved: Option<u64>) -> PyErr {
    if !error.is_instance_of::<PyKeyboardInterrupt>(py) {
        return error;
    }
    let folder = folder.display();
    PyKeyboardInterrupt::new_err(match saved {
        Some(iteration) => {
            format!("interrupted; iteration {iteration} is saved in {folder}. Go on with resume=True")
        }
        None => format!("interrupted before a checkpoint was written; {folder} is as it was"),
    })
}

/// Returns the default configuration of a family, with every key explained.
#[pyfunction]
pub fn defaults(family: &str) -> PyResult<&'static str> {
    ModelConfig::defaults(family).ok_or_else(|| {
        let families = ModelConfig::FAMILIES.join(", ");
        input(format!("no family is called {family:?}; there are {families}"))
    })
}

/// Returns a configuration as TOML, every key written out.
#[pyfunction]
pub fn checked(text: &str) -> PyResult<String> {
    Ok(parsed(text)?.to_toml())
}
