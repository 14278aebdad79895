use super::clock::Clock;
use super::{Aim, Command, Known, Law, Library, Setting, Starts, State};
use crate::configured::exactly;
use crate::plant::Widened;
use crate::problem::{array, ends};
use crate::{PlanError, Task};
use leastaction_core::control::riccati::RegulatorError;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_models::Model;
use leastaction_replica::{Replica, StateVisitor, SystemOf};
use std::array::from_fn;
use std::sync::Arc;

/// A policy for a model: motions from many starts to the goal, and the laws that use them.
pub struct Policy<'c> {
    prepared: Box<dyn Prepared<'c> + 'c>,
    n: usize,
    tick: f64,
}

/// The law of one mechanism.
pub struct Decider<'c> {
    law: Box<dyn Deciding + 'c>,
    n: usize,
    clock: Clock,
}

/// Decision at a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// Command of every coordinate, within the limits; 0 for those that are not driven.
    pub u: Vec<f64>,
    /// State of the law.
    pub state: State,
    /// Whether a motion was searched in this tick.
    pub searched: bool,
}

/// Knowledge whose sizes are types.
trait Prepared<'c>: Send + Sync {
    fn begin(&self) -> Box<dyn Deciding + 'c>;
    fn seconds(&self) -> Vec<f64>;
}

/// A law whose sizes are types.
trait Deciding: Send {
    fn decide(&mut self, x: &[f64], elapsed: usize) -> Decision;
}

impl<'c> Policy<'c> {
    /// Searches motions to the goal of a task from `policy.starts` states, the task's start among them. The longest motion has the task's
    /// longest time. `watch` sees the number of starts that were searched after every search, and ends them by returning `false`; a start from
    /// which nothing was found is tried again at the end.
    ///
    /// # Errors
    /// [`PlanError::Value`] if the goal is no posture at rest that the drives can hold, [`PlanError::Motion`] for a model without states of a
    /// fixed size, and if no motion reaches the goal.
    pub fn new(
        (replica, model): (&'c Replica<'c>, &Model),
        task: &Task,
        watch: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<Self, PlanError> {
        let prepared = replica.visit_states(Preparing { model, task, watch })?;
        Ok(Self { prepared, n: replica.n(), tick: task.tick })
    }

    /// A law that begins anywhere; laws of one policy know nothing of each other.
    pub fn begin(&self) -> Decider<'c> {
        Decider { law: self.prepared.begin(), n: self.n, clock: Clock::new(self.tick) }
    }

    /// Durations of the motions that were found, s.
    pub fn seconds(&self) -> Vec<f64> {
        self.prepared.seconds()
    }
}

impl Decider<'_> {
    /// Decides at a state (q, v) and a time, s, which is rounded to ticks since the first decision; without times, decisions are a tick apart.
    ///
    /// # Errors
    /// [`PlanError::Value`] for numbers that are no state of the model, for a time that is not finite or goes back by a tick, and for times
    /// in only some calls. The law is then unchanged.
    pub fn decide(&mut self, [q, v]: [&[f64]; 2], t: Option<f64>) -> Result<Decision, PlanError> {
        let x = [exactly("q", self.n, q)?, exactly("v", self.n, v)?].concat();
        let (clock, elapsed) = self.clock.at(t)?;
        self.clock = clock;
        Ok(self.law.decide(&x, elapsed))
    }
}

/// A policy whose sizes become types.
struct Preparing<'t> {
    model: &'t Model,
    task: &'t Task,
    watch: &'t (dyn Fn(usize) -> bool + Sync),
}

impl<'c> StateVisitor<'c> for Preparing<'_> {
    type Output = Result<Box<dyn Prepared<'c> + 'c>, PlanError>;

    fn states<const N: usize, const D: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        let setting = self.setting::<N, D>(system)?;
        let start = array::<D>(&self.task.start);
        let library =
            Library::build(&setting, &self.starts(system), (&[start], self.task.policy.starts), self.watch);
        if library.motions.is_empty() && !setting.catches(&start) {
            let message = "no motion reaches the goal from anywhere within these limits and this time";
            return Err(PlanError::Motion(message.to_owned()));
        }
        Ok(Box::new(Arc::new(Known { setting, library })))
    }

    fn graph(self) -> Self::Output {
        let message = "graphs of particles have no policy; inertia networks and trees have";
        Err(PlanError::Motion(message.to_owned()))
    }
}

