//! Exact derivatives of accelerations and of steps with respect to state and force, for states side by side.

use crate::arguments::inputs;
use crate::arm::spoil;
use crate::arrays::{Table, tables};
use crate::blocks::fill;
use crate::double::{order, side_by_side, without_rods};
use crate::errors::{Kind, input};
use crate::model::Model;
use crate::single::Quantity;
use leastaction_core::model::{Laws, ModelError};
use leastaction_models as models;
use leastaction_models::ArmDynamics;
use leastaction_models::parallel::Pool;
use leastaction_programs::dynamics::{AccelerationSlopes, Failures, Order};
use leastaction_programs::steps::{ControlTangent, State, Steps, Tangents, VariationalSteps};
use leastaction_programs::{Row, System, WIDTH};
use numpy::{PyArray3, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use std::convert::Infallible;

/// Columns of the derivatives of a block of states, one after the other: one for every number of q, v and u.
type Columns = Vec<Row>;

/// Evaluator of a block of states.
enum Slopes {
    Acceleration(Box<AccelerationSlopes>),
    Step(Box<VariationalSteps>),
}

impl Slopes {
    fn new(system: &System, step: Option<(f64, Order)>) -> Self {
        match step {
            None => Self::Acceleration(Box::new(AccelerationSlopes::new(system))),
            Some((h, order)) => {
                Self::Step(Box::new(VariationalSteps::new(system, h, order).with_learned(Vec::new())))
            }
        }
    }

    /// The columns for a block of states; those of a state that cannot be computed are NaN.
    fn run(&mut self, weights: &[f64], at: [&[Row]; 3]) -> Columns {
        let (mut columns, failures) = match self {
            Self::Acceleration(of) => acceleration(of, weights, at),
            Self::Step(of) => step(of, weights, at),
        };
        for lane in (0..WIDTH).filter(|lane| failures.0[*lane]) {
            columns.iter_mut().for_each(|row| row.0[lane] = f64::NAN);
        }
        columns
    }
}

fn acceleration(of: &mut AccelerationSlopes, weights: &[f64], at: [&[Row]; 3]) -> (Columns, Failures) {
    let n = at[0].len();
    let (mut a, mut slopes) = (vec![Row::default(); n], vec![Row::default(); 2 * n * n]);
    let failures = of.evaluate(weights, at, &mut a, &mut slopes);
    slopes.extend(of.of_control(weights, at));
    (slopes, failures)
}

fn step(of: &mut VariationalSteps, weights: &[f64], [q, v, u]: [&[Row]; 3]) -> (Columns, Failures) {
    let n = q.len();
    let held = |k: usize| ControlTangent { number: k, coordinate: k, change: [Row::splat(1.0); 2] };
    let controls: Vec<ControlTangent> = (0..n).map(held).collect();
    let mut state: State = [q, v].concat();
    let mut tangents = Tangents::at_start(n, 0, n);
    of.begin(weights, &mut state, Some(&mut tangents));
    let failed = of.step(weights, &mut state, [u, u], Some((&mut tangents, &controls)));
    let failures = failed.or(of.finish(weights, &mut state, Some(&mut tangents)));
    let mut columns: Columns = tangents.each().flatten().copied().collect();
    // Columns of controls come first among the tangents.
    columns.rotate_left(n * 2 * n);
    (columns, failures)
}

/// Derivatives of all states, \[states\]\[n or 2n\]\[3n\]; NaN at a state without derivatives.
fn of_states(
    model: &models::Model,
    step: Option<(f64, Order)>,
    (at, count): (&[Table<f64>], usize),
) -> Result<Vec<f64>, ModelError> {
    without_rods(model, "rods of a model that is differentiated")?;
    let n = model.architecture.n();
    let width = 3 * n * if step.is_some() { 2 * n } else { n };
    let mut numbers = vec![0.0; count * width];
    let has_forces = model.architecture.laws() != Laws::NONE;
    if let Some(arm) = model.arm_dynamics().filter(|_| step.is_none() && !has_forces) {
        write((at, n), (&mut numbers, width), |at| of_arm(&*arm, at));
        return Ok(numbers);
    }
    let system = model.system()?;
    let pool = Pool::new(move || Slopes::new(&system, step));
    write((at, n), (&mut numbers, width), |at| pool.with(|slopes| slopes.run(&model.weights, at)));
    Ok(numbers)
}

/// Columns of an arm without forces beside its bodies.
fn of_arm(arm: &dyn ArmDynamics, at: [&[Row]; 3]) -> Columns {
    let n = at[0].len();
    let mut columns = vec![Row::default(); 3 * n * n];
    arm.acceleration_derivatives(at, &mut columns);
    spoil(&mut columns);
    columns
}

/// Writes the columns that `of` computes for every block of states, row by row.
fn write(
    (at, n): (&[Table<f64>], usize),
    (numbers, width): (&mut [f64], usize),
    of: impl Fn([&[Row]; 3]) -> Columns + Sync,
) {
    let work = |first: usize, to: &mut [f64]| {
        let [q, v, u] = std::array::from_fn(|k| side_by_side(&at[k], first, n));
        let found = of([&q, &v, &u]);
        let height = found.len() / (3 * n);
        for (lane, to) in to.chunks_exact_mut(width).enumerate() {
            for (i, row) in to.chunks_exact_mut(3 * n).enumerate() {
                row.iter_mut().zip(found[i..].iter().step_by(height)).for_each(|(to, of)| *to = of.0[lane]);
            }
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = fill((numbers, width, WIDTH), work);
}

/// Returns ∂v̇/∂(q, v, u), \[states\]\[n\]\[3n\], or with a step (h, order) the derivatives of its end (q, v),
/// \[states\]\[2n\]\[3n\], for a force u that is held; in double precision.
#[pyfunction]
#[pyo3(signature = (model, arrays, step, nan))]
pub fn jacobians<'py>(
    py: Python<'py>,
    model: &Model,
    arrays: Vec<PyReadonlyArrayDyn<'py, f64>>,
    step: Option<(f64, u8)>,
    nan: bool,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let n = model.host().architecture.n();
    let (at, count) = inputs(Quantity::Acceleration, &arrays, n)?;
    let step = step.map(|(h, number)| Ok::<_, PyErr>((positive(h)?, order(number)?))).transpose()?;
    let found = py.detach(|| of_states(model.host(), step, (&at, count))).map_err(input)?;
    let rows = if step.is_some() { 2 * n } else { n };
    let lost = found.iter().position(|x| !x.is_finite()).filter(|_| !nan);
    if let Some(place) = lost {
        let state = place / (3 * n * rows).max(1);
        return Err(Kind::Solve.says(format!("state {state}: the derivatives do not exist here")));
    }
    tables(py, found, [count, rows, 3 * n])
}

fn positive(h: f64) -> PyResult<f64> {
    let fits = h.is_finite() && h > 0.0;
    if fits { Ok(h) } else { Err(input(format!("h is {h}; it must be a finite number above 0"))) }
}
