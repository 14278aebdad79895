use super::node::feedback;
use super::rollout::Rollout;
use super::shooting::{Progress, Shooting};
use super::{GoalMultipliers, Node, Plant, Problem};
use crate::discrete::StepError;
use crate::linear::add_scaled;
use crate::scalar::Real;

/// Law of the nodes that enter at the end, u = u* − K(x − x*): the regulator at the goal x*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terminal<R, const D: usize, const M: usize> {
    /// Control u* that holds the plant at the goal.
    pub u: [R; M],
    /// Gain K.
    pub gain: [[R; D]; M],
}

/// Bounds of the decisions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon<R, const D: usize, const M: usize> {
    /// Number of ticks of a node that enters, at least 1.
    pub ticks: u16,
    /// Number of iterations of a decision.
    pub iterations: u16,
    /// Maximum number of trials of an iteration's line search: each is a rollout, of half the part of the change of the one before.
    pub trials: u16,
    /// Scale ρ > 0 of the penalties of limits of the state and of the goal.
    pub penalty: R,
    /// Law of the nodes that enter; without it they keep the last control.
    pub terminal: Option<Terminal<R, D, M>>,
}

/// A decision: the first control of a motion, and its gain, u − K(x − x̄) until the next decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Action<R, const D: usize, const M: usize> {
    /// State x̄ from which the motion begins.
    pub x: [R; D],
    /// Control u within its limits.
    pub u: [R; M],
    /// Gain K; 0 for controls at a limit.
    pub gain: [[R; D]; M],
    /// Expected cost of the motion, penalties included.
    pub cost: R,
    /// Fall of the cost in the iterations; 0 if none lowered it.
    pub fall: R,
    /// Largest violation of limits and goal along the motion, in deviations of weight 1.
    pub violation: R,
    /// Reason why the iterations ended before their number; the motion is then the best one so far.
    pub failed: Option<StepError<R>>,
}

/// Control over a receding horizon (model predictive control): at every decision a few iterations of iterative LQR.
///
/// The grid of nodes is fixed in time: the first node becomes shorter as ticks pass; when it is over, the others move up, and one of full
/// length enters at the end. A decision begins with the motion from the present state that follows the last one by its gains, may take
/// another one that is proposed, and improves it. Every motion meets the limits of the controls. Those of the states, and the goal, are
/// penalties of a fixed scale: a fixed number of iterations has no rounds of multipliers.
///
/// An angle is not wrapped: a state differs little from the one expected.
///
/// Source: Tassa, Erez and Todorov, "Synthesis and stabilization of complex behaviors through online trajectory optimization", 2012.
#[derive(Debug)]
pub struct RecedingHorizon<'n, P, R, const D: usize, const M: usize> {
    shooting: Shooting<'n, P, R, D, M>,
    horizon: Horizon<R, D, M>,
}

/// Moves the first nodes to the end, as [`slice::rotate_left`] does, but without its check: a program in which that call is not inlined could
/// panic.
fn rotate<T>(nodes: &mut [T], first: usize) {
    if let Some((first, rest)) = nodes.split_at_mut_checked(first)
        && !first.is_empty()
    {
        first.reverse();
        rest.reverse();
        nodes.reverse();
    }
}

/// Ticks that have passed: nodes that are over, and ticks of the next one.
#[derive(Clone, Copy, Debug)]
struct Passed {
    nodes: usize,
    ticks: u16,
}

impl<R: Real, const D: usize, const M: usize> Horizon<R, D, M> {
    /// Control of a node that enters at a state with the given deviation from the goal; `last` without a law.
    fn entering(&self, deviation: &[R; D], last: [R; M]) -> [R; M] {
        self.terminal.as_ref().map_or(last, |Terminal { u, gain }| feedback((u, gain), deviation))
    }

    /// Gain of a node that enters.
    fn entering_gain(&self) -> [[R; D]; M] {
        self.terminal.map_or([[R::zero(); D]; M], |terminal| terminal.gain)
    }
}

impl<'n, P: Plant<R, D, M>, R: Real, const D: usize, const M: usize> RecedingHorizon<'n, P, R, D, M> {
    /// Begins with the motion from x that follows the states of the nodes by their gains; nodes of [`Node::new`] have none.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed.
    pub fn new(
        problem: Problem<P, R, D, M>,
        horizon: Horizon<R, D, M>,
        x: [R; D],
        nodes: &'n mut [Node<R, D, M>],
    ) -> Result<Self, StepError<R>> {
        for node in nodes.iter_mut() {
            node.multiplier = [R::zero(); D];
        }
        let shooting =
            Shooting::new(problem, (x, nodes), GoalMultipliers::none(), (horizon.penalty, horizon.trials))?;
        Ok(Self { shooting, horizon })
    }

