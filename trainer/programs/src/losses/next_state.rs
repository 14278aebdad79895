use super::{Block, Derivatives, Loss, clear, mended};
use crate::dynamics::{Accelerations, Failures, contracted, dot};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::steps::{RungeKutta, State, sum};
use crate::system::System;

/// Result of an explicit Runge–Kutta step from a logged state minus the next logged state: positions, then velocities
/// (L-NODE). Each stage uses the control at its own time. There are no constraints.
///
/// With y_k the adjoint of stage k's acceleration in a residual component, the component's derivative with respect to θ
/// is Σ y_k·∂v̇_k = Σ ∂/∂θ \[(F − d/dt L_v)·M⁻¹y_k\] at the stages' states and accelerations.
pub struct NextStateLoss {
    n: usize,
    h: f64,
    method: RungeKutta,
    accelerations: Accelerations,
    tangents: (Program, Workspace),
    /// Programs for one direction, and for 2n directions.
    pulls: [(Program, Workspace); 2],
}

/// A stage: its state, control and rate (v, v̇), M⁻¹ at its state, and the derivatives of F − d/dt L_v, column by
/// column.
struct Stage {
    state: State,
    tau: Vec<Row>,
    rate: State,
    compliance: Vec<Row>,
    unbalanced: Vec<Row>,
}

impl NextStateLoss {
    /// Creates the loss of a system for the step size h, s.
    pub fn new(system: &System, h: f64, method: RungeKutta) -> Self {
        let n = system.n();
        Self {
            n,
            h,
            method,
            accelerations: Accelerations::new(system),
            tangents: system.residual_derivatives().with_workspace(),
            pulls: [1, 2 * n].map(|directions| system.residual(directions).with_workspace()),
        }
    }

    fn stage(
        &mut self,
        weights: &[f64],
        (state, tau): (State, Vec<Row>),
        differentiate: bool,
    ) -> (Stage, Failures) {
        let n = self.n;
        let rate = state[n..].to_vec();
        let mut stage = Stage { rate, state, tau, compliance: Vec::new(), unbalanced: Vec::new() };
        let (mut a, (q, v), tau) = (vec![Row::default(); n], stage.state.split_at(n), &stage.tau[..]);
        if !differentiate {
            let failures = self.accelerations.evaluate(weights, [q, v, tau], &mut a, None);
            stage.rate.extend(a);
            return (stage, failures);
        }
        stage.compliance = vec![Row::default(); n * n];
        let failures = self.accelerations.evaluate(weights, [q, v, tau], &mut a, Some(&mut stage.compliance));
        let (program, workspace) = &mut self.tangents;
        program.run(weights, &[q, v, tau, &a], workspace, &mut []);
        stage.unbalanced = (0..2 * n).flat_map(|column| workspace.output(column)).copied().collect();
        stage.rate.extend(a);
        (stage, failures)
    }

    fn stages(
        &mut self,
        weights: &[f64],
        start: &State,
        [first, last]: [&[Row]; 2],
        differentiate: bool,
    ) -> (Vec<Stage>, Failures) {
        let (mut stages, mut failures) = (Vec::<Stage>::new(), Failures::default());
        for (shares, c) in self.method.stages().iter().zip(self.method.times()) {
            let rates = shares.iter().copied().zip(stages.iter().map(|stage| &stage.rate));
            let state = sum(start, self.h, rates);
            let tau = first.iter().zip(last).map(|(a, b)| a.zip(b, |a, b| a + c * (b - a))).collect();
            let (stage, failed) = self.stage(weights, (state, tau), differentiate);
            failures = failures.or(failed);
            stages.push(stage);
        }
        (stages, failures)
    }

    /// Returns M⁻¹y of every stage, where y are the adjoints of the accelerations in an end weighted by `end_bar`.
    fn adjoints(&self, stages: &[Stage], end_bar: &State) -> Vec<Vec<Row>> {
        let (n, h) = (self.n, self.h);
        let zero = vec![Row::default(); 2 * n];
        let mut bars = vec![zero.clone(); stages.len()];
        let mut along = vec![Vec::new(); stages.len()];
        for (k, stage) in stages.iter().enumerate().rev() {
            let later = (k + 1..stages.len()).map(|later| (self.method.stages()[later][k], &bars[later]));
            let bar = sum(&zero, h, std::iter::once((self.method.end()[k], end_bar)).chain(later));
            let (v_bar, y) = bar.split_at(n);
            along[k] = contracted(y, &stage.compliance, n);
            let mut own: State =
                stage.unbalanced.chunks_exact(n).map(|column| dot(column, &along[k])).collect();
            own[n..].iter_mut().zip(v_bar).for_each(|(own, v_bar)| own.add_scaled(1.0, v_bar));
            bars[k] = own;
        }
        along
    }
}

impl Loss for NextStateLoss {
    fn components(&self) -> usize {
        2 * self.n
    }

    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>> {
        let [q, v, next] = &block.states;
        let moved = q.iter().zip(v).map(|(q, v)| q.zip(v, |q, v| q + self.h * v));
        let positions = moved.zip(next).map(|(q, next)| q.zip(next, |q, next| q - next));
        let velocities = v.iter().zip(&block.next_velocity).map(|(v, next)| v.zip(next, |v, next| v - next));
        Some(positions.chain(velocities).collect())
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        let n = self.n;
        let [q, v, next] = &block.states;
        let start: State = q.iter().chain(v).copied().collect();
        let differentiate = !matches!(derivatives, Derivatives::None);
        let (stages, mut failures) = self.stages(weights, &start, block.acting(0), differentiate);
        let rates = self.method.end().iter().copied().zip(stages.iter().map(|stage| &stage.rate));
        let end = sum(&start, self.h, rates);
        for ((residual, end), logged) in
            residual.iter_mut().zip(&end).zip(next.iter().chain(&block.next_velocity))
        {
            *residual = end.zip(logged, |end, logged| end - logged);
        }
        failures.add_not_finite(residual);
        clear(&failures, residual);
        if failures.all() {
            return failures;
        }
        let unit = |component: usize| -> State {
            (0..2 * n).map(|i| Row::splat(f64::from(u8::from(i == component)))).collect()
        };
        let (ends, rows): (Vec<State>, &mut [Vec<Row>]) = match derivatives {
            Derivatives::None => return failures,
            Derivatives::Jacobian(rows) => ((0..2 * n).map(unit).collect(), rows),
            Derivatives::Gradient(row) => (vec![residual.to_vec()], std::slice::from_mut(row)),
        };
        let along: Vec<Vec<Vec<Row>>> = ends.iter().map(|end| self.adjoints(&stages, end)).collect();
        let (program, workspace) = &mut self.pulls[usize::from(ends.len() > 1)];
        for (k, stage) in stages.iter().enumerate() {
            let at = [&stage.state[..n], &stage.state[n..], &stage.tau, &stage.rate[n..]];
            let mut inputs = at.map(|rows| mended(&failures, rows)).to_vec();
            inputs.extend(along.iter().map(|along| {
                let mut y = along[k].clone();
                clear(&failures, &mut y);
                y
            }));
            let inputs: Vec<&[Row]> = inputs.iter().map(Vec::as_slice).collect();
            program.run(weights, &inputs, workspace, rows);
        }
        failures
    }
}
