use super::mpc_settings::MpcSettings;
use super::plans::{Plans, check_plans};
use super::regulator::joined;
use super::{Command, Controller, Float, Target};
use crate::angle::wrap;
use crate::devices::{ActuatorConfig, Drive};
use crate::error::{SetupError, require};
use crate::observer::{ObserverConfig, Order};
use crate::tick::Mode;
use crate::{Mechanism, Program};
use core::array::from_fn;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::control::riccati::{Weights, stationary};
use leastaction_core::control::{
    Cost, Horizon, Limits, Node, Penalty, Problem, Progress, RecedingHorizon, Stepped, Terminal, sample,
};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Path, StepError};
use leastaction_core::forces::Actuator;
use leastaction_core::linear::add_scaled;
use leastaction_core::plan::{Plan, PlanHeader};

/// Number of nodes of a decision's motion.
pub const NODES: usize = 25;
/// Largest acceleration of a held goal, as a part of the tolerance of velocities, 1/s.
const HELD: f32 = 0.25;

/// Memory of a decision's motion.
pub type Nodes<const N: usize, const D: usize> = [Node<f32, D, N>; NODES];

/// Memory for decisions, which in a static takes no flash.
pub const fn blank_nodes<const N: usize, const D: usize>() -> Nodes<N, D> {
    [Node::blank(0.0); NODES]
}

/// Control over a receding horizon: at every tick, a motion from the estimated state to a goal posture, improved by a fixed number of iterations
/// of iterative LQR within the limits of the actuators; its first command is given. D is 2N. The motion is in the caller's memory.
///
/// A control is a command minus the one that holds the mechanism at the goal, so that holding costs nothing. A coordinate whose limit is 0
/// has no control. Every decision begins with the last motion and takes another one that costs less: the regulator at the goal, the rest of
/// a plan, and commands at random. Among several plans, the one that passes nearest to the state is taken, from its nearest point. The motion
/// ends with the regulator's cost to go.
///
/// From a state from which no motion can be computed, the last one is followed by its gains to its end ([`Mode::Track`]); after it, or
/// without one, the mechanism is held against gravity with damping ([`Mode::Float`]); if the model cannot do that either, the firmware
/// commands no force ([`Mode::Safe`]).
#[derive(Debug)]
pub struct Mpc<'p, const N: usize, const D: usize> {
    settings: MpcSettings<N>,
    tick: f32,
    observer: ObserverConfig,
    actuator: ActuatorConfig<N>,
    /// Command that holds the mechanism at the goal.
    hold: [f32; N],
    cost: Cost<f32, D, N>,
    horizon: Horizon<f32, D, N>,
    plans: Plans<'p, N>,
    nodes: &'p mut Nodes<N, D>,
    progress: Option<Progress<f32, D>>,
    /// Number of ticks since the last decision.
    elapsed: u32,
    /// Number of decisions, and seed of their samples.
    decisions: u32,
}

/// The plant of decisions over a mechanism.
type Of<'m, M, P, const N: usize> =
    Stepped<'m, <M as Mechanism<N>>::Lagrangian, <M as Mechanism<N>>::Forces, f32, P, N, N>;

impl<'p, const N: usize, const D: usize> Mpc<'p, N, D> {
    /// Creates the controller of a program over `nodes`, whatever they hold; `plans`, which were made for this model, are proposed if the
    /// settings say so.
    ///
    /// # Errors
    /// Settings out of range ([`SetupError::OutOfRange`]), also a goal that takes more than the actuators' limits, or at which the held model
    /// accelerates by more than a quarter of the tolerance of velocities in a second, and a stride that a model does not have that learned
    /// its own step; [`SetupError::SingularInertia`]; [`SetupError::NotStabilisable`] if no feedback holds the model at the goal;
    /// [`SetupError::NoPlan`], [`SetupError::PlanTick`] and [`SetupError::PlanAngle`].
    pub fn new<M: Mechanism<N>>(
        model: &M,
        settings: MpcSettings<N>,
        program: &Program<N>,
        plans: Plans<'p, N>,
        nodes: &'p mut Nodes<N, D>,
    ) -> Result<Self, SetupError> {
        settings.validate()?;
        settings.check_stride(model.trained_step(), program.observer.other_step)?;
        settings.plan.map_or(Ok(()), |_| check_plans(&plans, program))?;
        let Program { tick, observer, actuator, .. } = *program;
        let hold = holding(model, &settings, &actuator)?;
        let MpcSettings { ticks, iterations, trials, .. } = settings;
        nodes.fill(Node::new(ticks, [0.0; N]));
        let mut new = Self {
            settings,
            tick,
            observer,
            actuator,
            hold,
            cost: settings.cost(tick, program.angle, &actuator.drive),
            horizon: Horizon { ticks, iterations, trials, penalty: 1.0, terminal: None },
            plans,
            nodes,
            progress: None,
            elapsed: 0,
            decisions: 0,
        };
        new.regulate(model)?;
        Ok(new)
    }

