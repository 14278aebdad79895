//! Logs, evaluation, report pages and importers, with the command's behaviour.

use crate::errors::{Kind, failure, input};
use crate::model::Model;
use leastaction::cli::{Failure, FileKind, replaceable};
use leastaction::evaluation::{Evaluation, LogReading, is_page, write_page};
use leastaction::look::Look;
use leastaction::models::{Loaded, encoded, of_file_or_run};
use leastaction_core::discrete::Order;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::TrainedStep;
use leastaction_ground_truth::{ManyBody, Mechanism};
use leastaction_learning::config::{Config, LogFiles};
use leastaction_learning::data::{control_name, control_of_name};
use leastaction_learning::import::{self, Imported};
use leastaction_models::file::{self, Precision};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::{Path, PathBuf};

/// Parses a TOML configuration.
pub fn parsed(text: &str) -> PyResult<Config> {
    Config::parse(text, Path::new("the configuration")).map_err(input)
}

/// A report as JSON.
pub fn json(report: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(report).map_err(|error| Kind::Work.says(error))
}

fn control(name: Option<&str>) -> PyResult<Option<ControlKind>> {
    let known = |name: &str| {
        control_of_name(name).ok_or_else(|| input(format!("control {name:?}: it must be held or linear")))
    };
    name.map(known).transpose()
}

/// Looks at logs; returns the command's report as JSON and in words, its doubts, and the text of a configuration for a
/// file named `output`.
#[pyfunction]
pub fn look_at(
    py: Python<'_>,
    files: Vec<PathBuf>,
    output: PathBuf,
) -> PyResult<(String, String, Vec<String>, Option<String>)> {
    let (report, proposal) = py
        .detach(|| Look::at(&files).map(|look| (look.report(), look.configuration(&output).ok())))
        .map_err(input)?;
    let mut doubts: Vec<String> = report.doubts().iter().map(ToString::to_string).collect();
    doubts.extend(proposal.iter().filter_map(|proposal| proposal.note.clone()));
    Ok((json(&report)?, report.to_string(), doubts, proposal.map(|proposal| proposal.text)))
}

/// A log on which a model is evaluated.
#[derive(FromPyObject)]
pub struct LogRequest {
    #[pyo3(item)]
    config: Option<PathBuf>,
    #[pyo3(item)]
    files: Option<Vec<PathBuf>>,
    /// Whether the files have leastaction's own names.
    #[pyo3(item)]
    native: bool,
    #[pyo3(item)]
    order: Option<u8>,
    #[pyo3(item)]
    control: Option<String>,
}

impl LogRequest {
    /// The configuration, if one is given.
    pub fn config(&self) -> Option<&Path> {
        self.config.as_deref()
    }

    /// The log, and how it is read; the model is a file or the folder of a run.
    pub fn reading(&self, model: &Path) -> Result<LogReading, Failure> {
        match self.files.clone().map(LogFiles) {
            Some(files) if self.native => Ok(LogReading::native(files)),
            files => LogReading::new(self.config.as_deref(), files, model),
        }
    }
}

/// Measures a model, from a file or a run folder, on a log; returns the command's report as JSON and in words, with
/// notes. `page` names an HTML page to write, `beside` a model with which the page compares.
#[pyfunction]
pub fn evaluate(
    py: Python<'_>,
    file: PathBuf,
    part: Option<String>,
    request: LogRequest,
    page: Option<PathBuf>,
    beside: Option<PathBuf>,
) -> PyResult<(String, String, Vec<String>)> {
    let control = control(request.control.as_deref())?;
    let (report, notes) = py
        .detach(|| {
            if let Some(page) = &page
                && !is_page(page)?
            {
                return Err(Failure::input(page, "name a page, as page.html"));
            }
            let model = &of_file_or_run(&file, part.as_deref())?;
            let mut notes = Vec::new();
            let tell = &mut |sentence| notes.push(sentence);
            let evaluation = Evaluation { file: &file, model, order: request.order, control };
            let log = evaluation.read(&request.reading(&file)?, tell)?;
            let report = evaluation.measure(&log, None, tell)?;
            if let Some(page) = &page {
                let other = beside.as_ref().map(|path| of_file_or_run(path, part.as_deref())).transpose()?;
                let other = beside.as_deref().zip(other.as_ref());
                let numbers = report.torques.as_ref().and_then(|torques| torques.torque_numbers.as_ref());
                write_page(page, ((&file, model), other), (&log.file, &log.data), numbers)?;
            }
            Ok((report, notes))
        })
        .map_err(failure)?;
    Ok((json(&report)?, report.to_string(), notes))
}

/// Returns the model of a run.
#[pyfunction]
pub fn model_of_run(folder: PathBuf) -> PyResult<Model> {
    let (_, bytes) = encoded(&folder, Precision::Single).map_err(failure)?;
    let model = file::decode(&bytes).map_err(input)?;
    Ok(Model::new(Loaded { model, bytes }))
}

