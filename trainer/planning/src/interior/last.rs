use super::{Bounds, blend};
use leastaction_core::control::{Diagonal, Limits, Problem, Value};
use leastaction_core::linear::{Matrix, add_scaled, add_scaled_matrix, diagonal, dot, multiply};
use std::array::from_fn;

/// The last state with the goal: numbers to be reached are equations, others are limits.
#[derive(Clone, Debug)]
pub struct Last<const D: usize> {
    /// State.
    pub x: [f64; D],
    /// Step of the state.
    pub dx: [f64; D],
    /// Trial under way.
    pub trial: [f64; D],
    /// Weights of the cost, and the state from which it counts deviations.
    cost: (Matrix<f64, D>, [f64; D]),
    goal: Limits<f64, D>,
    bounds: Bounds<D>,
    /// Multipliers λ of the equations.
    multiplier: [f64; D],
}

/// Softness of the equations of the goal: a step misses them by this times the change of λ.
const SOFTNESS: f64 = 1e-9;

impl<const D: usize> Last<D> {
    /// Begins next to a state, the goal moved by whole turns to lie next to it.
    pub fn new<P, const N: usize>(problem: &Problem<P, f64, D, N>, x: [f64; D], mu: f64) -> Self {
        let (cost, Limits { least, most }) = (&problem.cost, &problem.goal.limits);
        let near = add_scaled(&cost.goal, 1.0, &cost.deviation(&x));
        let shift = add_scaled(&x, -1.0, &near);
        let moved = |end: &[f64; D]| add_scaled(end, 1.0, &shift);
        let goal = Limits { least: moved(least), most: moved(most) };
        let mut x = x;
        let bounds = Bounds::new(goal, &mut x, mu);
        let zero = [0.0; D];
        Self { x, dx: zero, trial: x, cost: (cost.end, moved(&cost.goal)), goal, bounds, multiplier: zero }
    }

    /// Slope of the cost and of the barriers, and the curvature of the barriers.
    fn terms(&self, mu: f64) -> Diagonal<f64, D> {
        let (slope, curvature) = self.bounds.terms(&self.x, mu);
        let (weights, centre) = &self.cost;
        let of_cost = multiply(weights, &add_scaled(&self.x, -1.0, centre));
        (add_scaled(&of_cost, 1.0, &slope), curvature)
    }

    /// Distance of every number that is to be reached, at a state.
    fn misses(&self, x: &[f64; D]) -> [Option<f64>; D] {
        let Limits { least, most } = &self.goal;
        from_fn(|i| (least[i] >= most[i]).then(|| x[i] - least[i]))
    }

    /// Model of the cost of the state: barriers of limits, and the equations as stiff springs about their multipliers.
    pub fn value(&self, mu: f64) -> Value<f64, D> {
        let (mut slope, mut curvature) = self.terms(mu);
        for (i, miss) in self.misses(&self.x).into_iter().enumerate() {
            if let Some(miss) = miss {
                slope[i] += self.multiplier[i] + miss / SOFTNESS;
                curvature[i] += 1.0 / SOFTNESS;
            }
        }
        Value { slope, curvature: add_scaled_matrix(&self.cost.0, 1.0, &diagonal(curvature)) }
    }

    /// Slope of the barrier cost along the step.
    pub fn slope(&self, mu: f64) -> f64 {
        let (slope, _) = self.terms(mu);
        slope.iter().zip(&self.dx).map(|(slope, dx)| slope * dx).sum()
    }

    /// Cost of a state.
    pub fn cost(&self, x: &[f64; D]) -> f64 {
        let (weights, centre) = &self.cost;
        let deviation = add_scaled(x, -1.0, centre);
        0.5 * dot(&deviation, &multiply(weights, &deviation))
    }

    /// Barrier cost of a state.
    pub fn barrier_cost(&self, x: &[f64; D], mu: f64) -> f64 {
        self.cost(x) + mu * self.bounds.barrier(x)
    }

    /// Sum of the distances from the numbers to be reached.
    pub fn gap(&self, x: &[f64; D]) -> f64 {
        self.misses(x).into_iter().flatten().map(f64::abs).sum()
    }

    /// Largest |s z − μ| of the limits.
    pub fn unbalance(&self, mu: f64) -> f64 {
        self.bounds.unbalance(&self.x, mu)
    }

    /// Largest parts of the step and of the change of the limits' multipliers.
    pub fn reach(&self, range: (f64, f64)) -> [f64; 2] {
        self.bounds.reach(&self.x, &self.dx, range)
    }

    /// Tries a part of the step.
    pub fn try_part(&mut self, part: f64) {
        self.trial = add_scaled(&self.x, part, &self.dx);
    }

    /// Makes the trial the present state.
    pub fn accept(&mut self, mu: f64, (part, dual): (f64, f64)) {
        let missed = self.misses(&self.x);
        let found =
            from_fn(|i| missed[i].map_or(0.0, |miss| self.multiplier[i] + (miss + self.dx[i]) / SOFTNESS));
        blend(&mut self.multiplier, &found, part);
        self.bounds.advance((&self.x, &self.dx, &self.trial), mu, dual);
        self.x = self.trial;
    }

    /// Multiplier of every number, positive if the number is held back from growing.
    pub fn multiplier(&self) -> [f64; D] {
        add_scaled(&self.multiplier, 1.0, &self.bounds.multiplier())
    }
}
