//! A swing-up that is planned once, followed by time-varying LQR, and held by LQR.

use super::driven::{Driven, wave};
use super::economical;
use super::plant::{DoublePendulum, State, UPRIGHT};
use super::policy::{ControlError, Maker, Policy, Robot, TICK, TORQUE_LIMIT};
use leastaction_core::control::riccati::{Regulator, Weights, back, stationary};
use leastaction_core::control::{Cost, Ilqr, Limits, Node, Options, Penalty, Plant, Problem};
use leastaction_core::linear::{dot, identity, multiply, solve_columns};
use leastaction_core::scalar::Real;
use leastaction_models::parallel;
use std::array::from_fn;
use std::sync::Arc;

/// Duration of the swing-up, s.
const SECONDS: f64 = 2.0;
/// Number of ticks over which the plan holds a torque.
const TICKS: u16 = 5;
/// Largest torque of the plan, N m; the rest is for feedback.
const PLANNED: f64 = 4.5;
/// Number of searches, each from a random wave.
const STARTS: usize = 8;
/// Maximum number of iterations of a search.
const ITERATIONS: u16 = 300;
/// Largest accepted deviation of the plan's end from upright, rad or rad/s.
const ACCEPTED: f64 = 1e-4;
/// Deviations of equal weight for the gains: rad, rad/s and N m.
const DEVIATIONS: [f64; 3] = [0.1, 1.0, 3.0];
/// Largest δxᵀPδx, in that within which the linear feedback stays inside the torque, at which upright is held from now on, and at which it is
/// held on.
const REACH: [f64; 2] = [4.0, 100.0];
/// Largest δxᵀPδx in the same unit at which a plan has ended.
const SETTLED: f64 = 0.01;

/// A state of the plan with its torque and regulator.
#[derive(Clone, Copy, Debug)]
struct Planned {
    x: State,
    u: f64,
    regulator: Regulator<f64, 4, 1>,
    /// Largest δxᵀPδx at which the feedback stays within the torque.
    reach: f64,
}

/// A plan with its gains, tick by tick, and the regulator at its end.
///
/// The plan begins again from its start where upright is out of reach, wherever the pendulum is: a baseline, as the competition's own.
#[derive(Clone, Debug)]
pub struct Tvlqr {
    ticks: Vec<Planned>,
    end: Planned,
}

impl Planned {
    fn new(x: State, u: f64, regulator: Regulator<f64, 4, 1>) -> Self {
        let [gain] = &regulator.gain;
        // |K δx| ≤ m holds on δxᵀPδx ≤ m²/(K P⁻¹ Kᵀ).
        let margin = TORQUE_LIMIT - u.abs();
        let inverse = solve_columns(regulator.cost, &identity());
        let reach = inverse.map_or(0.0, |inverse| margin * margin / dot(gain, &multiply(&inverse, gain)));
        Self { x, u, regulator, reach }
    }

    /// Deviation of a state, angles the short way round.
    fn deviation(&self, x: &State) -> State {
        from_fn(|i| if i < 2 { (x[i] - self.x[i]).short_way() } else { x[i] - self.x[i] })
    }

    /// Torque u − K δx, N m.
    fn torque(&self, x: &State) -> f64 {
        self.u - dot(&self.regulator.gain[0], &self.deviation(x))
    }

    /// δxᵀPδx over that within which the feedback stays within the torque.
    fn distance(&self, x: &State) -> f64 {
        let dx = self.deviation(x);
        dot(&dx, &multiply(&self.regulator.cost, &dx)) / self.reach
    }
}

