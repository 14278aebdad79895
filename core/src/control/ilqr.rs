use super::backward::{Decision, Expected, NodeModel, Value};
use super::rounds::{Next, Rounds};
use super::{GoalMultipliers, Iteration, Limits, Node, Options, Plant, Problem, Solution, Status};
use crate::discrete::StepError;
use crate::linear::{SolveError, add_scaled};
use crate::scalar::Real;

/// The last state of a motion.
#[derive(Clone, Copy, Debug)]
struct End<R, const D: usize> {
    x: [R; D],
    /// Multipliers of the goal.
    goal: GoalMultipliers<R, D>,
    /// State of the trial under way.
    trial: [R; D],
}

/// Smallest and largest damping of the backward pass, and the factor of its changes.
const DAMPING: [f64; 3] = [1e-8, 1e10, 4.0];
/// Maximum number of trials of a line search; each takes half the part of the one before.
const TRIALS: usize = 12;
/// Part of the expected fall that an accepted trial must reach.
const ENOUGH: f64 = 1e-4;

/// Iterative LQR over the caller's nodes: the present motion, which meets the limits of the controls, and the state of the search.
#[derive(Debug)]
pub struct Ilqr<'n, P, R, const D: usize, const M: usize> {
    problem: Problem<P, R, D, M>,
    options: Options<R>,
    nodes: &'n mut [Node<R, D, M>],
    end: End<R, D>,
    /// Scale ρ of the penalties.
    penalty: R,
    /// Damping μ: leaving the present motion costs ½μ|δx|².
    damping: R,
    /// Augmented cost of the present motion.
    cost: R,
    /// Whether the linear approximations are those of the present motion.
    linearised: bool,
    count: u16,
}

impl<'n, P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> Ilqr<'n, P, R, D, M> {
    /// Begins with the motion from x under the controls of the nodes, moved into their limits.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed.
    pub fn new(
        problem: Problem<P, R, D, M>,
        options: Options<R>,
        x: [R; D],
        nodes: &'n mut [Node<R, D, M>],
    ) -> Result<Self, StepError<R>> {
        for node in nodes.iter_mut() {
            *node = Node { x, ..Node::new(node.u) };
        }
        Self::near(problem, options, (x, nodes), GoalMultipliers::none())
    }

    /// Begins with the motion from x that follows the states of the nodes by their gains; `goal` has the multipliers of the goal, the nodes
    /// have those of the limits.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed.
    pub fn near(
        problem: Problem<P, R, D, M>,
        options: Options<R>,
        (x, nodes): ([R; D], &'n mut [Node<R, D, M>]),
        goal: GoalMultipliers<R, D>,
    ) -> Result<Self, StepError<R>> {
        if let Some(first) = nodes.first_mut() {
            first.x = x;
        }
        let end = End { x, goal, trial: x };
        let (penalty, zero) = (options.penalty, R::zero());
        let mut new = Self {
            problem,
            options,
            nodes,
            end,
            penalty,
            damping: zero,
            cost: zero,
            linearised: false,
            count: 0,
        };
        new.cost = new.rollout(zero)?;
        new.accept();
        Ok(new)
    }

    /// Nodes of the present motion.
    pub fn nodes(&self) -> &[Node<R, D, M>] {
        self.nodes
    }

    /// State at the end of the present motion.
    pub fn end(&self) -> &[R; D] {
        &self.end.x
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
            node.transition = plant.linearise(ends, &node.u, &node.course)?;
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
            let of_u = core::array::from_fn(|j| problem.cost.u[j] * node.u[j]);
            let costs = (problem.state_cost(node, self.penalty), (of_u, problem.cost.u));
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
        for _ in 0..TRIALS {
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
    fn rollout(&mut self, part: R) -> Result<R, StepError<R>> {
        let (problem, mut x) = (&self.problem, self.start());
        let mut motion = problem.plant.begin(&x)?;
        let mut cost = R::zero();
        for (k, node) in self.nodes.iter_mut().enumerate() {
            let u = problem.controls.clamped(&node.control(part, &x));
            (node.trial.0, node.trial.1) = (x, u);
            cost += problem.cost.of_node(&x, &u);
            if k > 0 {
                cost += problem.limits_cost(&x, &node.multiplier, self.penalty);
            }
            x = problem.plant.advance(&mut motion, &u, &mut node.trial.2)?;
        }
        self.end.trial = x;
        Ok(cost + problem.end_cost(&x, &self.end.goal, self.penalty))
    }

    /// State at the start of the motion; at its end if there is no node.
    fn start(&self) -> [R; D] {
        self.nodes.first().map_or(self.end.x, |node| node.x)
    }

    /// Makes the trial motion the present one.
    fn accept(&mut self) {
        for node in self.nodes.iter_mut() {
            (node.x, node.u, node.course) = node.trial;
        }
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
        let Problem { cost, soft, .. } = &self.problem;
        let none = [R::zero(); D];
        let node = |(k, node): (usize, &Node<R, D, M>)| {
            let limits = if k > 0 { soft.value(&node.x, &none, R::one()) } else { R::zero() };
            cost.of_node(&node.x, &node.u) + limits
        };
        self.nodes.iter().enumerate().map(node).fold(cost.of_end(&self.end.x), |sum, cost| sum + cost)
    }

    /// Begins a round with the multipliers that the last one found; ρ grows if `more`.
    fn next_round(&mut self, more: bool) -> Result<(), StepError<R>> {
        let hard = &self.problem.hard;
        for node in self.nodes.iter_mut().skip(1) {
            node.multiplier = hard.multipliers(&node.x, &node.multiplier, self.penalty);
        }
        self.end.goal = self.problem.goal_multipliers(&self.end.x, &self.end.goal, self.penalty);
        if more {
            self.penalty = self.penalty * self.options.growth;
        }
        self.damping = R::zero();
        for node in self.nodes.iter_mut() {
            (node.change, node.gain) = ([R::zero(); M], [[R::zero(); D]; M]);
        }
        self.cost = self.rollout(R::zero())?;
        Ok(())
    }

    /// Iterates until the cost no longer falls and limits and goal are met. `watch` sees every iteration, and ends the search by returning
    /// `false`.
    ///
    /// # Errors
    /// [`StepError`] if the present motion cannot be linearised.
    pub fn solve(
        &mut self,
        mut watch: impl FnMut(&Iteration<R>) -> bool,
    ) -> Result<Solution<R>, StepError<R>> {
        let mut rounds = Rounds::new(&self.options, self.violation());
        let mut status = Status::Stopped;
        while self.count < self.options.iterations {
            let iteration = self.iterate()?;
            let stuck = self.damping >= R::constant(DAMPING[1]);
            match rounds.after(&iteration, stuck) {
                Next::Iterate => {}
                Next::Round { more } => self.next_round(more)?,
                Next::End(found) => {
                    status = found;
                    watch(&iteration);
                    break;
                }
            }
            if !watch(&iteration) {
                break;
            }
        }
        let (cost, violation) = (self.plain_cost(), self.violation());
        Ok(Solution { status, cost, violation, iterations: self.count })
    }
}
