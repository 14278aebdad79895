//! Two RATTLE steps through three positions as one chain of steps of order 2.
//!
//! With w_k = (x_{k+1} − x_k)/h_k, the momentum with which the motion leaves a point is the momentum with which it
//! arrives there, plus the forces at the point over half of each of the two steps:
//!
//! L_v(w_{k−1}) − L_v(w_k) + ½(h_{k−1} + h_k)(L_q(x_k) + Q(v_k)) + ½(h_{k−1} f_{k−1} + h_k f_k) + A(x_k)ᵀλ_k = 0, φ(x_k) = 0,
//!
//! where λ contains the impulses of both steps, and v_k is the velocity with which the previous step arrives
//! ([`Arrival`]). Two positions therefore determine the motion without a velocity.

use super::model::{Expansion, RodModel};
use super::velocity::{Arrival, Velocity};
use crate::dynamics::{Failures, add, contracted, product};
use crate::losses::Block;
use crate::row::Row;

/// Points of two steps.
pub(super) struct Chain {
    pub steps: Vec<Step>,
    pub points: Vec<Point>,
    /// Stretches that are solved, one after the other.
    pub stretches: Vec<Stretch>,
    /// Samples that could not be computed.
    pub failures: Failures,
}

/// A step of order 2.
#[derive(Default)]
pub(super) struct Step {
    /// Length of the step, s.
    pub h: f64,
    /// External force during the step, N.
    control: Vec<Row>,
    /// Momentum L_v at the increment w, kg m/s, and M.
    momentum: Expansion,
}

/// End of a step.
#[derive(Default)]
pub(super) struct Point {
    /// Position, m.
    pub x: Vec<Row>,
    /// Impulses, N s.
    pub lambda: Vec<Row>,
    /// Constraint values φ, m.
    pub phi: Vec<Row>,
    /// Constraint Jacobian A.
    pub gradients: Vec<Row>,
    /// Force L_q, N, and L_qq.
    force: Expansion,
    pub velocity: Velocity,
    /// Derivatives of the point's equation with respect to the positions of the previous point, of the point itself and
    /// of the next point, n × n rows each; the first two are empty if only the last is needed.
    pub slopes: [Vec<Row>; 3],
}

/// Neighbouring points whose equations are solved together: either for their own positions (`ahead` is 0), with both
/// ends given, or one point's equation for the position of the next point (`ahead` is 1), which is a RATTLE step.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    /// First point whose equation is solved.
    pub start: usize,
    /// Point after the last one.
    pub end: usize,
    pub ahead: usize,
}

impl Chain {
    /// Creates the chain of a block of samples, in which each of the two steps consists of these substeps. `open` says
    /// whether the last position is solved for; if it is given instead, the equation at the middle position is not
    /// solved.
    ///
    /// Points between the logged ones are first guessed on the parabola through the logged ones.
    pub fn new(block: &Block, substeps: &[f64], open: bool, rods: usize) -> Self {
        let (middle, last) = (substeps.len(), 2 * substeps.len());
        let mean = |[a, b]: [&[Row]; 2]| -> Vec<Row> {
            a.iter().zip(b).map(|(a, b)| a.zip(b, |a, b| 0.5 * (a + b))).collect()
        };
        let steps = substeps.iter().chain(substeps).enumerate().map(|(k, h)| {
            let control = mean(block.acting(usize::from(k >= middle)));
            Step { h: *h, control, ..Step::default() }
        });
        let total: f64 = substeps.iter().sum();
        let mut time = -total;
        let mut points = vec![Point { x: block.states[0].clone(), ..Point::default() }];
        for h in substeps.iter().chain(substeps) {
            time += h;
            let (x, lambda) = (parabola(&block.states, time / total), vec![Row::default(); rods]);
            points.push(Point { x, lambda, ..Point::default() });
        }
        (points[middle].x, points[last].x) = (block.states[1].clone(), block.states[2].clone());
        let mut stretches = vec![Stretch { start: 1, end: middle, ahead: 0 }];
        if open {
            stretches.extend((middle..last).map(|k| Stretch { start: k, end: k + 1, ahead: 1 }));
        } else {
            stretches.push(Stretch { start: middle + 1, end: last, ahead: 0 });
        }
        stretches.retain(|stretch| stretch.start < stretch.end);
        Self { steps: steps.collect(), points, stretches, failures: Failures::default() }
    }

    /// Number of the point at the middle position.
    pub fn middle(&self) -> usize {
        self.steps.len() / 2
    }

    /// Increment w_k, m/s.
    pub fn increment(&self, k: usize) -> Vec<Row> {
        let (h, ends) = (self.steps[k].h, self.points[k].x.iter().zip(&self.points[k + 1].x));
        ends.map(|(a, b)| b.zip(a, |b, a| (b - a) / h)).collect()
    }

    /// Time ½(h_{k−1} + h_k), s.
    pub fn span(&self, k: usize) -> f64 {
        0.5 * (self.steps[k - 1].h + self.steps[k].h)
    }

