use super::{GoalMultipliers, Node, Plant, Problem};
use crate::discrete::StepError;
use crate::scalar::Real;

/// The last state of a motion.
#[derive(Clone, Copy, Debug)]
pub struct End<R, const D: usize> {
    /// State.
    pub x: [R; D],
    /// Multipliers of the goal.
    pub goal: GoalMultipliers<R, D>,
    /// State of the trial under way.
    pub trial: [R; D],
}

impl<R: Real, const D: usize> End<R, D> {
    /// An end whose state is unknown.
    pub fn new(x: [R; D], goal: GoalMultipliers<R, D>) -> Self {
        Self { x, goal, trial: x }
    }
}

/// A trial motion under way: it is written to the trials of nodes, whose present motion stays as it is.
pub struct Rollout<'p, P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> {
    problem: &'p Problem<P, R, D, M>,
    /// Scale ρ of the penalties.
    penalty: R,
    motion: P::Motion,
    /// State so far.
    pub x: [R; D],
    cost: R,
    /// Whether no node has been passed.
    first: bool,
}

impl<'p, P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> Rollout<'p, P, R, D, M> {
    /// Begins at a state.
    ///
    /// # Errors
    /// [`StepError`] if a number is not finite.
    pub fn begin(problem: &'p Problem<P, R, D, M>, penalty: R, x: [R; D]) -> Result<Self, StepError<R>> {
        let motion = problem.plant.begin(&x)?;
        Ok(Self { problem, penalty, motion, x, cost: R::zero(), first: true })
    }

    /// Passes a node of some ticks under a control, moved into its limits; returns the control.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed.
    pub fn pass(
        &mut self,
        node: &mut Node<R, D, M>,
        (ticks, u): (u16, [R; M]),
    ) -> Result<[R; M], StepError<R>> {
        let (problem, trial) = (self.problem, &mut node.trial);
        let u = problem.controls.clamped(&u);
        (trial.x, trial.u, trial.ticks) = (self.x, u, ticks);
        self.cost += problem.node_cost((ticks, &self.x, &u), self.first);
        if !self.first {
            self.cost += problem.hard.value(&self.x, &node.multiplier, self.penalty);
        }
        self.first = false;
        self.x = problem.plant.advance(&mut self.motion, (ticks, &u), &mut trial.course)?;
        Ok(u)
    }

    /// Ends the motion, and returns its augmented cost.
    pub fn end(self, end: &mut End<R, D>) -> R {
        end.trial = self.x;
        self.cost + self.problem.end_cost(&self.x, &end.goal, self.penalty)
    }
}