    /// Nodes of the last decision's motion, which the model predicts under the motion's controls; none before the first decision.
    pub fn motion(&self) -> &[Node<f32, D, N>] {
        if self.progress.is_some() { self.nodes.as_slice() } else { &[] }
    }

    /// Designs the regulator of nodes that enter, and takes its cost to go as that of the end.
    fn regulate<M: Mechanism<N>>(&mut self, model: &M) -> Result<(), SetupError> {
        let (goal, at) = (self.settings.goal, (self.horizon.ticks, &[0.0; N]));
        let transition = match self.observer.order {
            Order::Two => self.plant::<M, Midpoint>(model).linearise_rest(&goal, at),
            Order::Four => self.plant::<M, Galerkin>(model).linearise_rest(&goal, at),
        };
        let ticks = f32::from(self.horizon.ticks);
        let weights = Weights { x: self.cost.x.map(|w| ticks * w), u: self.cost.u.map(|w| ticks * w) };
        let transition = transition.map_err(|_| SetupError::NotStabilisable)?;
        let regulator = stationary(&transition, &weights).map_err(|_| SetupError::NotStabilisable)?;
        self.cost.end = regulator.cost;
        self.horizon.terminal = Some(Terminal { u: [0.0; N], gain: regulator.gain });
        Ok(())
    }

    /// The model as a plant whose controls are commands beyond those that hold it at the goal.
    fn plant<'m, M: Mechanism<N>, P: Path>(&self, model: &'m M) -> Of<'m, M, P, N> {
        let Drive { gain, offset } = self.actuator.drive;
        let offset = from_fn(|i| offset[i] + gain[i] * self.hold[i]);
        // No coordinate has the number N: such a control drives nothing.
        let inputs = from_fn(|i| if self.actuator.limit[i] > 0.0 { i } else { N });
        let del = Del::with_newton(self.tick, self.observer.newton);
        let actuator = Actuator { gain, offset, delay: 0.0 };
        Stepped { system: model.system(), del, actuator, inputs, stride: self.settings.stride }
    }

    /// Range of the controls.
    fn controls(&self) -> Limits<f32, N> {
        let limit = self.actuator.limit;
        Limits { least: from_fn(|i| -limit[i] - self.hold[i]), most: from_fn(|i| limit[i] - self.hold[i]) }
    }

    /// The problem of a decision.
    fn problem<P>(&self, plant: P, controls: Limits<f32, N>) -> Problem<P, f32, D, N> {
        let none = Penalty::none();
        let (cost, energy) = (self.cost, Penalty::none());
        Problem { plant, cost, controls, hard: none, soft: none, goal: none, energy }
    }

    /// The estimated state, angles next to those of the last decision.
    fn near(&self, state: &ContinuousState<f32, N>) -> [f32; D] {
        let x: [f32; D] = joined(&state.q, &state.v);
        let (first, turns) = (self.nodes.first().filter(|_| self.progress.is_some()), self.cost.turns);
        first.map_or(x, |last| from_fn(|i| if turns[i] { last.x[i] + wrap(x[i] - last.x[i]) } else { x[i] }))
    }

    /// Force of a control, N or N m.
    fn force(&self, u: &[f32; N]) -> [f32; N] {
        self.actuator.drive.force(&add_scaled(u, 1.0, &self.hold))
    }

    /// Decides from a state; without a motion from it, the control of the last one.
    fn decide<P: Path, M: Mechanism<N>>(
        &mut self,
        model: &M,
        x: &[f32; D],
    ) -> Result<([f32; N], Mode), StepError<f32>> {
        let controls = self.controls();
        let problem = self.problem(self.plant::<M, P>(model), controls);
        let (rest, random) = (self.rest_of_plan(x), self.random(&controls));
        let mut search = match self.progress {
            None => RecedingHorizon::new(problem, self.horizon, *x, self.nodes)?,
            Some(progress) => {
                let mut search = RecedingHorizon::resume(problem, self.horizon, progress, self.nodes);
                let elapsed = u16::try_from(self.elapsed).unwrap_or(u16::MAX);
                if let Err(error) = search.follow(elapsed, x) {
                    return search.held(elapsed, x).map(|u| (u, Mode::Track)).ok_or(error);
                }
                search
            }
        };
        let (plan, length) = rest.unwrap_or(([[0.0; N]; NODES], 0));
        for controls in [plan.get(..length), Some(&[]), random.as_ref().map(|u| u.as_slice())] {
            // A motion that cannot be computed is no better one.
            let _ = controls.map(|controls| search.propose(controls));
        }
        let action = search.improve();
        self.progress = Some(search.progress());
        (self.elapsed, self.decisions) = (0, self.decisions.wrapping_add(1));
        Ok((action.u, Mode::Mpc))
    }

    /// Controls at random, if this decision proposes any.
    fn random(&self, controls: &Limits<f32, N>) -> Option<[[f32; N]; NODES]> {
        let MpcSettings { sample_every, piece, .. } = self.settings;
        let due = self.decisions.checked_rem(sample_every.into()) == Some(0);
        due.then(|| {
            let mut random = [[0.0; N]; NODES];
            sample(self.decisions.into(), piece.into(), controls, &mut random);
            random
        })
    }

    /// Controls of a plan from the point nearest to the state, in deviations of equal weight, and the number of nodes up to its end.
    fn rest_of_plan(&self, x: &[f32; D]) -> Option<([[f32; N]; NODES], usize)> {
        let planned = self.settings.plan?;
        let points = self.plans.iter().flat_map(|plan| starts(plan).map(move |tick| (plan, tick)));
        let distances = points.map(|(plan, tick)| (plan, tick, self.distance(x, plan, tick)));
        let (plan, nearest, _) = distances.min_by(|a, b| a.2.total_cmp(&b.2))?;
        let at = |k: usize| nearest.saturating_add(k as u32 * u32::from(self.settings.ticks));
        let known = &self.actuator.drive;
        let control = |k: usize| {
            let force = planned.force(&plan.planned_force(at(k)));
            add_scaled(&known.command(&force), -1.0, &self.hold)
        };
        let left = (0..NODES).take_while(|k| at(*k) < plan.ticks()).count();
        Some((from_fn(control), left))
    }

    /// Sum of the squared deviations of equal weight between a state and a plan's at a tick.
    fn distance(&self, x: &[f32; D], plan: &Plan<N, N>, tick: u32) -> f32 {
        let at = plan.reference(tick);
        let away = Cost { goal: joined(&at.q, &at.v), ..self.cost }.deviation(x);
        away.iter().zip(self.cost.x).fold(0.0, |sum, (away, weight)| sum + weight * away * away)
    }
}