    /// Evaluates everything in the equations of a stretch that has changed since the last update; if `first` is set,
    /// also everything that has changed while another stretch was solved.
    pub fn evaluate(
        &mut self,
        (model, weights): (&mut RodModel, &[f64]),
        stretch: Stretch,
        first: bool,
        skip: Failures,
    ) {
        let Stretch { start, end, ahead } = stretch;
        let moved = first || ahead == 0;
        for k in (start..end).filter(|_| moved) {
            self.place(model, k);
            self.points[k].force = model.force.at(weights, &self.points[k].x);
        }
        for k in start - 1..end {
            if moved || k >= start {
                self.steps[k].momentum = model.momentum.at(weights, &self.increment(k));
            }
        }
        for k in start..end {
            if moved {
                self.arrive((&mut *model, weights), k, ahead == 0, skip);
            }
            self.points[k].slopes = self.slopes(model, k, ahead == 0);
        }
        if ahead > 0 {
            self.place(model, end);
        }
    }

    /// Evaluates everything with all derivatives, once the equations are solved.
    pub fn linearise(&mut self, model: &mut RodModel, weights: &[f64]) {
        let last = self.steps.len();
        self.evaluate((&mut *model, weights), Stretch { start: 1, end: last, ahead: 0 }, true, self.failures);
        self.place(model, last);
    }

    fn place(&mut self, model: &RodModel, k: usize) {
        let point = &mut self.points[k];
        point.phi = model.rods.values(&point.x);
        point.gradients = model.rods.gradients(&point.x);
    }

    fn arrive(&mut self, (model, weights): (&mut RodModel, &[f64]), k: usize, derive: bool, skip: Failures) {
        let arrival = Arrival {
            half: 0.5 * self.steps[k - 1].h,
            momentum: self.brought(k),
            guess: self.increment(k - 1),
            gradients: &self.points[k].gradients,
        };
        let (velocity, failures) = arrival.velocity(model, weights, skip, derive);
        self.points[k].velocity = velocity;
        self.failures = self.failures.or(failures);
    }

    /// Momentum with which the previous step arrives at a point, without drag and constraint forces, kg m/s.
    fn brought(&self, k: usize) -> Vec<Row> {
        let before = &self.steps[k - 1];
        let mut momentum = before.momentum.value.clone();
        add(&mut momentum, 0.5 * before.h, &self.points[k].force.value);
        add(&mut momentum, 0.5 * before.h, &before.control);
        momentum
    }

    /// Residual of the equation of an inner point, N s.
    pub fn residual(&self, k: usize) -> Vec<Row> {
        let (point, after) = (&self.points[k], &self.steps[k]);
        let mut residual = self.brought(k);
        add(&mut residual, 0.5 * after.h, &point.force.value);
        add(&mut residual, 0.5 * after.h, &after.control);
        add(&mut residual, self.span(k), &point.velocity.drag);
        add(&mut residual, -1.0, &after.momentum.value);
        let held = contracted(&point.lambda, &point.gradients, residual.len());
        add(&mut residual, 1.0, &held);
        residual
    }

    /// Derivatives of the equation of an inner point: all of them, or only the one with respect to the position of the
    /// next point.
    fn slopes(&self, model: &RodModel, k: usize, all: bool) -> [Vec<Row>; 3] {
        let (n, span, point) = (model.n, self.span(k), &self.points[k]);
        let [before, after] = [k - 1, k].map(|k| &self.steps[k]);
        let zero = vec![Row::default(); n * n];
        let mut in_next = zero.clone();
        add(&mut in_next, -1.0 / after.h, &after.momentum.slope);
        if !all {
            return [Vec::new(), Vec::new(), in_next];
        }
        let velocity = &point.velocity;
        let braked = |gain: &[Row]| product(&velocity.drag_p, gain, n);
        let mut in_w = before.momentum.slope.clone();
        add(&mut in_w, span, &braked(&before.momentum.slope));
        let mut in_last = zero;
        add(&mut in_last, -1.0 / before.h, &in_w);
        let mut here = model.rods.turned(&point.lambda, n);
        add(&mut here, span, &point.force.slope);
        add(&mut here, span, &velocity.drag_q);
        add(&mut here, 0.5 * span * before.h, &braked(&point.force.slope));
        add(&mut here, -1.0, &in_last);
        add(&mut here, -1.0, &in_next);
        [in_last, here, in_next]
    }
}

/// Returns the parabola through positions at times −1, 0 and 1.
fn parabola([q0, q1, q2]: &[Vec<Row>; 3], t: f64) -> Vec<Row> {
    let mut x = q1.clone();
    for (x, (q0, q2)) in x.iter_mut().zip(q0.iter().zip(q2)) {
        let half = q0.zip(q2, |q0, q2| q2 - q0);
        let bend = x.zip(&q0.zip(q2, |q0, q2| q0 + q2), |q1, ends| ends - 2.0 * q1);
        x.add_scaled(0.5 * t, &half);
        x.add_scaled(0.5 * t * t, &bend);
    }
    x
}
