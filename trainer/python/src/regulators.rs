//! Linear approximations of a model, and linear regulators.

use crate::arguments::order;
use crate::arrays::rows;
use crate::errors::{Kind, input};
use crate::model::Model;
use leastaction_planning::{DMatrix, LinearSystem, LqrError, NodeStep, PlanError};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// A matrix of Python.
type Matrix<'py> = Bound<'py, PyArray2<f64>>;
/// A list of numbers of Python.
type List<'py> = PyReadonlyArray1<'py, f64>;

fn matrix<'py>(py: Python<'py>, from: &DMatrix<f64>) -> PyResult<Matrix<'py>> {
    rows(py, from.transpose().as_slice().to_vec(), [from.nrows(), from.ncols()])
}

fn dense(from: &PyReadonlyArray2<'_, f64>) -> DMatrix<f64> {
    let array = from.as_array();
    DMatrix::from_fn(array.nrows(), array.ncols(), |i, j| array[[i, j]])
}

fn refused(error: LqrError) -> PyErr {
    match error {
        LqrError::NotStabilisable | LqrError::Unseen => Kind::Solve.says(error),
        error => input(error),
    }
}

/// Returns v̇ as a matrix of one row, ∂v̇/∂(q, v, u), and ∂u/∂(q, v, v̇) of inverse dynamics; `None` where they do not exist.
#[pyfunction]
pub fn linearize<'py>(
    py: Python<'py>,
    model: &Model,
    q: List<'py>,
    v: List<'py>,
    u: List<'py>,
) -> PyResult<Option<Vec<Matrix<'py>>>> {
    let [q, v, u] = [q, v, u].map(|list| list.as_array().to_vec());
    let Some(found) = py.detach(|| model.host().linearize(&q, &v, &u)).map_err(input)? else {
        return Ok(None);
    };
    let n = q.len();
    let square = |numbers: Vec<f64>| rows(py, numbers, [n, n]);
    Ok(Some(vec![
        rows(py, found.acceleration, [1, n])?,
        square(found.acceleration_q)?,
        square(found.acceleration_v)?,
        square(found.acceleration_u)?,
        square(found.control_q)?,
        square(found.control_v)?,
        square(found.control_a)?,
    ]))
}

/// Returns A and B of the node of `ticks` steps (h, order) that begins at q and v under the command u.
#[pyfunction]
pub fn linearize_step<'py>(
    py: Python<'py>,
    model: &Model,
    at: (List<'py>, List<'py>, List<'py>),
    step: (f64, u8),
    ticks: u16,
) -> PyResult<(Matrix<'py>, Matrix<'py>)> {
    let [q, v, u] = [at.0, at.1, at.2].map(|list| list.as_array().to_vec());
    let step = NodeStep { tick: step.0, order: order(step.1)?, ticks };
    let replica = (model.chip()?.borrow_dependent(), &model.host().facts.actuator);
    let found = py.detach(|| leastaction_planning::linearise(replica, &step, [&q, &v, &u]));
    let system = found.map_err(|error| match error {
        PlanError::Motion(message) => Kind::Solve.says(message),
        error => input(error),
    })?;
    Ok((matrix(py, system.a())?, matrix(py, system.b())?))
}

/// Returns K, P and A − BK of the regulator of x⁺ = A x + B u with weights Q and R, whose commands arrive `delay` steps late and act
/// behind a lag of `lag` steps.
#[pyfunction]
pub fn regulator<'py>(
    py: Python<'py>,
    system: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    weights: (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>),
    delay: f64,
    lag: f64,
) -> PyResult<[Matrix<'py>; 3]> {
    let [a, b, q, r] = [&system.0, &system.1, &weights.0, &weights.1].map(dense);
    let states = a.nrows();
    let (found, closed) = py
        .detach(|| {
            let system = LinearSystem::new(a, b)?.lagged(lag)?.delayed(delay)?;
            let weights = padded(q, (states, system.a().nrows()));
            let found = system.regulator(&weights, &r)?;
            let closed = system.closed_loop(&found.gain);
            Ok((found, closed))
        })
        .map_err(refused)?;
    Ok([matrix(py, &found.gain)?, matrix(py, &found.cost)?, matrix(py, &closed)?])
}

/// Weights of x, of lagging and of past commands, which cost nothing any more; a matrix that does not fit x is left as it is, to be refused.
fn padded(q: DMatrix<f64>, (states, size): (usize, usize)) -> DMatrix<f64> {
    if q.shape() == (states, states) { q.resize(size, size, 0.0) } else { q }
}
