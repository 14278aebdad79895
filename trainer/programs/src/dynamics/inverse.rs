use super::{Failures, Lu};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};
use crate::sparsity::Pattern;
use crate::system::System;

/// Maximum number of Newton updates if friction depends on the control.
const MOST_UPDATES: usize = 16;
/// Residual at which the equation counts as solved, relative to the size of the torques.
const SOLVED: f64 = 1e-14;

/// Inverse dynamics: the control τ for an acceleration, τ + Q(q, v, τ) = M v̇ − L_q + L_vq v.
///
/// If Q depends on τ, the equation is implicit; it is solved by Newton's method with ∂Q/∂τ, starting at τ = 0.
#[derive(Clone, Debug)]
pub struct InverseDynamics {
    pattern: Pattern,
    motion: (Program, Workspace),
    load: Option<(Program, Workspace)>,
    lu: Lu,
    left: Vec<Row>,
}

impl InverseDynamics {
    /// Creates the inverse dynamics of a system; rods are ignored.
    pub fn new(system: &System) -> Self {
        let with_workspace = |program: Program| (program.clone(), program.workspace());
        let (motion, pattern) = system.equation_of_motion();
        let left = vec![Row::default(); system.n()];
        let load = system.load_derivatives().map(with_workspace);
        Self { pattern, motion: with_workspace(motion), load, lu: Lu::default(), left }
    }

    /// Writes τ(q, v, v̇), n rows, N or N m. Samples that cannot be solved are NaN.
    pub fn evaluate(&mut self, weights: &[f64], [q, v, a]: [&[Row]; 3], tau: &mut [Row]) -> Failures {
        tau.fill(Row::default());
        let mut failures = Failures::default();
        self.run(weights, [q, v, a], tau);
        if self.load.is_none() {
            tau.copy_from_slice(&self.left);
        } else {
            for _ in 0..MOST_UPDATES {
                let size = tau.iter().chain(&self.left).fold(Row::default(), |most, x| larger(&most, x));
                self.update(weights, [q, v], tau, &mut failures);
                self.run(weights, [q, v, a], tau);
                if self.is_solved(&size) {
                    break;
                }
            }
        }
        failures.add_not_finite(tau);
        for sample in (0..WIDTH).filter(|sample| failures.0[*sample]) {
            tau.iter_mut().for_each(|row| row.0[sample] = f64::NAN);
        }
        failures
    }

    /// Computes the residual M v̇ − (L_q − L_vq v + Q + τ).
    fn run(&mut self, weights: &[f64], [q, v, a]: [&[Row]; 3], tau: &[Row]) {
        let (program, workspace) = &mut self.motion;
        program.run_outputs(weights, &[q, v, tau], workspace);
        for (i, (left, right)) in self.left.iter_mut().zip(workspace.output(0)).enumerate() {
            *left = Row::default();
            left.add_scaled(-1.0, right);
            for (j, a) in a.iter().enumerate() {
                if let Some(direction) = self.pattern.direction(i, j) {
                    left.add_product(&workspace.output(1 + direction)[i], a);
                }
            }
        }
    }

    /// Updates τ ← τ + (1 + ∂Q/∂τ)⁻¹ residual, sample by sample.
    fn update(&mut self, weights: &[f64], [q, v]: [&[Row]; 2], tau: &mut [Row], failures: &mut Failures) {
        let Some((program, workspace)) = &mut self.load else { return };
        program.run_outputs(weights, &[q, v, tau], workspace);
        for sample in 0..WIDTH {
            let entry = |i: usize, j: usize| workspace.output(j)[i].0[sample] + f64::from(u8::from(i == j));
            failures.0[sample] |= !self.lu.factor(tau.len(), entry);
            let change = self.lu.solve(|i| self.left[i].0[sample]);
            tau.iter_mut().zip(change).for_each(|(tau, change)| tau.0[sample] += change);
        }
    }

    fn is_solved(&self, size: &Row) -> bool {
        let small = |left: &Row| left.0.iter().zip(size.0).all(|(left, size)| left.abs() <= SOLVED * size);
        self.left.iter().all(small)
    }
}

/// The larger magnitude in every sample.
fn larger(a: &Row, b: &Row) -> Row {
    a.zip(b, |a, b| a.abs().max(b.abs()))
}
