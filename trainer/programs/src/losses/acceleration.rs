use super::{Block, Derivatives, Loss, clear, mended};
use crate::dynamics::{Failures, MotionSolver, Rods, contracted};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::system::System;

/// Loss of accelerations: v̇(q, v, u) − a.
pub struct AccelerationLoss {
    n: usize,
    solver: MotionSolver,
    /// Equation of motion with the gradients of its residual, along one direction and along n directions.
    motions: [(Program, Workspace); 2],
}

impl AccelerationLoss {
    /// Creates the loss for a system without constraints.
    pub fn new(system: &System) -> Self {
        Self::with_rods(system, Rods::default(), true)
    }

    /// Creates the loss for a system with rods. `definite`: whether A M⁻¹Aᵀ must be positive definite.
    pub fn with_rods(system: &System, rods: Rods, definite: bool) -> Self {
        let n = system.n();
        let [one, all] = [1, n].map(|directions| system.equation_of_motion_with_residual(directions));
        let (solver, motions) = (MotionSolver::new(one.1, rods, definite), [one.0, all.0]);
        Self { n, solver, motions: motions.map(Program::with_workspace) }
    }
}

impl Loss for AccelerationLoss {
    fn components(&self) -> usize {
        self.n
    }

    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>> {
        let [.., logged] = &block.states;
        Some(logged.iter().map(|a| a.zip(a, |a, _| -a)).collect())
    }

    /// Evaluates by ∂v̇ = Π ∂(F − d/dt L_v), with v̇ held fixed on the right; Π is M⁻¹ without the directions of the
    /// rods.
    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        let n = self.n;
        let ([q, v, logged], [tau, ..]) = (&block.states, &block.controls);
        let (mut a, mut compliance) = (vec![Row::default(); n], Vec::new());
        if !matches!(derivatives, Derivatives::None) {
            compliance.resize(n * n, Row::default());
        }
        let asked = if compliance.is_empty() { None } else { Some(&mut compliance[..]) };
        let several = matches!(derivatives, Derivatives::Jacobian(_));
        let (program, workspace) = &mut self.motions[usize::from(several)];
        program.run_outputs(weights, &[q, v, tau], workspace);
        let failures = self.solver.solve(workspace, [q, v], &mut a, asked);
        for ((residual, a), logged) in residual.iter_mut().zip(&a).zip(logged) {
            *residual = a.zip(logged, |a, logged| a - logged);
        }
        [&mut *residual, &mut compliance].into_iter().for_each(|rows| clear(&failures, rows));
        if failures.all() {
            return failures;
        }
        let at = [q, v, tau, &a].map(|rows| mended(&failures, rows));
        let mut inputs: Vec<&[Row]> = at.iter().map(Vec::as_slice).collect();
        let sum;
        let rows = match derivatives {
            Derivatives::None => return failures,
            Derivatives::Jacobian(rows) => {
                inputs.extend(compliance.chunks_exact(n));
                rows
            }
            Derivatives::Gradient(row) => {
                sum = contracted(residual, &compliance, n);
                inputs.push(&sum);
                std::slice::from_mut(row)
            }
        };
        if failures.any(WIDTH) {
            program.run_outputs(weights, &inputs, workspace);
        }
        program.run_rows(weights, &inputs, workspace, rows);
        failures
    }
}
