//! Interior-point method for motions: Newton's method on states and controls together.
//!
//! The states are unknowns of their own, so that a search may begin with a motion that no control makes, such as a straight line. One
//! iteration:
//!
//! 1. Linearisation of every node; the nodes' ends and the states after them differ by gaps.
//! 2. Step: limits become barriers −μ ln s with their multipliers z, s z → μ; the quadratic model, with the gaps and the goal as linear
//!    equations, is solved by a Riccati recursion from the end to the start. Second derivatives of the motion are left out.
//! 3. Line search: the longest part of the step that stays inside all limits and which a filter of gap and cost accepts.
//! 4. μ falls when the equations are solved as well as it deserves.
//!
//! Sources: Wächter and Biegler, "On the implementation of an interior-point filter line-search algorithm for large-scale nonlinear
//! programming", 2006; Vanroye, Sathya, De Schutter and Decré, "FATROP: a fast constrained optimal control problem solver for robot
//! trajectory optimization and control", 2023.

mod bounds;
mod filter;
mod last;
mod point;

use bounds::Bounds;
use filter::{Filter, Merit};
use last::Last;
use leastaction_core::control::{Decision, Iteration, Limits, Node, Plant, Problem, Transition, Value};
use leastaction_core::discrete::StepError;
use leastaction_core::linear::SolveError;
use point::{Iterate, Point, largest};

/// First barrier parameter μ.
const FIRST_MU: f64 = 0.1;
/// Trials of a line search; each takes half the part of the one before.
const TRIALS: usize = 20;
/// Largest mean multiplier that does not lessen the weight of the slopes in the error.
const MEAN: f64 = 100.0;

/// Reason why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The equations are solved.
    Solved,
    /// No part of a step is accepted.
    Stuck,
    /// The iterations are spent, or the caller stopped the search.
    Stopped,
}

/// Motion from which a search begins: states and controls of the nodes, which need not make the states, and the last state.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeMotion<const D: usize, const N: usize> {
    /// States; the first one is kept.
    pub x: Vec<[f64; D]>,
    /// Controls, as many.
    pub u: Vec<[f64; N]>,
    /// Last state.
    pub end: [f64; D],
}

/// A search.
pub struct Interior<'p, P, const D: usize, const N: usize> {
    problem: &'p Problem<P, f64, D, N>,
    points: Vec<Point<D, N>>,
    last: Last<D>,
    /// Number of ticks in a node.
    ticks: u16,
    filter: Filter,
    mu: f64,
    /// Stop of the search, and the smallest μ times 10.
    tolerance: f64,
}

impl<'p, P: Plant<f64, D, N>, const D: usize, const N: usize> Interior<'p, P, D, N> {
    /// Begins with a motion whose nodes last `ticks` each, moved inside the limits.
    ///
    /// # Errors
    /// [`StepError`] if a node of it cannot be computed.
    pub fn new(
        problem: &'p Problem<P, f64, D, N>,
        begin: &FreeMotion<D, N>,
        ticks: u16,
        tolerance: f64,
    ) -> Result<Self, StepError<f64>> {
        let point = |(k, (x, u)): (usize, (&[f64; D], &[f64; N]))| {
            let limits = if k == 0 { Limits::none() } else { problem.hard.limits };
            begun(problem, limits, (*x, *u), ticks)
        };
        let points: Vec<_> = begin.x.iter().zip(&begin.u).enumerate().map(point).collect::<Result<_, _>>()?;
        let last = Last::new(problem, begin.end, FIRST_MU);
        let mut new =
            Self { problem, points, last, ticks, filter: Filter::default(), mu: FIRST_MU, tolerance };
        new.filter = Filter::new(new.merit().gap);
        Ok(new)
    }

    /// Iterates until the equations are solved. `watch` sees every iteration, and ends the search by returning `false`.
    ///
    /// # Errors
    /// [`StepError`] if the present motion cannot be linearised.
    pub fn solve(
        &mut self,
        iterations: u16,
        mut watch: impl FnMut(&Iteration<f64>) -> bool,
    ) -> Result<Ended, StepError<f64>> {
        let mut cost = self.cost();
        for count in 1..=iterations {
            for point in &mut self.points {
                point.linearise(&self.problem.plant, self.ticks)?;
            }
            let error = if count == 1 { f64::INFINITY } else { self.error(0.0) };
            if error <= self.tolerance {
                return Ok(Ended::Solved);
            }
            self.lower_barrier(count > 1);
            if self.step().is_err() {
                return Ok(Ended::Stuck);
            }
            let part = self.search(count == 1);
            let before = std::mem::replace(&mut cost, self.cost());
            let violation = self.gap();
            let iteration = Iteration { count, cost, fall: before - cost, expected: error, part, violation };
            if !watch(&iteration) {
                return Ok(Ended::Stopped);
            }
            if part <= 0.0 {
                return Ok(Ended::Stuck);
            }
        }
        Ok(Ended::Stopped)
    }

