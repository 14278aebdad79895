//! The discrete losses with rods: those of RATTLE, which steps systems with rods.
//!
//! A step is a chain of steps of order 2 ([`Chain`]). Let y be the weights of the points' equations in a residual
//! component, and z = (∂Q/∂p)ᵀ ½(h_{k−1} + h_k) y those of the equations of v. The derivative of the component with
//! respect to θ is then the sum over points of ∂/∂θ \[F(x_k, v_k)·(½(h_{k−1} + h_k) y_k + ½h_{k−1} z_k) −
//! L_v(v_k)·z_k\] plus the sum over steps of ∂/∂θ \[L_v(w_k)·(y_{k+1} + z_{k+1} − y_k)\]. The multipliers and
//! everything else that is not logged follow by the implicit function theorem.

mod chain;
mod model;
mod solve;
mod velocity;

use super::{Block, Derivatives, Loss, clear, mended, straight_on};
use crate::dynamics::{Failures, Order, Rods, add, contracted, take_out, times};
use crate::program::{Program, Workspace};
use crate::row::Row;
use crate::system::System;
use chain::{Chain, Stretch};
use leastaction_core::discrete;
use model::RodModel;
use solve::Adjoints;

/// A loss over three consecutive positions with RATTLE ([`leastaction_core::discrete::rattle`]), for L = T(v) − V(q)
/// with drag Q(v). The force of a step is the mean of the control during the step: its value at the start if it is
/// held, the mean of both ends if it is linear.
pub struct RodsLoss {
    model: RodModel,
    /// Lengths of the steps of order 2 that make up a step, s.
    substeps: Vec<f64>,
    /// Whether the residual is that of the next position; otherwise it is that of the DEL equation at the middle
    /// position, projected onto the directions that the constraints leave free there.
    next_position: bool,
    /// Programs of L_v along one direction, and along n.
    of_steps: [(Program, Workspace); 2],
    /// Programs of F and L_v along one direction, and along n.
    of_points: [(Program, Workspace); 2],
}

impl RodsLoss {
    /// Creates the loss of the next position, m, or that of the DEL residual, kg m/s, for the step size h, s. `None` if the system does not
    /// have the form T(v) − V(q) with drag Q(v).
    pub fn new(system: &System, rods: Rods, h: f64, order: Order, next_position: bool) -> Option<Self> {
        let order = match order {
            Order::Two => discrete::Order::Two,
            Order::Four => discrete::Order::Four,
        };
        let directions = [1, system.n()];
        Some(Self {
            model: RodModel::new(system, rods)?,
            substeps: order.substeps(h).collect(),
            next_position,
            of_steps: directions.map(|n| system.momentum_along(n).with_workspace()),
            of_points: directions.map(|n| system.along(n).with_workspace()),
        })
    }

    /// Projections onto the directions that the constraints leave free at the middle position; the impulses Aᵀλ have no
    /// component in these directions.
    fn tangents(&self, chain: &mut Chain) -> Vec<Row> {
        let n = self.model.n;
        let mut tangent: Vec<Row> = self.units().concat();
        for gradient in chain.points[chain.middle()].gradients.chunks_exact(n) {
            take_out(&mut tangent, gradient, true, &mut chain.failures);
        }
        tangent
    }

    /// Returns the n unit vectors.
    fn units(&self) -> Vec<Vec<Row>> {
        let unit = |j: usize| (0..self.model.n).map(|i| Row::splat(f64::from(u8::from(i == j)))).collect();
        (0..self.model.n).map(unit).collect()
    }

    /// Solves a block, evaluates what the residual needs (or everything, if `derive` is set), and writes the residual.
    /// Returns the projections if the residual uses them.
    fn residual(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derive: bool,
    ) -> (Chain, Option<Vec<Row>>) {
        let mut chain = Chain::new(block, &self.substeps, self.next_position, self.model.rods.count());
        let middle = chain.middle();
        chain.solve(&mut self.model, weights);
        if derive {
            chain.linearise(&mut self.model, weights);
        } else if !self.next_position {
            let alone = Stretch { start: middle, end: middle + 1, ahead: 0 };
            let failures = chain.failures;
            chain.evaluate((&mut self.model, weights), alone, true, failures);
        }
        let tangent = (!self.next_position).then(|| self.tangents(&mut chain));
        let found = match &tangent {
            Some(tangent) => times(tangent, &chain.residual(middle)),
            None => chain.points[2 * middle].x.clone(),
        };
        residual.copy_from_slice(&found);
        if self.next_position {
            add(residual, -1.0, &block.states[2]);
        }
        chain.failures.add_not_finite(residual);
        (chain, tangent)
    }

