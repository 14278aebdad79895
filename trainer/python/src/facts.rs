//! Facts of a model file as dictionaries.

use leastaction_core::model::{CoordinateRange, Interval};
use leastaction_models::Facts;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The range of the training data: smallest and largest q, v and u of every coordinate.
pub fn range<'py>(py: Python<'py>, facts: &Facts) -> PyResult<Option<Bound<'py, PyDict>>> {
    let range = &facts.range;
    if range.is_empty() {
        return Ok(None);
    }
    let dictionary = PyDict::new(py);
    let add = |name: &str, of: fn(&CoordinateRange) -> Interval| {
        let ends = range.iter().map(of).map(|Interval { least, most }| (f64::from(least), f64::from(most)));
        dictionary.set_item(name, ends.collect::<Vec<_>>())
    };
    add("q", |range| range.q)?;
    add("v", |range| range.v)?;
    add("u", |range| range.u)?;
    Ok(Some(dictionary))
}

/// Gain, offset, delay and lag of the drives; `None` if they are ideal.
pub fn actuator<'py>(py: Python<'py>, facts: &Facts) -> PyResult<Option<Bound<'py, PyDict>>> {
    let of = facts.actuator.clone();
    if of.is_ideal() {
        return Ok(None);
    }
    let dictionary = PyDict::new(py);
    dictionary.set_item("gain", of.gain)?;
    dictionary.set_item("offset", of.offset)?;
    dictionary.set_item("delay", of.delay)?;
    dictionary.set_item("lag", of.lag)?;
    Ok(Some(dictionary))
}