    /// Lowers μ as long as the equations of its barrier are solved to 10μ.
    fn lower_barrier(&mut self, solved: bool) {
        let least = 0.1 * self.tolerance;
        while solved && self.mu > least && self.error(self.mu) <= 10.0 * self.mu {
            self.mu = (0.2 * self.mu).min(self.mu.powf(1.5)).max(least);
            self.filter.clear();
        }
    }

    /// Computes the step of all states and controls.
    fn step(&mut self) -> Result<(), SolveError> {
        let (problem, mu) = (self.problem, self.mu);
        let (mut value, mut next) = (self.last.value(mu), self.last.x);
        for point in self.points.iter_mut().rev() {
            value = point.backward((problem, self.ticks), (&value, &next), mu)?;
            next = point.now.x;
        }
        let mut dx = [0.0; D];
        for k in 0..self.points.len() {
            let next = self.state_after(k);
            dx = self.points[k].forward(dx, &next);
        }
        self.last.dx = dx;
        Ok(())
    }

    /// State that follows node k.
    fn state_after(&self, k: usize) -> [f64; D] {
        self.points.get(k + 1).map_or(self.last.x, |point| point.now.x)
    }

    /// Takes the longest part of the step that the filter accepts, and returns it; 0 if there is none. The multipliers are new if `first`.
    fn search(&mut self, first: bool) -> f64 {
        let (mu, now) = (self.mu, self.merit());
        let [longest, dual] = self.reach();
        let along = self.points.iter().map(|point| point.slope((self.problem, self.ticks), mu)).sum::<f64>();
        let slope = along + self.last.slope(mu);
        let mut part = longest;
        for _ in 0..TRIALS {
            if let Some(trial) = self.trial(part)
                && self.filter.accepts(now, trial, (part, slope))
            {
                self.accept(if first { 1.0 } else { part }, dual);
                return part;
            }
            part *= 0.5;
        }
        0.0
    }

    /// Largest parts of the steps of the unknowns and of the multipliers of limits.
    fn reach(&self) -> [f64; 2] {
        let range = (self.mu, (1.0 - self.mu).max(0.99));
        let each = self.points.iter().flat_map(|Point { now, step, bounds, .. }| {
            [bounds.0.reach(&now.x, &step.0, range), bounds.1.reach(&now.u, &step.1, range)]
        });
        each.fold(self.last.reach(range), |[x, z], [of_x, of_z]| [x.min(of_x), z.min(of_z)])
    }

    /// Merit of a part of the step; absent if a node cannot be computed.
    fn trial(&mut self, part: f64) -> Option<Merit> {
        let (plant, ticks) = (&self.problem.plant, self.ticks);
        self.points.iter_mut().try_for_each(|point| point.try_part(plant, ticks, part)).ok()?;
        self.last.try_part(part);
        Some(self.merit_of(|point| &point.trial, &self.last.trial))
    }

    fn merit(&self) -> Merit {
        self.merit_of(|point| &point.now, &self.last.x)
    }

    /// Sum of all gaps, and barrier cost.
    fn merit_of<'s>(&'s self, of: impl Fn(&'s Point<D, N>) -> &'s Iterate<D, N>, end: &'s [f64; D]) -> Merit {
        let (mut gap, mut cost) = (self.last.gap(end), self.last.barrier_cost(end, self.mu));
        let after = self.points.iter().skip(1).map(|point| &of(point).x).chain([end]);
        for (point, next) in self.points.iter().zip(after) {
            let Iterate { x, u, end, .. } = of(point);
            gap += end.iter().zip(next).map(|(end, next)| (end - next).abs()).sum::<f64>();
            cost += self.problem.running_cost(self.ticks, x, u);
            cost += self.mu * (point.bounds.0.barrier(x) + point.bounds.1.barrier(u));
        }
        Merit { gap, cost }
    }