    /// Adds the weighted derivatives of all equations.
    fn pull(&mut self, weights: &[f64], chain: &Chain, y: &mut [Vec<Vec<Row>>], rows: &mut [Vec<Row>]) {
        let (n, failures) = (self.model.n, &chain.failures);
        y.iter_mut().flatten().for_each(|y| clear(failures, y));
        let z: Vec<Vec<Vec<Row>>> = y.iter().map(|y| velocity_weights(chain, y)).collect();
        let several = usize::from(rows.len() > 1 || n == 1);
        let tau = vec![Row::default(); n];
        let inner = 1..chain.steps.len();
        for k in 0..chain.steps.len() {
            let at = [mended(failures, &chain.points[k].x), mended(failures, &chain.increment(k))];
            let along = y.iter().zip(&z).map(|(y, z)| {
                let mut dv = y[k + 1].clone();
                add(&mut dv, 1.0, &z[k + 1]);
                add(&mut dv, -1.0, &y[k]);
                dv
            });
            let along: Vec<Vec<Row>> = along.collect();
            run(&mut self.of_steps[several], weights, [&at[0], &at[1], &tau], &along, rows);
            if !inner.contains(&k) {
                continue;
            }
            let (span, half) = (chain.span(k), 0.5 * chain.steps[k - 1].h);
            let along = y.iter().zip(&z).flat_map(|(y, z)| {
                let (mut dq, mut dv) = (vec![Row::default(); n], vec![Row::default(); n]);
                add(&mut dq, span, &y[k]);
                add(&mut dq, half, &z[k]);
                add(&mut dv, -1.0, &z[k]);
                [dq, dv]
            });
            let along: Vec<Vec<Row>> = along.collect();
            let v = &chain.points[k].velocity.v;
            let v = if v.is_empty() { at[1].clone() } else { mended(failures, v) };
            run(&mut self.of_points[several], weights, [&at[0], &v, &tau], &along, rows);
        }
    }
}

/// Weights z of every point: (∂Q/∂p)ᵀ ½(h_{k−1} + h_k) y, 0 at both ends and without drag.
fn velocity_weights(chain: &Chain, y: &[Vec<Row>]) -> Vec<Vec<Row>> {
    let of = |(k, y): (usize, &Vec<Row>)| {
        let mut z = vec![Row::default(); y.len()];
        if (1..chain.steps.len()).contains(&k) {
            let drag_p = mended(&chain.failures, &chain.points[k].velocity.drag_p);
            if !drag_p.is_empty() {
                add(&mut z, chain.span(k), &contracted(y, &drag_p, y.len()));
            }
        }
        z
    };
    y.iter().enumerate().map(of).collect()
}

fn run(
    (program, workspace): &mut (Program, Workspace),
    weights: &[f64],
    at: [&[Row]; 3],
    along: &[Vec<Row>],
    rows: &mut [Vec<Row>],
) {
    let inputs: Vec<&[Row]> = at.into_iter().chain(along.iter().map(Vec::as_slice)).collect();
    program.run(weights, &inputs, workspace, rows);
}

impl Loss for RodsLoss {
    fn components(&self) -> usize {
        self.model.n
    }

    fn of_constant_velocity(&self, block: &Block) -> Option<Vec<Row>> {
        self.next_position.then(|| straight_on(&block.states))
    }

    fn evaluate(
        &mut self,
        weights: &[f64],
        block: &Block,
        residual: &mut [Row],
        derivatives: Derivatives,
    ) -> Failures {
        let derive = !matches!(derivatives, Derivatives::None);
        let (mut chain, tangent) = self.residual(weights, block, residual, derive);
        clear(&chain.failures, residual);
        let (components, rows): (Vec<Vec<Row>>, &mut [Vec<Row>]) = match derivatives {
            Derivatives::None => return chain.failures,
            Derivatives::Jacobian(rows) => (self.units(), rows),
            Derivatives::Gradient(row) => (vec![residual.to_vec()], std::slice::from_mut(row)),
        };
        let (middle, last) = (chain.middle(), chain.steps.len());
        let adjoints = Adjoints::new(components.len(), last + 1, self.model.n);
        let mut adjoints = match tangent {
            None => adjoints.moving(last, &components),
            // The projection is symmetric.
            Some(tangent) => {
                let y: Vec<Vec<Row>> = components.iter().map(|r| times(&tangent, r)).collect();
                adjoints.weighing(&chain, middle, &y)
            }
        };
        adjoints.solve(&mut chain, &mut self.model);
        clear(&chain.failures, residual);
        if !chain.failures.all() {
            self.pull(weights, &chain, &mut adjoints.y, rows);
        }
        chain.failures
    }
}
