use super::backward::{Decision, Expected, NodeModel, Value};
use super::rollout::{End, Rollout};
use super::{GoalMultipliers, Iteration, Limits, Node, Plant, Problem};
use crate::discrete::StepError;
use crate::linear::{SolveError, add_scaled};
use crate::scalar::Real;

/// Smallest and largest damping of the backward pass, and the factor of its changes.
const DAMPING: [f64; 3] = [1e-8, 1e10, 4.0];
/// Part of the expected fall that an accepted trial must reach.
const ENOUGH: f64 = 1e-4;

/// A motion over the caller's nodes, which meets the limits of the controls, and what iterations of iterative LQR need to improve it.
#[derive(Debug)]
pub struct Shooting<'n, P, R, const D: usize, const M: usize> {
    /// The problem.
    pub problem: Problem<P, R, D, M>,
    /// Nodes of the present motion.
    pub nodes: &'n mut [Node<R, D, M>],
    /// End of the present motion.
    pub end: End<R, D>,
    /// Scale ρ of the penalties.
    pub penalty: R,
    /// Damping μ: leaving the present motion costs ½μ|δx|².
    pub damping: R,
    /// Augmented cost of the present motion.
    pub cost: R,
    /// Number of iterations.
    pub count: u16,
    /// Maximum number of trials of a line search; each takes half the part of the one before.
    trials: u16,
    /// Whether the linear approximations are those of the present motion.
    linearised: bool,
}

/// Progress of a search between two decisions, beside its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Progress<R, const D: usize> {
    end: End<R, D>,
    damping: R,
    cost: R,
    linearised: bool,
}

