use super::{Block, Derivatives, Loss, clear, mended};
use crate::dynamics::Failures;
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::sparsity::Pattern;
use crate::system::System;

/// Torque that a motion needs according to the model, minus the logged torque: M v̇ + L_vq v − L_q − Q(q, v, τ) − τ at
/// logged (q, v, v̇) and τ, with a separate unit for each coordinate.
///
/// Nothing is divided by the inertia, so noise of v̇ is not amplified. But this noise is multiplied by the inertia, so
/// the estimated inertia is too small. Source: Lutter, Ritter and Peters, "Deep Lagrangian Networks", ICLR 2019.
pub struct TorqueLoss {
    /// Reciprocal of the unit of every coordinate's torque, 1/(N m) or 1/N.
    per_unit: Vec<f64>,
    pattern: Pattern,
    /// Equation of motion with the derivatives of its residual, along one direction and along n.
    motions: [(Program, Workspace); 2],
}

impl TorqueLoss {
    /// Creates the loss of a system without constraints, in N m or N.
    pub fn new(system: &System) -> Self {
        let n = system.n();
        let [one, all] = [1, n].map(|directions| system.equation_of_motion_with_residual(directions));
        let pattern = one.1;
        Self { per_unit: vec![1.0; n], pattern, motions: [one.0, all.0].map(Program::with_workspace) }
    }

    /// Sets these units, N m or N, one per coordinate; they can give light joints the same weight as heavy ones.
    #[must_use]
    pub fn in_units(mut self, units: &[f64]) -> Self {
        self.per_unit.iter_mut().zip(units).for_each(|(per_unit, unit)| *per_unit = unit.recip());
        self
    }

    /// Writes M a − (L_q − L_vq v + Q + τ).
    fn unbalanced(&self, workspace: &Workspace, a: &[Row], residual: &mut [Row]) {
        for (i, (residual, right)) in residual.iter_mut().zip(workspace.output(0)).enumerate() {
            *residual = right.zip(right, |right, _| -right);
            for (j, a) in a.iter().enumerate() {
                if let Some(direction) = self.pattern.direction(i, j) {
                    residual.add_product(&workspace.output(1 + direction)[i], a);
                }
            }
            *residual = scaled(self.per_unit[i], residual);
        }
    }
}

impl Loss for TorqueLoss {
    fn components(&self) -> usize {
        self.per_unit.len()
    }

    fn of_constant_velocity(&self, _: &Block) -> Option<Vec<Row>> {
        None
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        let n = self.per_unit.len();
        let ([q, v, a], [tau, ..]) = (&block.states, &block.controls);
        let which = usize::from(matches!(derivatives, Derivatives::Jacobian(_)));
        let (program, workspace) = &mut self.motions[which];
        program.run_outputs(weights, &[q, v, tau], workspace);
        let mut failures = Failures::default();
        self.unbalanced(&self.motions[which].1, a, residual);
        failures.add_not_finite(residual);
        clear(&failures, residual);
        // The derivative of F − L_vq v − M a has the other sign.
        let (directions, rows): (Vec<Vec<Row>>, &mut [Vec<Row>]) = match derivatives {
            Derivatives::None => return failures,
            Derivatives::Jacobian(rows) => {
                let unit = |k: usize| {
                    (0..n).map(|i| Row::splat(if i == k { -self.per_unit[i] } else { 0.0 })).collect()
                };
                ((0..n).map(unit).collect(), rows)
            }
            Derivatives::Gradient(row) => {
                let direction = self.per_unit.iter().zip(residual.iter()).map(|(c, r)| scaled(-c, r));
                (vec![direction.collect()], std::slice::from_mut(row))
            }
        };
        if failures.all() {
            return failures;
        }
        let at = [q, v, tau, a].map(|rows| mended(&failures, rows));
        let directions: Vec<Vec<Row>> = directions
            .into_iter()
            .map(|mut y| {
                clear(&failures, &mut y);
                y
            })
            .collect();
        let inputs: Vec<&[Row]> = at.iter().chain(&directions).map(Vec::as_slice).collect();
        let (program, workspace) = &mut self.motions[which];
        program.run(weights, &inputs, workspace, rows);
        failures
    }
}

fn scaled(c: f64, x: &Row) -> Row {
    x.zip(x, |x, _| c * x)
}