    /// Makes the trial the present motion; takes a part of the change of the gaps' multipliers, and `dual` of those of limits.
    fn accept(&mut self, part: f64, dual: f64) {
        for k in 0..self.points.len() {
            let dx = self.points.get(k + 1).map_or(self.last.dx, |next| next.step.0);
            let point = &mut self.points[k];
            let costate = point.ahead.slope_at(&dx);
            blend(&mut point.costate, &costate, part);
        }
        for point in &mut self.points {
            point.accept(self.mu, dual);
        }
        self.last.accept(self.mu, (part, dual));
    }

    /// Error of the equations of a barrier: slopes of the Lagrangian, s z − μ, and gaps.
    fn error(&self, mu: f64) -> f64 {
        let (mut slope, mut unbalance, mut sum) = (0.0_f64, self.last.unbalance(mu), (0.0, 0));
        let mut before = None;
        for point in &self.points {
            let Point { now, bounds, costate, .. } = point;
            slope = slope.max(point.residual((self.problem, self.ticks), before));
            unbalance = unbalance.max(bounds.0.unbalance(&now.x, mu)).max(bounds.1.unbalance(&now.u, mu));
            let of_gaps = (costate.iter().map(|y| y.abs()).sum(), D);
            for of in [bounds.0.sum(&now.x), bounds.1.sum(&now.u), of_gaps] {
                sum = (sum.0 + of.0, sum.1 + of.1);
            }
            before = Some(costate);
        }
        let scale = (sum.0 / sum.1.max(1) as f64 / MEAN).max(1.0);
        (slope.max(unbalance) / scale).max(self.gap())
    }

    /// Largest gap.
    pub fn gap(&self) -> f64 {
        let each = self.points.iter().enumerate();
        let gaps = each.map(|(k, point)| largest(point.gap(&self.state_after(k)).into_iter()));
        gaps.fold(self.last.gap(&self.last.x), f64::max)
    }

    /// Cost of the present motion.
    fn cost(&self) -> f64 {
        let cost = |Iterate { x, u, .. }: &Iterate<D, N>| self.problem.running_cost(self.ticks, x, u);
        let nodes = self.points.iter().map(|point| cost(&point.now));
        nodes.sum::<f64>() + self.last.cost(&self.last.x)
    }

    /// The present motion, if no gap is larger than `most`.
    pub fn within(&self, most: f64) -> Option<FreeMotion<D, N>> {
        let gap = self.gap();
        if gap.is_nan() || gap > most {
            return None;
        }
        let (x, u) = self.points.iter().map(|point| (point.now.x, point.now.u)).unzip();
        Some(FreeMotion { x, u, end: self.last.x })
    }

    /// Nodes of the present motion, with the gains and the multipliers of limits that the last step found, and the multipliers of the goal.
    pub fn into_nodes(self) -> (Vec<Node<f64, D, N>>, [f64; D]) {
        let node = |point: &Point<D, N>| {
            let mut node = Node::new(self.ticks, point.now.u);
            (node.x, node.gain, node.multiplier) =
                (point.now.x, point.decision.gain, point.bounds.0.multiplier());
            node
        };
        (self.points.iter().map(node).collect(), self.last.multiplier())
    }
}

/// First point of a node.
fn begun<P: Plant<f64, D, N>, const D: usize, const N: usize>(
    problem: &Problem<P, f64, D, N>,
    limits: Limits<f64, D>,
    (mut x, mut u): ([f64; D], [f64; N]),
    ticks: u16,
) -> Result<Point<D, N>, StepError<f64>> {
    let bounds = (Bounds::new(limits, &mut x, FIRST_MU), Bounds::new(problem.controls, &mut u, FIRST_MU));
    let mut now = Iterate { x, u, course: [0.0; D], end: x };
    Point::evaluate(&problem.plant, ticks, &mut now)?;
    Ok(Point {
        now,
        trial: now,
        bounds,
        costate: [0.0; D],
        transition: Transition::identity(),
        decision: Decision { change: [0.0; N], gain: [[0.0; D]; N] },
        step: ([0.0; D], [0.0; N]),
        ahead: Value { slope: [0.0; D], curvature: [[0.0; D]; D] },
    })
}

/// Moves numbers a part of the way to others.
fn blend<const D: usize>(to: &mut [f64; D], from: &[f64; D], part: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += part * (from - *to);
    }
}