    /// Goes on after the decision whose progress and nodes these are, with a plant of the same mechanism: for a caller that holds both between
    /// decisions, and the plant elsewhere.
    pub fn resume(
        problem: Problem<P, R, D, M>,
        horizon: Horizon<R, D, M>,
        progress: Progress<R, D>,
        nodes: &'n mut [Node<R, D, M>],
    ) -> Self {
        let shooting = Shooting::resume(problem, nodes, progress, (horizon.penalty, horizon.trials));
        Self { shooting, horizon }
    }

    /// Progress of the search, with which it can be [resumed](Self::resume).
    pub fn progress(&self) -> Progress<R, D> {
        self.shooting.progress()
    }

    /// Control of the present motion after some ticks, at a state from which no motion may be computed: by the gains about the states of the
    /// nodes, and about those in between in proportion. `None` beyond the end, and for a state that is not finite.
    pub fn held(&self, elapsed: u16, x: &[R; D]) -> Option<[R; M]> {
        let Passed { nodes: passed, ticks } = self.passed(elapsed);
        let Shooting { problem, nodes, end, .. } = &self.shooting;
        let node = nodes.get(passed)?;
        let next = nodes.get(passed + 1).map_or(&end.x, |node| &node.x);
        let part = R::constant(f64::from(ticks)) / R::constant(f64::from(node.ticks));
        let reference = add_scaled(&node.x, part, &add_scaled(next, -R::one(), &node.x));
        let u = node.followed(&reference, x);
        u.iter().all(|u| u.is_finite()).then(|| problem.controls.clamped(&u))
    }

    /// Nodes of the present motion.
    pub fn nodes(&self) -> &[Node<R, D, M>] {
        self.shooting.nodes
    }

    /// State at the end of the present motion.
    pub fn end(&self) -> &[R; D] {
        &self.shooting.end.x
    }

    /// Expected cost of the present motion, penalties included.
    pub fn cost(&self) -> R {
        self.shooting.cost
    }

    /// Decides at the state x, `elapsed` ticks after the last decision: [`follow`](Self::follow), then [`improve`](Self::improve).
    ///
    /// # Errors
    /// [`StepError`] if no motion from x can be computed; nothing changes.
    pub fn decide(&mut self, elapsed: u16, x: &[R; D]) -> Result<Action<R, D, M>, StepError<R>> {
        self.follow(elapsed, x)?;
        Ok(self.improve())
    }

    /// Passes some ticks, and begins the present motion anew from the state x, by the last motion with its gains.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed; nothing changes.
    pub fn follow(&mut self, elapsed: u16, x: &[R; D]) -> Result<(), StepError<R>> {
        let passed = self.passed(elapsed);
        let cost = self.rollout_after(&passed, x)?;
        if !cost.is_finite() {
            return Err(StepError::NotFinite);
        }
        let gain = self.horizon.entering_gain();
        let Shooting { nodes, .. } = &mut self.shooting;
        let remaining = nodes.len().saturating_sub(passed.nodes);
        rotate(nodes, passed.nodes);
        for node in nodes.iter_mut().skip(remaining) {
            (node.change, node.gain) = ([R::zero(); M], gain);
        }
        self.take(cost);
        Ok(())
    }

    /// Takes another motion from the present state if it costs less, and returns whether it does: the first nodes have the given controls,
    /// the others those of nodes that enter. The gains of given controls are 0 until the next iteration.
    ///
    /// # Errors
    /// [`StepError`] if this motion cannot be computed; nothing changes.
    pub fn propose(&mut self, controls: &[[R; M]]) -> Result<bool, StepError<R>> {
        let cost = self.rollout_of(controls)?;
        let lower = cost < self.shooting.cost;
        if lower {
            let entering = self.horizon.entering_gain();
            for (k, node) in self.shooting.nodes.iter_mut().enumerate() {
                let gain = if k < controls.len() { [[R::zero(); D]; M] } else { entering };
                (node.change, node.gain) = ([R::zero(); M], gain);
            }
            self.take(cost);
        }
        Ok(lower)
    }