impl<'n, P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> Shooting<'n, P, R, D, M> {
    /// Begins with the motion from x that follows the states of the nodes by their gains.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed.
    pub fn new(
        problem: Problem<P, R, D, M>,
        (x, nodes): ([R; D], &'n mut [Node<R, D, M>]),
        goal: GoalMultipliers<R, D>,
        (penalty, trials): (R, u16),
    ) -> Result<Self, StepError<R>> {
        if let Some(first) = nodes.first_mut() {
            first.x = x;
        }
        let (end, zero) = (End::new(x, goal), R::zero());
        let mut new = Self {
            problem,
            nodes,
            end,
            penalty,
            damping: zero,
            cost: zero,
            count: 0,
            trials,
            linearised: false,
        };
        new.cost = new.rollout(zero)?;
        new.accept();
        Ok(new)
    }

    /// Progress so far.
    pub fn progress(&self) -> Progress<R, D> {
        let Self { end, damping, cost, linearised, .. } = *self;
        Progress { end, damping, cost, linearised }
    }

    /// Goes on from a progress, which belongs to the nodes.
    pub fn resume(
        problem: Problem<P, R, D, M>,
        nodes: &'n mut [Node<R, D, M>],
        Progress { end, damping, cost, linearised }: Progress<R, D>,
        (penalty, trials): (R, u16),
    ) -> Self {
        Self { problem, nodes, end, penalty, damping, cost, count: 0, trials, linearised }
    }

    /// Whether no step lowers the cost any more: the damping is the largest.
    pub fn is_stuck(&self) -> bool {
        self.damping >= R::constant(DAMPING[1])
    }

    /// One iteration: linearisation, backward pass, line search.
    ///
    /// # Errors
    /// [`StepError`] if the present motion cannot be linearised.
    pub fn iterate(&mut self) -> Result<Iteration<R>, StepError<R>> {
        self.linearise()?;
        self.count += 1;
        let found = match self.backward() {
            Ok(expected) => Some((expected, self.search(&expected))),
            Err(SolveError::Singular { .. }) => None,
            Err(error) => return Err(error.into()),
        };
        // Without a change nothing is expected, but not because the cost is least.
        let nothing = (R::constant(f64::INFINITY), (R::zero(), R::zero()));
        let (expected, (part, fall)) =
            found.map_or(nothing, |(expected, found)| (-expected.at(R::one()), found));
        self.damp(part <= R::zero());
        let (count, cost, violation) = (self.count, self.cost, self.violation());
        Ok(Iteration { count, cost, fall, expected, part, violation })
    }

    /// Linearises every node of the present motion.
    fn linearise(&mut self) -> Result<(), StepError<R>> {
        if self.linearised {
            return Ok(());
        }
        let plant = &self.problem.plant;
        let (mut x, mut frame) = (self.end.x, plant.frame(&self.end.x));
        for node in self.nodes.iter_mut().rev() {
            let start = plant.frame(&node.x);
            let ends = [(&node.x, &start), (&x, &frame)];
            node.transition = plant.linearise(ends, (node.ticks, &node.u), &node.course)?;
            (x, frame) = (node.x, start);
        }
        self.linearised = true;
        Ok(())
    }

    /// Finds changes and gains of all nodes, from the last to the first; returns the expected change of the cost.
    fn backward(&mut self) -> Result<Expected<R>, SolveError> {
        let (mut value, mut expected) = (self.end_value(), Expected::nothing());
        let problem = &self.problem;
        for node in self.nodes.iter_mut().rev() {
            let costs = (problem.state_cost(node, self.penalty), problem.control_slope(node.ticks, &node.u));
            let model = NodeModel::new(costs, &node.transition, &value);
            let room = Limits {
                least: add_scaled(&problem.controls.least, -R::one(), &node.u),
                most: add_scaled(&problem.controls.most, -R::one(), &node.u),
            };
            let decision = model.decide(self.damping, &node.transition, (&room, &node.change))?;
            value = model.value(&decision);
            expected.add(&model, &decision.change);
            Decision { change: node.change, gain: node.gain } = decision;
        }
        Ok(expected)
    }

    /// Tries smaller and smaller parts of the change until the cost falls; returns the accepted part, or 0, and the fall.
    fn search(&mut self, expected: &Expected<R>) -> (R, R) {
        let mut part = R::one();
        for _ in 0..self.trials {
            if let Ok(cost) = self.rollout(part)
                && cost - self.cost <= R::constant(ENOUGH) * expected.at(part)
            {
                let fall = self.cost - cost;
                self.cost = cost;
                self.accept();
                return (part, fall);
            }
            part = part.half();
        }
        (R::zero(), R::zero())
    }

    /// Computes the trial motion for a part of the change, and returns its augmented cost.
    ///
    /// # Errors
    /// [`StepError`] if a node cannot be computed.
    pub fn rollout(&mut self, part: R) -> Result<R, StepError<R>> {
        let mut rollout = Rollout::begin(&self.problem, self.penalty, self.start())?;
        for node in self.nodes.iter_mut() {
            let u = node.control(part, &rollout.x);
            rollout.pass(node, (node.ticks, u))?;
        }
        Ok(rollout.end(&mut self.end))
    }

    /// State at the start of the motion; at its end if there is no node.
    pub fn start(&self) -> [R; D] {
        self.nodes.first().map_or(self.end.x, |node| node.x)
    }

    /// Makes the trial motion the present one.
    pub fn accept(&mut self) {
        self.nodes.iter_mut().for_each(Node::accept);
        self.end.x = self.end.trial;
        self.linearised = false;
    }

    /// Slope and curvature of the cost of the last state.
    fn end_value(&self) -> Value<R, D> {
        self.problem.end_value(&self.end.x, &self.end.goal, self.penalty)
    }

    /// Raises or lowers the damping.
    fn damp(&mut self, more: bool) {
        let [least, most, factor] = DAMPING.map(R::constant);
        let raised = self.damping.max(least) * factor;
        let lowered = self.damping / factor;
        self.damping = match more {
            true => {
                if raised < most {
                    raised
                } else {
                    most
                }
            }
            false => {
                if lowered > least {
                    lowered
                } else {
                    R::zero()
                }
            }
        };
    }

    /// Largest violation of limits and goal of the present motion, in deviations of weight 1.
    pub fn violation(&self) -> R {
        let hard = &self.problem.hard;
        let along = self.nodes.iter().skip(1).map(|node| hard.violation(&node.x));
        along.fold(self.problem.goal_violation(&self.end.x), R::max)
    }

    /// Cost of the present motion without the penalties of hard limits and goal.
    pub fn plain_cost(&self) -> R {
        let node = |(k, node): (usize, &Node<R, D, M>)| {
            self.problem.node_cost((node.ticks, &node.x, &node.u), k == 0)
        };
        let end = self.problem.cost.of_end(&self.end.x);
        self.nodes.iter().enumerate().map(node).fold(end, |sum, cost| sum + cost)
    }
}
