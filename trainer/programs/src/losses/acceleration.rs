use super::{Block, Derivatives, Loss, clear, mended};
use crate::dynamics::{Accelerations, Failures, Rods, contracted};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// v̇(q, v, u) − a.
pub struct AccelerationLoss {
    n: usize,
    accelerations: Accelerations,
    /// For one direction, and for n.
    pulls: [(Program, Workspace); 2],
}

impl AccelerationLoss {
    /// That of a system without constraints.
    pub fn new(system: &System) -> Self {
        Self::with_rods(system, Rods::default(), true)
    }

    /// That of a system on rods. `definite`: whether M must be positive along what they allow.
    pub fn with_rods(system: &System, rods: Rods, definite: bool) -> Self {
        let n = system.n();
        let pulls = [1, n].map(|directions| system.residual(directions).with_workspace());
        Self { n, accelerations: Accelerations::with_rods(system, rods, definite), pulls }
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

    /// ∂v̇ = Π ∂(F − d/dt L_v) with v̇ held on the right, Π = M⁻¹ but for what the rods take out.
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
        let failures = self.accelerations.evaluate(weights, [q, v, tau], &mut a, asked);
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
        let ((program, workspace), rows) = match derivatives {
            Derivatives::None => return failures,
            Derivatives::Jacobian(rows) => {
                inputs.extend(compliance.chunks_exact(n));
                (&mut self.pulls[1], rows)
            }
            Derivatives::Gradient(row) => {
                sum = contracted(residual, &compliance, n);
                inputs.push(&sum);
                (&mut self.pulls[0], std::slice::from_mut(row))
            }
        };
        program.run(weights, &inputs, workspace, rows);
        failures
    }
}