/// Largest velocity of starts that are thrown, in speeds.
const THROW: f64 = 2.0;
/// Longest time after a throw, s.
const THROWN: f64 = 0.3;
/// Unit of equal weight, in distances within which the regulator is tried.
const UNIT: f64 = 2.0;

impl Preparing<'_> {
    fn setting<'c, const N: usize, const D: usize>(
        &self,
        system: &'c SystemOf<'c, N>,
    ) -> Result<Setting<Widened<'c, N>, D, N>, PlanError> {
        let Task { tick, ticks_per_node, .. } = *self.task;
        let aim = self.aim::<N, D>()?;
        let (held, holds) = self.task.holding(system, self.model, &aim.goal);
        let unheld = || {
            let message = "is no posture that the drives can hold; a policy needs one that they do";
            PlanError::value("goal.q", message)
        };
        if !holds {
            return Err(unheld());
        }
        // The step of a model that learned its own is not scaled.
        let stride = if self.model.facts.trained_step.is_some() { 1 } else { ticks_per_node };
        let plant = self.task.striding(system, self.model, stride);
        Setting::new(plant, (tick, ticks_per_node), aim, held).map_err(|error| match error {
            RegulatorError::NotStabilisable => unheld(),
            error => PlanError::Motion(format!("no regulator about the goal: {error}")),
        })
    }

    fn aim<const N: usize, const D: usize>(&self) -> Result<Aim<D, N>, PlanError> {
        let Task { goal, limits, cost, policy, .. } = self.task;
        let posture = goal.energy.is_none() && goal.state.iter().all(|[least, most]| least == most);
        if !posture || goal.state.iter().skip(N).any(|[v, _]| *v != 0.0) {
            return Err(PlanError::value("goal", "is no posture at rest; a policy needs one: give q alone"));
        }
        let catch = array(&policy.catch);
        Ok(Aim {
            goal: array(&goal.middle()),
            turns: from_fn(|i| goal.turns[i]),
            unit: catch.map(|x: f64| UNIT * x),
            catch,
            weights: self.task.weights(),
            effort: array(&cost.u),
            controls: limits.commands(|i| limits.u[i]),
            planned: limits.commands(|i| limits.planned(i)),
            states: ends(&limits.x),
            longest: *self.task.nodes.end(),
        })
    }

    /// Starts whose velocities are those that the energy between start and goal makes.
    fn starts<const N: usize, const D: usize>(&self, system: &SystemOf<N>) -> Starts<D> {
        let Task { start, goal, policy, search, limits, .. } = self.task;
        let goal = goal.middle();
        let at = |x: &[f64]| from_fn(|i| x.get(i).copied().unwrap_or_default() as f32);
        let rest = [0.0; N];
        let energy = |x: &[f64]| system.energies(&at(x), &rest).potential;
        let lift = f64::from((energy(&goal) - energy(start)).abs());
        let mass = system.lagrangian.linearization(&at(&goal), &rest).l_vv;
        let speed = |i: usize| match &policy.speeds {
            Some(speeds) => speeds[i],
            None => (2.0 * lift / f64::from(mass[i][i])).sqrt(),
        };
        let way = |i: usize| {
            let [least, most] = limits.x[i];
            let within = 0.5 * (most - least);
            if within.is_finite() { within } else { (goal[i] - start[i]).abs().max(1.0) }
        };
        Starts {
            seed: search.seed,
            spread: from_fn(|i| if i < N { way(i) } else { speed(i - N) }),
            throw: from_fn(|i| if i < N { 0.0 } else { THROW * speed(i - N) }),
            seconds: THROWN,
        }
    }
}

impl<'c, const N: usize, const D: usize> Prepared<'c> for Arc<Known<Widened<'c, N>, D, N>> {
    fn begin(&self) -> Box<dyn Deciding + 'c> {
        Box::new(Law::new(Arc::clone(self)))
    }

    fn seconds(&self) -> Vec<f64> {
        let node = self.setting.seconds();
        self.library.motions.iter().map(|motion| motion.x.len() as f64 * node).collect()
    }
}

impl<const N: usize, const D: usize> Deciding for Law<Widened<'_, N>, D, N> {
    fn decide(&mut self, x: &[f64], elapsed: usize) -> Decision {
        let Command { u, state, searched } = self.command(&array(x), elapsed);
        Decision { u: u.to_vec(), state, searched }
    }
}
