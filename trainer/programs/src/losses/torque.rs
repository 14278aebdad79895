use super::{Block, Derivatives, Loss, clear, mended};
use crate::dynamics::Failures;
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::sparsity::Pattern;
use crate::system::System;

/// The torque that a motion takes by the model, less the logged one: M v̇ + L_vq v − L_q − Q(q, v, τ) − τ at logged (q, v, v̇) and τ.
///
/// It divides by no inertia, so noise of v̇ is not amplified; but it stands beside the inertia, which it makes too small. Source:
/// Lutter, Ritter and Peters, "Deep Lagrangian Networks", ICLR 2019.
pub struct TorqueLoss {
    n: usize,
    pattern: Pattern,
    /// The equation of motion with the derivatives of its residual along one direction, and along n.
    motions: [(Program, Workspace); 2],
}

impl TorqueLoss {
    /// That of a system without constraints.
    pub fn new(system: &System) -> Self {
        let n = system.n();
        let [one, all] = [1, n].map(|directions| system.equation_of_motion_with_residual(directions));
        let pattern = one.1;
        Self { n, pattern, motions: [one.0, all.0].map(Program::with_workspace) }
    }

    /// M a − (L_q − L_vq v + Q + τ).
    fn unbalanced(&self, workspace: &Workspace, a: &[Row], residual: &mut [Row]) {
        for (i, (residual, right)) in residual.iter_mut().zip(workspace.output(0)).enumerate() {
            *residual = right.zip(right, |right, _| -right);
            for (j, a) in a.iter().enumerate() {
                if let Some(direction) = self.pattern.direction(i, j) {
                    residual.add_product(&workspace.output(1 + direction)[i], a);
                }
            }
        }
    }
}

impl Loss for TorqueLoss {
    fn components(&self) -> usize {
        self.n
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
        let n = self.n;
        let ([q, v, a], [tau, ..]) = (&block.states, &block.controls);
        let which = usize::from(matches!(derivatives, Derivatives::Jacobian(_)));
        let (program, workspace) = &mut self.motions[which];
        program.run_outputs(weights, &[q, v, tau], workspace);
        let mut failures = Failures::default();
        self.unbalanced(&self.motions[which].1, a, residual);
        failures.add_not_finite(residual);
        clear(&failures, residual);
        // The derivative of F − L_vq v − M a has the other sign.
        let minus = |x: &Row| x.zip(x, |x, _| -x);
        let (directions, rows): (Vec<Vec<Row>>, &mut [Vec<Row>]) = match derivatives {
            Derivatives::None => return failures,
            Derivatives::Jacobian(rows) => {
                let unit = |k: usize| (0..n).map(|i| Row::splat(-f64::from(u8::from(i == k)))).collect();
                ((0..n).map(unit).collect(), rows)
            }
            Derivatives::Gradient(row) => {
                (vec![residual.iter().map(minus).collect()], std::slice::from_mut(row))
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
