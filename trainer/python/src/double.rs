//! Evaluation of states side by side in double precision, for models of any size.

use crate::arguments;
use crate::arm::Arm;
use crate::arrays::Table;
use crate::blocks::fill;
use crate::single::Quantity;
use leastaction_core::discrete;
use leastaction_core::model::ModelError;
use leastaction_models::accelerations::Forced;
use leastaction_models::parallel::Pool;
use leastaction_models::{Model, NEWTON};
use leastaction_programs::dynamics::{Accelerations, Del, InverseDynamics, Order};
use leastaction_programs::{Program, Row, System, WIDTH, Workspace};
use pyo3::PyResult;
use std::convert::Infallible;

/// Evaluator of a block of states.
enum Solver {
    Energies(Box<(Program, Workspace)>),
    Accelerations(Box<Accelerations>),
    InverseDynamics(Box<InverseDynamics>),
}

impl Solver {
    fn new(system: &System, quantity: Quantity) -> Self {
        match quantity {
            Quantity::Energies => {
                let program = system.energies();
                let workspace = program.workspace();
                Self::Energies(Box::new((program, workspace)))
            }
            Quantity::Acceleration | Quantity::MassMatrix => {
                Self::Accelerations(Box::new(Accelerations::new(system)))
            }
            Quantity::InverseDynamics => Self::InverseDynamics(Box::new(InverseDynamics::new(system))),
        }
    }

    /// The results for a block of states, one row per number.
    fn run(&mut self, weights: &[f64], inputs: &[Vec<Row>], quantity: Quantity) -> Vec<Row> {
        let n = inputs.first().map_or(0, Vec::len);
        let zero = vec![Row::default(); n];
        let input = |which: usize| inputs.get(which).unwrap_or(&zero).as_slice();
        let states = [input(0), input(1), input(2)];
        let mut to = vec![Row::default(); n];
        match self {
            Self::Energies(of) => {
                let (program, workspace) = &mut **of;
                program.run_outputs(weights, &states, workspace);
                vec![workspace.output(0)[0], workspace.output(1)[0]]
            }
            Self::InverseDynamics(of) => {
                let _not_numbers = of.evaluate(weights, states, &mut to);
                to
            }
            Self::Accelerations(of) => {
                let _not_numbers = of.evaluate(weights, states, &mut to, None);
                match quantity {
                    Quantity::MassMatrix => (0..n * n).map(|k| of.mass(k / n, k % n)).collect(),
                    _ => to,
                }
            }
        }
    }
}

/// Computes a quantity of every state; values that do not exist are NaN.
///
/// # Errors
/// [`ModelError`] if the shape is inconsistent, or if the weights do not fit it.
pub fn evaluate(
    model: &Model,
    quantity: Quantity,
    (inputs, count): (&[Table<f64>], usize),
) -> Result<Vec<f64>, ModelError> {
    let Model { architecture, weights, .. } = model;
    let width = quantity.width(architecture.n());
    let mut numbers = vec![0.0; count * width];
    if quantity == Quantity::Acceleration && architecture.family.graph().is_some() {
        model.with_forced(|forced| graph(forced, inputs, (&mut numbers, width)))?;
        return Ok(numbers);
    }
    if let Some(arm) = Arm::new(model, quantity)? {
        blocks((inputs, architecture.n()), (&mut numbers, width), |lanes| arm.run(lanes, quantity));
        return Ok(numbers);
    }
    let system = model.system()?;
    let pool = Pool::new(move || Solver::new(&system, quantity));
    let run = |lanes: &[Vec<Row>]| pool.with(|solver| solver.run(weights, lanes, quantity));
    blocks((inputs, architecture.n()), (&mut numbers, width), run);
    Ok(numbers)
}