/// Ticks at which the nodes of a plan begin, and its end.
fn starts<const N: usize>(plan: &Plan<N, N>) -> impl Iterator<Item = u32> + use<N> {
    let &PlanHeader { nodes, ticks_per_node, .. } = plan.file().header();
    (0..=nodes).map(move |node| node.saturating_mul(ticks_per_node))
}

impl<const N: usize, const D: usize> Controller<N> for Mpc<'_, N, D> {
    fn read(&mut self, elapsed: u32, _: &[Option<f32>; N]) {
        self.elapsed = self.elapsed.saturating_add(elapsed);
    }

    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let x = self.near(state);
        let decided = match self.observer.order {
            Order::Two => self.decide::<Midpoint, M>(model, &x),
            Order::Four => self.decide::<Galerkin, M>(model, &x),
        };
        match decided {
            Ok((u, mode)) => Ok(Command { u: self.force(&u), mode }),
            Err(_) => Float { drag: self.settings.drag }.command(model, target, state),
        }
    }
}

/// No decisions; it has no values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoMpc {}

impl<const N: usize> Controller<N> for NoMpc {
    fn command<M: Mechanism<N>>(
        &mut self,
        _: &M,
        _: &Target<N>,
        _: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        match *self {}
    }
}

/// Command that holds a model at the goal, checked against the limits.
fn holding<M: Mechanism<N>, const N: usize>(
    model: &M,
    settings: &MpcSettings<N>,
    actuator: &ActuatorConfig<N>,
) -> Result<[f32; N], SetupError> {
    let (goal, rest) = (&settings.goal, [0.0; N]);
    model.velocity(goal, &rest).map_err(|_| SetupError::SingularInertia)?;
    let force = model.inverse_dynamics(goal, &rest, &rest).map_err(|_| SetupError::NotStabilisable)?;
    let command = actuator.drive.command(&force);
    let driven = |i: usize| actuator.limit[i] > 0.0;
    for (i, (u, limit)) in command.iter().zip(actuator.limit).enumerate() {
        let range = "within the limits of its actuator";
        require("command that holds the goal", *u, !driven(i) || u.abs() < limit, range)?;
    }
    let hold = from_fn(|i| if driven(i) { command[i] } else { 0.0 });
    let missing = add_scaled(&force, -1.0, &actuator.drive.force(&hold));
    let acceleration = model.velocity(goal, &missing).map_err(|_| SetupError::SingularInertia)?;
    for (a, tolerance) in acceleration.iter().zip(settings.tolerance.v) {
        let range = "small: no command of the driven coordinates holds the model there";
        require("acceleration at the goal", *a, a.abs() <= HELD * tolerance, range)?;
    }
    Ok(hold)
}
