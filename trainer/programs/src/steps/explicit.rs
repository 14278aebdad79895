use super::tangents::{ControlTangent, Tangents, add_products};
use super::{RungeKutta, State, sum};
use crate::dynamics::{Failures, MotionSolver, Rods};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Explicit Runge–Kutta steps of a system without constraints, as [`NextStateLoss`](crate::losses::NextStateLoss) has them, with
/// their derivatives carried along.
///
/// With v̇ = M⁻¹(F − L_vq v + τ) a number moves the acceleration of a stage by δv̇ = M⁻¹(∂_q R δq + ∂_v R δv + ∂_τ(Q + τ) δτ + ∂_θ R),
/// R = F − L_vq v − M v̇ at constant v̇.
pub struct ExplicitSteps {
    n: usize,
    h: f64,
    method: RungeKutta,
    solver: MotionSolver,
    /// The equation of motion, with the gradient of its residual along n directions.
    motion: (Program, Workspace),
    columns: (Program, Workspace),
}

/// A stage's rate of change, and how it moves with every number.
struct Stage {
    rate: State,
    tangents: Vec<Vec<Row>>,
}

impl ExplicitSteps {
    /// Those of a system, of h, s.
    pub fn new(system: &System, h: f64, method: RungeKutta) -> Self {
        let (motion, pattern) = system.equation_of_motion_with_residual(system.n());
        Self {
            n: system.n(),
            h,
            method,
            solver: MotionSolver::new(pattern, Rods::default(), true),
            motion: motion.with_workspace(),
            columns: system.residual_derivatives_with_control().with_workspace(),
        }
    }

    /// One step on, under controls τ at its start and end, linear between; with `tangents` also how the new state moves, of which
    /// numbers of the control each moves as `controls` says. A sample that cannot be computed is no number from here on.
    ///
    /// # Panics
    /// Where the numbers of coordinates or of controls do not fit.
    pub fn step(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tau: [&[Row]; 2],
        tangents: Option<(&mut Tangents, &[ControlTangent])>,
    ) -> Failures {
        let (mut failures, mut stages) = (Failures::default(), Vec::<Stage>::new());
        let (shares, h) = (self.method.stages(), self.h);
        let (mut carried, controls) = match tangents {
            Some((tangents, controls)) => (Some(tangents), controls),
            None => (None, &[][..]),
        };
        for (shares, time) in shares.iter().zip(self.method.times()) {
            let before = || shares.iter().copied().zip(&stages);
            let at = sum(state, h, before().map(|(share, stage)| (share, &stage.rate)));
            let tau: Vec<Row> =
                tau[0].iter().zip(tau[1]).map(|(a, b)| a.zip(b, |a, b| a + time * (b - a))).collect();
            let own = carried.as_deref().map(|tangents| {
                let mut own = tangents.clone();
                before().for_each(|(share, stage)| own.add(h * share, &stage.tangents));
                own
            });
            let (stage, failed) = self.stage(weights, (at, &tau), own.as_ref(), (controls, time));
            failures = failures.or(failed);
            stages.push(stage);
        }
        let end = || self.method.end().iter().copied().zip(&stages);
        *state = sum(state, h, end().map(|(share, stage)| (share, &stage.rate)));
        if let Some(tangents) = &mut carried {
            end().for_each(|(share, stage)| tangents.add(h * share, &stage.tangents));
        }
        failures.add_not_finite(state);
        failures
    }

    /// (v, v̇) at a state, and how it moves.
    fn stage(
        &mut self,
        weights: &[f64],
        (state, tau): (State, &[Row]),
        tangents: Option<&Tangents>,
        controls: (&[ControlTangent], f64),
    ) -> (Stage, Failures) {
        let n = self.n;
        let (q, v) = state.split_at(n);
        let mut a = vec![Row::default(); n];
        let (program, workspace) = &mut self.motion;
        program.run_outputs(weights, &[q, v, tau], workspace);
        let Some(tangents) = tangents else {
            let failures = self.solver.solve(workspace, [q, v], &mut a, None);
            return (Stage { rate: [v, &a].concat(), tangents: Vec::new() }, failures);
        };
        let mut compliance = vec![Row::default(); n * n];
        let failures = self.solver.solve(workspace, [q, v], &mut a, Some(&mut compliance));
        let mut rows = vec![vec![Row::default(); tangents.columns()]; n];
        if tangents.weights() > 0 {
            let mut inputs = vec![q, v, tau, &a];
            inputs.extend(compliance.chunks_exact(n));
            program.run_rows(weights, &inputs, workspace, &mut rows);
        }
        self.add_moved(weights, [q, v, tau, &a], (&compliance, tangents), controls, &mut rows);
        let mut all = tangents.rows()[n..].to_vec();
        all.extend(rows);
        (Stage { rate: [v, &a].concat(), tangents: all }, failures)
    }

    /// Adds M⁻¹(∂_q R δq + ∂_v R δv + ∂_τ(Q + τ) δτ).
    fn add_moved(
        &mut self,
        weights: &[f64],
        at: [&[Row]; 4],
        (compliance, tangents): (&[Row], &Tangents),
        (controls, time): (&[ControlTangent], f64),
        rows: &mut [Vec<Row>],
    ) {
        let n = self.n;
        let (program, workspace) = &mut self.columns;
        program.run_outputs(weights, &at, workspace);
        for (i, (row, inverse)) in rows.iter_mut().zip(compliance.chunks_exact(n)).enumerate() {
            let along = |column: usize| {
                let mut sum = Row::default();
                workspace
                    .output(column)
                    .iter()
                    .zip(inverse)
                    .for_each(|(x, inverse)| sum.add_product(x, inverse));
                sum
            };
            for (j, moved) in tangents.rows().iter().enumerate() {
                add_products(row, &along(j), moved);
            }
            for control in controls {
                let k = control.coordinate;
                let mut slope = along(2 * n + k);
                slope.add_scaled(1.0, &compliance[i * n + k]);
                let change = control.change[0].zip(&control.change[1], |a, b| a + time * (b - a));
                row[tangents.weights() + control.number].add_product(&slope, &change);
            }
        }
    }
}