/// Writes what `run` computes for every block of states.
fn blocks(
    (inputs, n): (&[Table<f64>], usize),
    (numbers, width): (&mut [f64], usize),
    run: impl Fn(&[Vec<Row>]) -> Vec<Row> + Sync,
) {
    let work = |first: usize, rows: &mut [f64]| {
        let lanes: Vec<Vec<Row>> = inputs.iter().map(|table| side_by_side(table, first, n)).collect();
        let found = run(&lanes);
        for (lane, row) in rows.chunks_exact_mut(width).enumerate() {
            row.iter_mut().zip(&found).for_each(|(to, of)| *to = of.0[lane]);
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = fill((numbers, width, WIDTH), work);
}

/// Accelerations of a graph with its rods, state by state, each in linear time.
fn graph(forced: &Forced, inputs: &[Table<f64>], (numbers, width): (&mut [f64], usize)) {
    let work = |index: usize, to: &mut [f64]| {
        let row = |which: usize| inputs.get(which).map_or(&[][..], |table| table.row(index));
        if forced(row(0), row(1), row(2), to).is_none() {
            to.fill(f64::NAN);
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = fill((numbers, width, 1), work);
}

/// The order of a step, from its number 2 or 4.
pub fn order(number: u8) -> PyResult<Order> {
    Ok(match arguments::order(number)? {
        discrete::Order::Two => Order::Two,
        discrete::Order::Four => Order::Four,
    })
}

/// Refuses a model with rods, of which `what` does not exist in double precision.
///
/// # Errors
/// [`ModelError`] for rods, or if the shape is inconsistent.
pub fn without_rods(model: &Model, what: &'static str) -> Result<(), ModelError> {
    match model.architecture.rods()?.count() {
        0 => Ok(()),
        found => Err(ModelError::Shape { what, found, compiled: 0 }),
    }
}

/// States from `first` on, side by side; lanes beyond the last state repeat it.
pub fn side_by_side(table: &Table<f64>, first: usize, n: usize) -> Vec<Row> {
    let (last, mut rows) = (table.count.saturating_sub(1), vec![Row::default(); n]);
    for lane in 0..WIDTH {
        let numbers = table.row((first + lane).min(last));
        rows.iter_mut().zip(numbers).for_each(|(row, x)| row.0[lane] = *x);
    }
    rows
}

/// Start of motions.
pub enum Start {
    /// Positions and velocities q, v.
    State([Table<f64>; 2]),
    /// Two positions q₀, q₁.
    Positions([Table<f64>; 2]),
}

/// Motions by the discrete Euler–Lagrange equation.
pub struct Rollout {
    /// Number of motions.
    pub count: usize,
    /// Number of steps per motion.
    pub steps: usize,
    /// Step (s) and order.
    pub step: (f64, Order),
    /// Start of the motions.
    pub start: Start,
    /// Forces τ at the start and the end of every step, \[motions\]\[steps\]\[n\]; the forces of a single motion apply
    /// to all.
    pub tau: [Table<f64>; 2],
}

impl Rollout {
    /// Positions and momenta at every sample, \[motions\]\[steps + 1\]\[2n\]; NaN from the first step that cannot be
    /// solved. If a motion starts from two positions, the momentum at the first position is NaN.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent or has rods.
    pub fn run(&self, model: &Model) -> Result<Vec<f64>, ModelError> {
        let Model { architecture, weights, .. } = model;
        without_rods(model, "rods of a model that is stepped in double precision")?;
        let (system, (h, order)) = (model.system()?, self.step);
        let pool = Pool::new(move || Del::new(&system, h, order, NEWTON));
        let width = (self.steps + 1) * 2 * architecture.n();
        let mut numbers = vec![f64::NAN; self.count * width];
        let work = |first: usize, motions: &mut [f64]| {
            pool.with(|del| self.side_by_side(del, weights, (first, architecture.n()), (motions, width)));
            Ok::<(), Infallible>(())
        };
        let Ok(()) = fill((&mut numbers, width, WIDTH), work);
        Ok(numbers)
    }

    fn side_by_side(
        &self,
        del: &mut Del,
        weights: &[f64],
        (first, n): (usize, usize),
        (motions, width): (&mut [f64], usize),
    ) {
        let tau = |k: usize| -> [Vec<Row>; 2] {
            self.tau.each_ref().map(|tau| {
                let row =
                    |motion: usize| tau.row(motion.min(self.count - 1)).get(k * n..).unwrap_or_default();
                (0..n)
                    .map(|i| {
                        Row(std::array::from_fn(|lane| row(first + lane).get(i).copied().unwrap_or(0.0)))
                    })
                    .collect()
            })
        };
        let mut write = |k: usize, (q, p): (&Vec<Row>, &Vec<Row>)| {
            for (lane, motion) in motions.chunks_exact_mut(width).enumerate() {
                let place = &mut motion[2 * n * k..][..2 * n];
                place.iter_mut().zip(q.iter().chain(p)).for_each(|(to, of)| *to = of.0[lane]);
            }
        };
        let (mut state, begin) = match &self.start {
            Start::State(tables) => {
                let [q, v] = tables.each_ref().map(|table| side_by_side(table, first, n));
                (del.start_at(weights, &q, &v), 0)
            }
            Start::Positions(tables) => {
                let [q0, q1] = tables.each_ref().map(|table| side_by_side(table, first, n));
                let unknown = vec![Row::splat(f64::NAN); n];
                write(0, (&q0, &unknown));
                (del.start(weights, [&q0, &q1], tau(0).each_ref().map(Vec::as_slice)), 1)
            }
        };
        write(begin, (&state.q, &state.p));
        for k in begin..self.steps {
            del.step(weights, &mut state, tau(k).each_ref().map(Vec::as_slice));
            write(k + 1, (&state.q, &state.p));
        }
    }
}
