use super::stages::Stages;
use super::tangents::{ControlTangent, Tangents};
use super::{RungeKutta, State, Steps};
use crate::dynamics::{Failures, MotionSolver, Rods};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;

/// Explicit Runge–Kutta steps of a system without constraints that carry their derivatives along. The methods are those
/// of [`NextStateLoss`](crate::losses::NextStateLoss).
///
/// With v̇ = M⁻¹(F − L_vq v + τ), a change of a parameter changes the acceleration of a stage by δv̇ = M⁻¹(∂_q R δq +
/// ∂_v R δv + ∂_τ(Q + τ) δτ + ∂_θ R), where R = F − L_vq v − M v̇ at constant v̇.
pub struct ExplicitSteps {
    n: usize,
    h: f64,
    method: RungeKutta,
    /// Positions of the weights whose derivatives are carried.
    learned: Vec<usize>,
    solver: MotionSolver,
    /// Equation of motion, with the gradient of its residual along n directions.
    motion: (Program, Workspace),
    columns: (Program, Workspace),
    stages: Stages,
    /// Compliance M⁻¹, row by row.
    compliance: Vec<Row>,
    /// Gradients M⁻¹∂_θ R: for every coordinate, rows of the length of the weight block.
    gradients: Vec<Vec<Row>>,
    /// Derivatives ∂v̇/∂(q, v, τ): a row of 3n for every coordinate.
    slopes: Vec<Row>,
}

impl ExplicitSteps {
    /// Creates the steps of a system with step size h, s, with derivatives with respect to all weights.
    pub fn new(system: &System, h: f64, method: RungeKutta) -> Self {
        let (n, weights) = (system.n(), system.parameters());
        let (motion, pattern) = system.equation_of_motion_with_residual(n);
        Self {
            n,
            h,
            method,
            learned: (0..weights).collect(),
            solver: MotionSolver::new(pattern, Rods::default(), true),
            motion: motion.with_workspace(),
            columns: system.residual_derivatives_with_control().with_workspace(),
            stages: Stages::new(n, method),
            compliance: vec![Row::default(); n * n],
            gradients: vec![vec![Row::default(); weights]; n],
            slopes: vec![Row::default(); 3 * n * n],
        }
    }

    /// Restricts the derivatives to the weights at these positions.
    #[must_use]
    pub fn with_learned(self, learned: Vec<usize>) -> Self {
        Self { learned, ..self }
    }

    /// Computes v̇ of a stage, and M⁻¹ if `differentiate` is set.
    fn accelerate(&mut self, weights: &[f64], differentiate: bool) -> Failures {
        let (program, workspace) = &mut self.motion;
        let ([q, v, tau], a) = self.stages.motion();
        program.run_outputs(weights, &[q, v, tau], workspace);
        self.solver.solve(workspace, [q, v], a, differentiate.then_some(&mut self.compliance[..]))
    }

    /// Computes the derivatives of the stage's v̇ with respect to q, v, τ, and with respect to the weights if any is
    /// learned.
    fn differentiate(&mut self, weights: &[f64], tangents: &Tangents) {
        let n = self.n;
        let [q, v, tau, a] = self.stages.moved();
        if tangents.weights() > 0 {
            self.gradients.iter_mut().for_each(|row| row.fill(Row::default()));
            let (program, workspace) = &mut self.motion;
            let mut inputs = vec![q, v, tau, a];
            inputs.extend(self.compliance.chunks_exact(n));
            program.run_rows(weights, &inputs, workspace, &mut self.gradients);
        }
        let (program, workspace) = &mut self.columns;
        program.run_outputs(weights, &[q, v, tau, a], workspace);
        let rows = self.slopes.chunks_exact_mut(3 * n).zip(self.compliance.chunks_exact(n));
        for (slopes, inverse) in rows {
            for (column, slope) in slopes.iter_mut().enumerate() {
                *slope = Row::default();
                let forces = workspace.output(column).iter().zip(inverse);
                forces.for_each(|(force, inverse)| slope.add_product(force, inverse));
            }
            slopes[2 * n..].iter_mut().zip(inverse).for_each(|(slope, own)| slope.add_scaled(1.0, own));
        }
    }

    /// Computes the derivatives of the stage with respect to every parameter: through its state, and directly.
    fn carry(&mut self, tangents: &Tangents, (controls, time): (&[ControlTangent], f64)) {
        let (n, weights) = (self.n, tangents.weights());
        let (gradients, learned) = (&self.gradients, &self.learned);
        let own = |i: usize, column: usize| match learned.get(column) {
            Some(position) if column < weights => gradients[i][*position],
            _ => Row::default(),
        };
        self.stages.carry((tangents, self.h), &self.slopes, own);
        for control in controls {
            let change = control.change[0].towards(&control.change[1], time);
            for (i, slopes) in self.slopes.chunks_exact(3 * n).enumerate() {
                let slope = &slopes[2 * n + control.coordinate];
                self.stages.add(weights + control.number, i, &change, slope);
            }
        }
    }
}

impl Steps for ExplicitSteps {
    fn begin(&mut self, _: &[f64], _: &mut State, _: Option<&mut Tangents>) {}

    fn step(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tau: [&[Row]; 2],
        tangents: Option<(&mut Tangents, &[ControlTangent])>,
    ) -> Failures {
        let mut failures = Failures::default();
        let (carried, controls) = match tangents {
            Some((tangents, controls)) => (Some(tangents), controls),
            None => (None, &[][..]),
        };
        for (stage, time) in self.method.times().enumerate() {
            self.stages.enter(stage, (state, self.h), (tau, time));
            failures = failures.or(self.accelerate(weights, carried.is_some()));
            if let Some(tangents) = carried.as_deref() {
                self.differentiate(weights, tangents);
                self.carry(tangents, (controls, time));
            }
        }
        self.stages.finish((state, self.h), carried);
        failures.add_not_finite(state);
        failures
    }
}
