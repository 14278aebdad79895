//! Points of a drawn mechanism, for `leastaction.viewer`.

use crate::arrays::{table, tables};
use crate::errors::input;
use crate::model::Model;
use leastaction_planning::{Machine, Part, Scene};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Kind of a part, and the numbers of its points.
fn named(part: &Part) -> (&'static str, Vec<usize>) {
    match *part {
        Part::Link(a, b) => ("link", vec![a, b]),
        Part::Rail(a, b) => ("rail", vec![a, b]),
        Part::Pivot(at) => ("pivot", vec![at]),
        Part::Block(at, [a, b]) => ("block", vec![at, a, b]),
    }
}

/// Returns what is drawn of a model at the positions q, [states, n]: points ([states, points, 3], m), parts, tips, right, up and about;
/// `None` if the model does not know its geometry.
#[pyfunction]
pub fn scene<'py>(
    py: Python<'py>,
    model: &Model,
    q: PyReadonlyArrayDyn<'py, f64>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    let q = table("q", &q, &[model.host().n()])?;
    let path: Vec<Vec<f64>> = (0..q.count).map(|k| q.row(k).to_vec()).collect();
    let Some(scene) = Scene::new(model.host(), &path, &[]) else { return Ok(None) };
    let points: Vec<Vec<_>> = path.iter().map(|q| scene.at(q)).collect();
    let shape = [path.len(), points.first().map_or(0, Vec::len), 3];
    let numbers = points.iter().flatten().flat_map(|point| [point.x, point.y, point.z]).collect();
    let found = PyDict::new(py);
    found.set_item("points", tables(py, numbers, shape)?)?;
    found.set_item("parts", scene.parts().iter().map(named).collect::<Vec<_>>())?;
    found.set_item("tips", scene.tips())?;
    found.set_item("right", <[f64; 3]>::from(scene.view.right))?;
    found.set_item("up", <[f64; 3]>::from(scene.view.up))?;
    found.set_item("about", &scene.about)?;
    Ok(Some(found))
}

/// Returns the model of a robot description, whose numbers are all known, with the names of its coordinates and remarks.
#[pyfunction]
pub fn model_of_description(path: PathBuf) -> PyResult<(Model, Vec<String>, Vec<String>)> {
    let machine = Machine::of_description(&path).map_err(input)?;
    Ok((crate::planning::model_of(&machine)?, machine.names, machine.notes))
}
