//! Numbers of a model that follow a log, with the command's behaviour.

use crate::arrays::rows;
use crate::errors::{Kind, failure, input};
use crate::model::Model;
use crate::tools::{LogRequest, json};
use leastaction::adaptation::{Adaptation, Adapted};
use leastaction::cli::Failure;
use leastaction::evaluation::is_page;
use leastaction::models::{Loaded, of_file_or_run};
use leastaction_adaptation::{Entry, Request};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Wishes for an adaptation.
#[derive(FromPyObject)]
pub struct Wishes {
    #[pyo3(item)]
    body: Option<usize>,
    #[pyo3(item)]
    mass: Option<f64>,
    #[pyo3(item)]
    friction: bool,
    #[pyo3(item)]
    networks: bool,
    #[pyo3(item)]
    window: Option<f64>,
    #[pyo3(item)]
    memory: f64,
    #[pyo3(item)]
    false_alarms: f64,
}

impl Wishes {
    fn request(&self) -> PyResult<Request> {
        let Self { body, mass, friction, networks, window, memory, false_alarms } = *self;
        let given = [
            ("mass", mass),
            ("window", window),
            ("memory", Some(memory)),
            ("false_alarms", Some(false_alarms)),
        ];
        let is_wrong = |value: f64| !(value > 0.0 && value.is_finite());
        match given.into_iter().find(|(_, value)| value.is_some_and(is_wrong)) {
            Some((name, _)) => Err(input(format!("{name} must be a number above 0"))),
            None => Ok(Request { body, mass, friction, networks, window, memory, false_alarms }),
        }
    }
}

/// Report as JSON and in words, notes, the course as arrays, and the adapted model.
type Result<'py> = (String, String, Vec<String>, Bound<'py, PyDict>, Model);

/// Lets numbers of a model, from a file or a run folder, follow a log. `page` names an HTML page to write.
#[pyfunction]
pub fn adapt(
    py: Python<'_>,
    file: PathBuf,
    part: Option<String>,
    log: LogRequest,
    wishes: Wishes,
    page: Option<PathBuf>,
) -> PyResult<Result<'_>> {
    let request = wishes.request()?;
    let model = of_file_or_run(&file, part.as_deref()).map_err(failure)?;
    let (adapted, notes) = py
        .detach(|| {
            let mut notes = Vec::new();
            let of = Adaptation { file: &file, model: &model, config: log.config(), request };
            if let Some(page) = &page
                && !is_page(page)?
            {
                return Err(Failure::input(page, "name a page, as page.html"));
            }
            let adapted = of.along(&log.reading(&file)?, &mut |sentence| notes.push(sentence))?;
            page.iter().try_for_each(|page| adapted.write_page(page))?;
            Ok((adapted, notes))
        })
        .map_err(failure)?;
    let course = course(py, &adapted)?;
    let Adapted { report, followed, .. } = adapted;
    let bytes = followed.model.to_bytes().map_err(|error| Kind::Work.says(error))?;
    let model = Model::new(Loaded { model: followed.model, bytes });
    Ok((json(&report)?, report.to_string(), notes, course, model))
}

/// Arrays over the windows of a course.
fn course<'py>(py: Python<'py>, adapted: &Adapted) -> PyResult<Bound<'py, PyDict>> {
    let (followed, arrays) = (&adapted.followed, PyDict::new(py));
    let entries = &followed.course.entries;
    let (numbers, n) = (followed.choice.settings.numbers.len(), followed.model.n());
    let column = |name: &str, of: fn(&Entry) -> f64| {
        arrays.set_item(name, entries.iter().map(of).collect::<Vec<_>>().into_pyarray(py))
    };
    column("times", |entry| entry.t)?;
    column("moving", |entry| entry.moving)?;
    let table = |name: &str, width: usize, of: fn(&Entry) -> Vec<f32>| {
        arrays.set_item(name, rows(py, entries.iter().flat_map(of).collect(), [entries.len(), width])?)
    };
    table("estimates", numbers, |entry| entry.estimates.iter().map(|found| found.estimate).collect())?;
    table("standard_errors", numbers, |entry| entry.estimates.iter().map(|found| found.error).collect())?;
    table("used", numbers, |entry| entry.applied.clone())?;
    table("residuals", n, |entry| entry.residuals.clone())?;
    Ok(arrays)
}
