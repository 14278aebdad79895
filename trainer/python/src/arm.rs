//! Evaluation of arms side by side in double precision: bodies by the recursions of core, forces beside them by a program.

use crate::single::Quantity;
use leastaction_core::model::{Laws, ModelError};
use leastaction_models::parallel::Pool;
use leastaction_models::{ArmDynamics, Model};
use leastaction_programs::{Program, Row, WIDTH, Workspace};

/// An arm of a size that core is compiled for.
pub struct Arm<'m> {
    bodies: Box<dyn ArmDynamics + 'm>,
    weights: &'m [f64],
    /// Forces Q(q, v, τ) beside the bodies, if there are any.
    forces: Option<Pool<(Program, Workspace)>>,
}

impl<'m> Arm<'m> {
    /// Creates the evaluator of a quantity; `None` for a model that is no such arm, or whose friction depends on the force that inverse
    /// dynamics looks for.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent, or if the weights do not fit it.
    pub fn new(model: &'m Model, quantity: Quantity) -> Result<Option<Self>, ModelError> {
        let Some(bodies) = model.arm_dynamics() else { return Ok(None) };
        let weights = &*model.weights;
        let moves = matches!(quantity, Quantity::Acceleration | Quantity::InverseDynamics);
        if !moves || model.architecture.laws() == Laws::NONE {
            return Ok(Some(Self { bodies, weights, forces: None }));
        }
        let system = model.system()?;
        if quantity == Quantity::InverseDynamics && system.load_derivatives().is_some() {
            return Ok(None);
        }
        let program = system.force();
        let forces = Some(Pool::new(move || (program.clone(), program.workspace())));
        Ok(Some(Self { bodies, weights, forces }))
    }

    /// Computes the results for a block of states, one row per number.
    pub fn run(&self, inputs: &[Vec<Row>], quantity: Quantity) -> Vec<Row> {
        let n = inputs.first().map_or(0, Vec::len);
        let zero = vec![Row::default(); n];
        let input = |which: usize| inputs.get(which).unwrap_or(&zero).as_slice();
        let [q, v, x] = [input(0), input(1), input(2)];
        let mut to = vec![Row::default(); quantity.width(n)];
        match quantity {
            Quantity::Energies => to.copy_from_slice(&self.bodies.energies([q, v])),
            Quantity::MassMatrix => self.bodies.mass_matrix(q, &mut to),
            Quantity::InverseDynamics => {
                self.bodies.inverse_dynamics([q, v, x], &mut to);
                self.add_forces([q, v, &zero], -1.0, &mut to);
                spoil(&mut to);
            }
            Quantity::Acceleration => {
                let mut sum = x.to_vec();
                self.add_forces([q, v, x], 1.0, &mut sum);
                self.bodies.acceleration([q, v, &sum], &mut to);
                spoil(&mut to);
            }
        }
        to
    }

    fn add_forces(&self, at: [&[Row]; 3], sign: f64, to: &mut [Row]) {
        let Some(forces) = &self.forces else { return };
        forces.with(|(program, workspace)| {
            program.run_outputs(self.weights, &at, workspace);
            for (to, force) in to.iter_mut().zip(workspace.output(0)) {
                *to = Row(std::array::from_fn(|lane| to.0[lane] + sign * force.0[lane]));
            }
        });
    }
}

/// Makes all numbers of a state NaN if one of them does not exist.
pub fn spoil(rows: &mut [Row]) {
    for lane in 0..WIDTH {
        if rows.iter().any(|row| !row.0[lane].is_finite()) {
            rows.iter_mut().for_each(|row| row.0[lane] = f64::NAN);
        }
    }
}