    /// Iterates as often as a decision may, and returns the first control. An iteration that fails ends them; the motion before it stays.
    pub fn improve(&mut self) -> Action<R, D, M> {
        let before = self.shooting.cost;
        let each = (0..self.horizon.iterations).map(|_| self.shooting.iterate());
        let failed = each.filter_map(Result::err).next();
        let (cost, violation, fall) =
            (self.shooting.cost, self.shooting.violation(), before - self.shooting.cost);
        let (x, u, gain) = self.first();
        Action { x, u, gain, cost, fall, violation, failed }
    }

    /// State, control and gain of the first node; those of a node that enters, if there is none.
    fn first(&self) -> ([R; D], [R; M], [[R; D]; M]) {
        let Shooting { problem, nodes, end, .. } = &self.shooting;
        nodes.first().map_or_else(
            || {
                let u = self.horizon.entering(&problem.cost.deviation(&end.x), [R::zero(); M]);
                (end.x, problem.controls.clamped(&u), self.horizon.entering_gain())
            },
            |node| (node.x, node.u, node.gain),
        )
    }

    /// Makes the trial motion the present one.
    fn take(&mut self, cost: R) {
        self.shooting.cost = cost;
        self.shooting.accept();
    }

    /// Nodes that are over after some ticks; beyond the horizon, nodes that entered have passed, too.
    fn passed(&self, elapsed: u16) -> Passed {
        let mut ticks = elapsed;
        for (nodes, node) in self.shooting.nodes.iter().enumerate() {
            if ticks < node.ticks {
                return Passed { nodes, ticks };
            }
            ticks -= node.ticks;
        }
        Passed { nodes: self.shooting.nodes.len(), ticks: ticks % self.horizon.ticks.max(1) }
    }

    /// State at which the last motion is after some ticks; `x` beyond its end.
    fn expected(&self, passed: &Passed, x: &[R; D]) -> Result<[R; D], StepError<R>> {
        let plant = &self.shooting.problem.plant;
        match self.shooting.nodes.get(passed.nodes) {
            Some(node) if passed.ticks == 0 => Ok(node.x),
            Some(node) => {
                plant.advance(&mut plant.begin(&node.x)?, (passed.ticks, &node.u), &mut [R::zero(); D])
            }
            None => Ok(*x),
        }
    }

    /// Computes the trial motion from x after some ticks; the nodes that are over are the last ones of it. Returns its cost.
    fn rollout_after(&mut self, passed: &Passed, x: &[R; D]) -> Result<R, StepError<R>> {
        let (expected, horizon) = (self.expected(passed, x)?, &self.horizon);
        let Shooting { problem, nodes, end, penalty, .. } = &mut self.shooting;
        let mut u = nodes.last().map_or([R::zero(); M], |node| node.u);
        let (over, left) = nodes.split_at_mut(passed.nodes.min(nodes.len()));
        let remaining = left.len();
        let mut rollout = Rollout::begin(problem, *penalty, *x)?;
        for (k, node) in left.iter_mut().chain(over).enumerate() {
            let (reference, gone) = if k == 0 { (expected, passed.ticks) } else { (node.x, 0) };
            let (ticks, wanted) = if k < remaining {
                (node.ticks, node.followed(&reference, &rollout.x))
            } else {
                (horizon.ticks, horizon.entering(&problem.cost.deviation(&rollout.x), u))
            };
            u = rollout.pass(node, (ticks.saturating_sub(gone), wanted))?;
        }
        Ok(rollout.end(end))
    }

    /// Computes the trial motion from the present state under controls, and under those of nodes that enter after them; returns its cost.
    fn rollout_of(&mut self, controls: &[[R; M]]) -> Result<R, StepError<R>> {
        let (start, horizon) = (self.shooting.start(), &self.horizon);
        let Shooting { problem, nodes, end, penalty, .. } = &mut self.shooting;
        let mut u = [R::zero(); M];
        let mut rollout = Rollout::begin(problem, *penalty, start)?;
        for (k, node) in nodes.iter_mut().enumerate() {
            let entering = || horizon.entering(&problem.cost.deviation(&rollout.x), u);
            let wanted = controls.get(k).copied().unwrap_or_else(entering);
            u = rollout.pass(node, (node.ticks, wanted))?;
        }
        Ok(rollout.end(end))
    }
}
