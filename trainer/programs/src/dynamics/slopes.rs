use super::{Accelerations, Failures, times};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Accelerations of a system without constraints and their derivatives with respect to the state, with the workspace to compute them.
#[derive(Clone, Debug)]
pub struct AccelerationSlopes {
    accelerations: Accelerations,
    columns: (Program, Workspace),
    /// Compliance M⁻¹, row by row.
    compliance: Vec<Row>,
}

impl AccelerationSlopes {
    /// Creates the accelerations and derivatives of a system.
    pub fn new(system: &System) -> Self {
        let n = system.n();
        Self {
            accelerations: Accelerations::new(system),
            columns: system.residual_derivatives().with_workspace(),
            compliance: vec![Row::default(); n * n],
        }
    }

    /// Writes v̇(q, v, τ), n rows, and its Jacobian ∂v̇/∂(q, v), column by column: n rows for every coordinate of q and then of v.
    pub fn evaluate(
        &mut self,
        weights: &[f64],
        [q, v, tau]: [&[Row]; 3],
        a: &mut [Row],
        slopes: &mut [Row],
    ) -> Failures {
        let n = a.len();
        let mut failures = self.accelerations.evaluate(weights, [q, v, tau], a, Some(&mut self.compliance));
        let (program, workspace) = &mut self.columns;
        program.run_outputs(weights, &[q, v, tau, a], workspace);
        for (column, slopes) in slopes.chunks_exact_mut(n).enumerate() {
            slopes.copy_from_slice(&times(&self.compliance, workspace.output(column)));
        }
        failures.add_not_finite(slopes);
        failures
    }

    /// Compliance M⁻¹ of the last evaluation, \[n\]\[n\].
    pub fn compliance(&self) -> &[Row] {
        &self.compliance
    }
}
