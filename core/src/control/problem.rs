use super::backward::Value;
use super::{Cost, Limits, Node, Penalty, Plant};
use crate::linear::{Matrix, add_scaled, add_scaled_matrix, diagonal, multiply};
use crate::scalar::Real;

/// A diagonal quadratic function: slope and curvature of every component.
pub type Diagonal<R, const N: usize> = ([R; N], [R; N]);

/// A problem of optimal control; the [module](super) has its equations.
#[derive(Clone, Copy, Debug)]
pub struct Problem<P, R, const D: usize, const M: usize> {
    /// The plant.
    pub plant: P,
    /// Cost of states and controls.
    pub cost: Cost<R, D, M>,
    /// Limits of the controls, all finite; equal ends hold a control.
    pub controls: Limits<R, M>,
    /// Limits of the states that hold at every node's start except the first.
    pub hard: Penalty<R, D>,
    /// Limits of the states that only cost, ½w e² for an excess e and each tick of the node, at the same places.
    pub soft: Penalty<R, D>,
    /// States to be reached at the end.
    pub goal: Penalty<R, D>,
    /// Energy T + V to be reached at the end. A plant without energy meets any.
    pub energy: Penalty<R, 1>,
}

/// Multipliers of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GoalMultipliers<R, const D: usize> {
    /// Multipliers of the state.
    pub state: [R; D],
    /// Multiplier of the energy.
    pub energy: R,
}

impl<R: Real, const D: usize> GoalMultipliers<R, D> {
    /// No multipliers.
    pub fn none() -> Self {
        Self { state: [R::zero(); D], energy: R::zero() }
    }
}

impl<P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> Problem<P, R, D, M> {
    /// Energy of a state and its slope, if it is part of the goal.
    fn energy_of(&self, x: &[R; D]) -> Option<(R, [R; D])> {
        let Limits { least: [least], most: [most] } = self.energy.limits;
        let limited = least.is_finite() || most.is_finite();
        if limited { self.plant.energy(x) } else { None }
    }

    /// Cost of the last state, with the penalty of the goal.
    pub(super) fn end_cost(&self, x: &[R; D], of: &GoalMultipliers<R, D>, penalty: R) -> R {
        let state = self.cost.of_end(x) + self.goal.value(&self.cost.near(x), &of.state, penalty);
        let energy = self.energy_of(x).map(|(energy, _)| self.energy.value(&[energy], &[of.energy], penalty));
        state + energy.unwrap_or_else(R::zero)
    }

    /// Quadratic model of the cost of the last state.
    pub(super) fn end_value(&self, x: &[R; D], of: &GoalMultipliers<R, D>, penalty: R) -> Value<R, D> {
        let (mut slope, mut curvature) = self.end_slope(x, &of.state, penalty);
        if let Some((energy, by_x)) = self.energy_of(x) {
            let (pull, bend) = self.energy.slope(0, energy, of.energy, penalty);
            slope = add_scaled(&slope, pull, &by_x);
            curvature = core::array::from_fn(|i| add_scaled(&curvature[i], bend * by_x[i], &by_x));
        }
        Value { slope, curvature }
    }

    /// Multipliers of the goal in the next round.
    pub(super) fn goal_multipliers(
        &self,
        x: &[R; D],
        of: &GoalMultipliers<R, D>,
        penalty: R,
    ) -> GoalMultipliers<R, D> {
        let state = self.goal.multipliers(&self.cost.near(x), &of.state, penalty);
        let energy = self.energy_of(x).map(|(energy, _)| self.energy.slope(0, energy, of.energy, penalty).0);
        GoalMultipliers { state, energy: energy.unwrap_or_else(R::zero) }
    }

    /// Largest violation of the goal, in deviations of weight 1.
    pub(super) fn goal_violation(&self, x: &[R; D]) -> R {
        let energy = self.energy_of(x).map(|(energy, _)| self.energy.violation(&[energy]));
        self.goal.violation(&self.cost.near(x)).max(energy.unwrap_or_else(R::zero))
    }
}

impl<P, R: Real, const D: usize, const M: usize> Problem<P, R, D, M> {
    /// Cost of a state and control over some ticks, soft limits included.
    pub fn running_cost(&self, ticks: u16, x: &[R; D], u: &[R; M]) -> R {
        count::<R>(ticks) * (self.cost.of_tick(x, u) + self.soft_cost(x))
    }