impl Tvlqr {
    /// Plans the swing-up.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn plan(robot: Robot, model: &DoublePendulum) -> Result<Self, ControlError> {
        let plant = Driven { pendulum: *model, robot };
        let found = parallel::map(STARTS, &|start| search(plant, start as u64));
        let mut best: Option<Found> = None;
        let mut violation = f64::INFINITY;
        for found in found {
            let found = found?;
            violation = violation.min(found.violation);
            if found.violation <= ACCEPTED && best.as_ref().is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
        }
        let found = best.ok_or(ControlError::NoSwingUp { starts: STARTS, violation })?;
        let each = found.torques.into_iter().flat_map(|u| std::iter::repeat_n(u, usize::from(TICKS)));
        Self::with_gains(plant, &plant.ticks([0.0; 4], each).collect::<Vec<_>>())
    }

    /// Follows the swing-up of the best score.
    ///
    /// # Errors
    /// [`ControlError`].
    pub fn economical(robot: Robot, model: &DoublePendulum) -> Result<Self, ControlError> {
        Self::with_gains(Driven { pendulum: *model, robot }, &economical::plan(robot, model)?)
    }

    /// Gains along a motion, from the state and the torque of every tick.
    fn with_gains(plant: Driven, motion: &[(State, f64)]) -> Result<Self, ControlError> {
        let [q, v, u] = DEVIATIONS.map(|deviation| 1.0 / (deviation * deviation));
        let weights = Weights { x: [q, q, v, v], u: [u] };
        let about = plant.linearise_at(&UPRIGHT, (1, &[0.0])).map_err(ControlError::Motion)?;
        let end = stationary(&about, &weights).map_err(ControlError::Regulator)?;
        let (mut ticks, mut cost) = (Vec::new(), end.cost);
        for (x, u) in motion.iter().rev() {
            let transition = plant.linearise_at(x, (1, &[*u])).map_err(ControlError::Motion)?;
            let regulator =
                back(&transition, &weights, &cost).map_err(|error| ControlError::Regulator(error.into()))?;
            cost = regulator.cost;
            ticks.push(Planned::new(*x, *u, regulator));
        }
        ticks.reverse();
        let end = Planned::new(UPRIGHT, 0.0, end);
        let settled = ticks.iter().rev().take_while(|node| end.distance(&node.x) <= SETTLED).count();
        ticks.truncate(ticks.len() - settled);
        Ok(Self { ticks, end })
    }

    /// Maker of policies.
    pub fn maker<'m>(self) -> Maker<'m> {
        let law = Arc::new(self);
        Box::new(move || Box::new(Self::policy(&law)))
    }

    /// Policy of one run.
    pub fn policy(law: &Arc<Self>) -> Following {
        Following { law: Arc::clone(law), begun: None, last: f64::NEG_INFINITY }
    }
}

/// Result of a search.
struct Found {
    torques: Vec<f64>,
    cost: f64,
    violation: f64,
}

/// Searches for a swing-up from a random wave.
fn search(plant: Driven, seed: u64) -> Result<Found, ControlError> {
    let node = f64::from(TICKS) * TICK;
    let count = (SECONDS / node).round() as usize;
    let wave = wave(seed, 1.0..PLANNED, 0.5..2.0, node);
    let mut nodes: Vec<Node<f64, 4, 1>> = (0..count).map(|k| Node::new(TICKS, [wave(k)])).collect();
    let options =
        Options { iterations: ITERATIONS, tolerance: 1e-5, violation: ACCEPTED, penalty: 1.0, growth: 10.0 };
    let problem = problem(plant);
    let mut search = Ilqr::new(problem, options, [0.0; 4], &mut nodes).map_err(ControlError::Motion)?;
    let solution = search.solve(|_| true).map_err(ControlError::Motion)?;
    let torques = search.nodes().iter().map(|node| node.u[0]).collect();
    Ok(Found { torques, cost: solution.cost, violation: solution.violation })
}

/// Upright at rest by little torque.
fn problem(plant: Driven) -> Problem<Driven, f64, 4, 1> {
    let weight = TICK / (PLANNED * PLANNED);
    Problem {
        plant,
        cost: Cost {
            goal: UPRIGHT,
            turns: [true, true, false, false],
            x: [0.0; 4],
            u: [weight],
            end: [[0.0; 4]; 4],
        },
        controls: Limits { least: [-PLANNED], most: [PLANNED] },
        hard: Penalty::none(),
        soft: Penalty::none(),
        goal: Penalty { limits: Limits { least: UPRIGHT, most: UPRIGHT }, weights: [1.0; 4] },
        energy: Penalty::none(),
    }
}

/// The law in one run.
#[derive(Clone, Debug)]
pub struct Following {
    law: Arc<Tvlqr>,
    /// Time at which the plan began, s; `None` while upright is held.
    begun: Option<f64>,
    /// Time of the last call, s.
    last: f64,
}

impl Following {
    /// Beginning of the plan for a state: upright is held where it is near, and a plan that was not interrupted goes on to its end.
    fn begun(&self, t: f64, x: &State) -> Option<f64> {
        let Tvlqr { ticks, end, .. } = &*self.law;
        let distance = end.distance(x);
        let goes_on = t - self.last < 1.5 * TICK;
        match self.begun {
            None if goes_on && distance <= REACH[1] => None,
            Some(begun) if goes_on && index(t, begun) < ticks.len() => Some(begun),
            _ if distance <= REACH[0] => None,
            _ => Some(t),
        }
    }
}

/// Tick of a plan that began at a time.
fn index(t: f64, begun: f64) -> usize {
    ((t - begun) / TICK).round() as usize
}

impl Policy for Following {
    fn reset(&mut self) {
        (self.begun, self.last) = (None, f64::NEG_INFINITY);
    }

    fn torque(&mut self, t: f64, q: [f64; 2], v: [f64; 2]) -> f64 {
        let x = [q[0], q[1], v[0], v[1]];
        self.begun = self.begun(t, &x);
        self.last = t;
        let Tvlqr { ticks, end } = &*self.law;
        let node = self.begun.and_then(|begun| ticks.get(index(t, begun))).unwrap_or(end);
        node.torque(&x).clamp(-TORQUE_LIMIT, TORQUE_LIMIT)
    }
}
