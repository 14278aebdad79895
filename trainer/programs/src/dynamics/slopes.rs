use super::{Accelerations, Failures, times};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Accelerations of a system without constraints and their derivatives with respect to the state, with the workspace to compute them.
#[derive(Clone, Debug)]
pub struct AccelerationSlopes {
    accelerations: Accelerations,
    columns: (Program, Workspace),
    /// Derivative ∂Q/∂τ, if a force depends on the control.
    load: Option<(Program, Workspace)>,
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
            load: system.load_derivatives().map(Program::with_workspace),
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

    /// Jacobian ∂v̇/∂τ = M⁻¹(1 + ∂Q/∂τ) at the state of the last evaluation, column by column: n rows for every coordinate.
    pub fn of_control(&mut self, weights: &[f64], at: [&[Row]; 3]) -> Vec<Row> {
        let n = at[0].len();
        if let Some((program, workspace)) = &mut self.load {
            program.run_outputs(weights, &at, workspace);
        }
        let force = |j: usize, i: usize| {
            let mut own = Row::splat(if i == j { 1.0 } else { 0.0 });
            self.load.iter().for_each(|(_, load)| own.add_scaled(1.0, &load.output(j)[i]));
            own
        };
        (0..n)
            .flat_map(|j| times(&self.compliance, &(0..n).map(|i| force(j, i)).collect::<Vec<_>>()))
            .collect()
    }
}
