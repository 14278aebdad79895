use super::rounds::{Next, Rounds};
use super::shooting::Shooting;
use super::{GoalMultipliers, Iteration, Node, Options, Plant, Problem, Solution, Status};
use crate::discrete::StepError;
use crate::scalar::Real;

/// Maximum number of trials of a line search.
const TRIALS: u16 = 12;

/// Iterative LQR over the caller's nodes: the present motion, which meets the limits of the controls, and the state of the search.
#[derive(Debug)]
pub struct Ilqr<'n, P, R, const D: usize, const M: usize> {
    shooting: Shooting<'n, P, R, D, M>,
    options: Options<R>,
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
            *node = Node { x, ..Node::new(node.ticks, node.u) };
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
        let shooting = Shooting::new(problem, (x, nodes), goal, (options.penalty, TRIALS))?;
        Ok(Self { shooting, options })
    }

    /// Nodes of the present motion.
    pub fn nodes(&self) -> &[Node<R, D, M>] {
        self.shooting.nodes
    }

    /// State at the end of the present motion.
    pub fn end(&self) -> &[R; D] {
        &self.shooting.end.x
    }

    /// One iteration: linearisation, backward pass, line search.
    ///
    /// # Errors
    /// [`StepError`] if the present motion cannot be linearised.
    pub fn iterate(&mut self) -> Result<Iteration<R>, StepError<R>> {
        self.shooting.iterate()
    }

    /// Largest violation of limits and goal of the present motion, in deviations of weight 1.
    pub fn violation(&self) -> R {
        self.shooting.violation()
    }

    /// Cost of the present motion without the penalties of hard limits and goal.
    pub fn plain_cost(&self) -> R {
        self.shooting.plain_cost()
    }

    /// Begins a round with the multipliers that the last one found; ρ grows if `more`.
    fn next_round(&mut self, more: bool) -> Result<(), StepError<R>> {
        let Shooting { problem, nodes, end, penalty, damping, .. } = &mut self.shooting;
        for node in nodes.iter_mut().skip(1) {
            node.multiplier = problem.hard.multipliers(&node.x, &node.multiplier, *penalty);
        }
        end.goal = problem.goal_multipliers(&end.x, &end.goal, *penalty);
        if more {
            *penalty = *penalty * self.options.growth;
        }
        *damping = R::zero();
        for node in nodes.iter_mut() {
            (node.change, node.gain) = ([R::zero(); M], [[R::zero(); D]; M]);
        }
        self.shooting.cost = self.shooting.rollout(R::zero())?;
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
        while self.shooting.count < self.options.iterations {
            let iteration = self.iterate()?;
            match rounds.after(&iteration, self.shooting.is_stuck()) {
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
        Ok(Solution { status, cost, violation, iterations: self.shooting.count })
    }
}