    /// Slope and curvature of the running cost in the state.
    pub fn running_slope(&self, ticks: u16, x: &[R; D]) -> Diagonal<R, D> {
        let (deviation, ticks) = (self.cost.deviation(x), count::<R>(ticks));
        let (mut slope, mut curvature) = ([R::zero(); D], [R::zero(); D]);
        for i in 0..D {
            let (soft, bend) = self.soft.slope(i, x[i], R::zero(), R::one());
            slope[i] = ticks * (self.cost.x[i] * deviation[i] + soft);
            curvature[i] = ticks * (self.cost.x[i] + bend);
        }
        (slope, curvature)
    }

    /// Slope and curvature of the running cost in the control.
    pub fn control_slope(&self, ticks: u16, u: &[R; M]) -> Diagonal<R, M> {
        let ticks = count::<R>(ticks);
        let curvature = self.cost.u.map(|weight| ticks * weight);
        (core::array::from_fn(|j| curvature[j] * u[j]), curvature)
    }

    /// Penalties of the soft limits for a tick.
    fn soft_cost(&self, x: &[R; D]) -> R {
        self.soft.value(x, &[R::zero(); D], R::one())
    }

    /// Cost of a node of a motion without that of hard limits; its `first` state is given, and no limit holds there.
    pub(super) fn node_cost(&self, (ticks, x, u): (u16, &[R; D], &[R; M]), first: bool) -> R {
        if first { count::<R>(ticks) * self.cost.of_tick(x, u) } else { self.running_cost(ticks, x, u) }
    }

    /// Slope and curvature of the cost of the last state, without that of the energy.
    fn end_slope(&self, x: &[R; D], multiplier: &[R; D], penalty: R) -> ([R; D], Matrix<R, D>) {
        let (cost, near) = (&self.cost, self.cost.near(x));
        let (mut slope, mut of_goal) = (multiply(&cost.end, &cost.deviation(x)), [R::zero(); D]);
        for i in 0..D {
            let (pull, bend) = self.goal.slope(i, near[i], multiplier[i], penalty);
            slope[i] += pull;
            of_goal[i] = bend;
        }
        (slope, add_scaled_matrix(&cost.end, R::one(), &diagonal(of_goal)))
    }

    /// Slope and curvature of the cost of a node's state.
    pub(super) fn state_cost<const C: usize>(&self, node: &Node<R, D, C>, penalty: R) -> Diagonal<R, D> {
        let (mut slope, mut curvature) = self.running_slope(node.ticks, &node.x);
        for i in 0..D {
            let (hard, bend) = self.hard.slope(i, node.x[i], node.multiplier[i], penalty);
            slope[i] += hard;
            curvature[i] += bend;
        }
        (slope, curvature)
    }
}

/// A number of ticks as a scalar.
fn count<R: Real>(ticks: u16) -> R {
    R::constant(f64::from(ticks))
}

/// Bounds of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options<R> {
    /// Maximum number of iterations.
    pub iterations: u16,
    /// Fall of the cost, relative to 1 + |cost|, below which the last round ends.
    pub tolerance: R,
    /// Largest accepted violation of limits and goal, in deviations of weight 1.
    pub violation: R,
    /// Scale ρ > 0 of the penalties in the first round.
    pub penalty: R,
    /// Factor above 1 by which ρ grows after a round that did not lower the violation enough.
    pub growth: R,
}

/// Result of one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration<R> {
    /// Number of iterations so far.
    pub count: u16,
    /// Augmented cost after the iteration.
    pub cost: R,
    /// Fall of the augmented cost in the iteration; 0 if no trial of the line search lowered it.
    pub fall: R,
    /// Fall that the quadratic models expected of the whole change.
    pub expected: R,
    /// Accepted part α of the change; 0 if none was.
    pub part: R,
    /// Largest violation of limits and goal, in deviations of weight 1.
    pub violation: R,
}

/// Reason why a search ended.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The cost no longer falls; limits and goal are met.
    Solved,
    /// The violation of limits or goal no longer falls.
    Infeasible,
    /// The iterations are spent, or the caller stopped the search.
    Stopped,
}

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<R> {
    /// Reason why the search ended.
    pub status: Status,
    /// Cost without the penalties of hard limits and goal.
    pub cost: R,
    /// Largest violation of limits and goal, in deviations of weight 1.
    pub violation: R,
    /// Number of iterations.
    pub iterations: u16,
}