/// Writes bytes atomically; replaces only a file of the same kind: model, plan, rust, c, log, configuration or page.
#[pyfunction]
pub fn write_file(path: PathBuf, bytes: &[u8], kind: &str) -> PyResult<()> {
    let kind = match kind {
        "model" => FileKind::Model,
        "plan" => FileKind::Plan,
        "rust" => FileKind::RustModule,
        "c" => FileKind::CHeader,
        "log" => FileKind::Log,
        "configuration" => FileKind::Configuration,
        _ => FileKind::Page,
    };
    replaceable(&path, kind).map_err(failure)?;
    leastaction_learning::atomic::write(&path, bytes)
        .map_err(|error| Kind::Work.says(format!("{}: {error}", path.display())))
}

/// A log: h, control kind, trajectories, notes.
type ReadLog<'py> = (f64, Option<&'static str>, Bound<'py, PyList>, Vec<String>);

/// Reads a log according to the `[data]` of a configuration, if one is given; returns h, control kind, trajectories and
/// notes.
#[pyfunction]
pub fn read_log<'py>(
    py: Python<'py>,
    config: Option<PathBuf>,
    files: Option<Vec<PathBuf>>,
) -> PyResult<ReadLog<'py>> {
    let native = config.is_none();
    let request = LogRequest { config, files, native, order: None, control: None };
    let (log, notes) = py
        .detach(|| {
            let mut notes = Vec::new();
            let reading = request.reading(Path::new(""))?;
            let log = reading.read((None, None), &mut |sentence| notes.push(sentence))?;
            Ok((log, notes))
        })
        .map_err(failure)?;
    let motions = PyList::empty(py);
    for motion in &log.trajectories {
        let dictionary = PyDict::new(py);
        dictionary.set_item("id", motion.id)?;
        dictionary.set_item("t", log.times(motion).collect::<Vec<_>>().into_pyarray(py))?;
        let fields = [
            ("q", Some(&motion.q)),
            ("v", motion.v.as_ref()),
            ("a", motion.a.as_ref()),
            ("u", motion.u.as_ref()),
        ];
        for (name, rows) in fields.into_iter().filter_map(|(name, rows)| Some((name, rows?))) {
            let array = rows.as_flat().to_vec().into_pyarray(py).reshape([rows.len(), log.n])?;
            dictionary.set_item(name, array)?;
        }
        motions.append(dictionary)?;
    }
    Ok((log.h, log.control.map(control_name), motions, notes))
}

fn mechanism(name: &str) -> PyResult<Mechanism> {
    let known = [Mechanism::Pendulum, Mechanism::Cartpole, Mechanism::Acrobot];
    let found = known.into_iter().find(|mechanism| mechanism.name() == name);
    found.ok_or_else(|| {
        input(format!("no mechanism is called {name:?}; there are pendulum, cartpole and acrobot"))
    })
}

/// Imports a network of the SyMo authors' program from safetensors.
#[pyfunction]
#[pyo3(signature = (bytes, name, system=None, coordinates=None, h=None))]
pub fn import_symo(
    bytes: &[u8],
    name: &str,
    system: Option<&str>,
    coordinates: Option<&str>,
    h: Option<f32>,
) -> PyResult<Model> {
    let system = system.map(mechanism).transpose()?;
    let letters: Option<Vec<Coordinate>> =
        coordinates.map(|letters| letters.chars().filter_map(Coordinate::from_letter).collect());
    let kinds =
        letters.or(system.map(|system| system.coordinates().to_vec())).filter(|kinds| !kinds.is_empty());
    let kinds = kinds.ok_or_else(|| input("name the system, or the coordinates: one letter each, t or a"))?;
    let imported = import::symo(bytes, &kinds).map_err(|error| input(format!("{name}: {error}")))?;
    let step = h.or(system.map(|system| system.step() as f32)).filter(|_| imported.discrete);
    let step = step.map(|h| TrainedStep { order: Order::Two, h, control: ControlKind::Linear });
    model_of(&imported, step, (name, "SyMo"))
}

/// Imports a network of the ModLaNet authors' program from safetensors.
#[pyfunction]
#[pyo3(signature = (bytes, name, bodies, count, mass=None))]
pub fn import_modlanet(
    bytes: &[u8],
    name: &str,
    bodies: bool,
    count: usize,
    mass: Option<f64>,
) -> PyResult<Model> {
    let system = if bodies { ManyBody::Bodies(count) } else { ManyBody::Pendulum(count) };
    let imported =
        import::modlanet(bytes, system, mass).map_err(|error| input(format!("{name}: {error}")))?;
    model_of(&imported, None, (name, "ModLaNet"))
}

/// Imports a network of the LGNN authors' program from safetensors.
#[pyfunction]
pub fn import_lgnn(bytes: &[u8], name: &str, count: usize, drag: bool) -> PyResult<Model> {
    let imported = import::lgnn(bytes, count, drag).map_err(|error| input(format!("{name}: {error}")))?;
    model_of(&imported, None, (name, "LGNN"))
}

fn model_of(
    imported: &Imported,
    step: Option<TrainedStep>,
    (name, program): (&str, &str),
) -> PyResult<Model> {
    let provenance = format!("imported from {name} ({program})");
    let bytes = file::encode(&imported.architecture, &imported.weights, step, &provenance).map_err(input)?;
    let model = file::decode(&bytes).map_err(input)?;
    Ok(Model::new(Loaded { model, bytes }))
}
