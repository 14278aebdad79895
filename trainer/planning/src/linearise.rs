//! Linear approximation of a model's steps in the chip's arithmetic.

use crate::PlanError;
use crate::lqr::LinearSystem;
use crate::plant::{PlantStep, Widened};
use leastaction_core::control::{Plant, Transition};
use leastaction_core::discrete::{Newton, Order};
use leastaction_core::forces;
use leastaction_models::Actuator;
use leastaction_replica::{Replica, StateVisitor, SystemOf};
use nalgebra::DMatrix;
use std::array::from_fn;

/// A node of a motion: a time over which a command is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeStep {
    /// Tick h, s.
    pub tick: f64,
    /// Order of the step.
    pub order: Order,
    /// Number of ticks, at least 1.
    pub ticks: u16,
}

impl NodeStep {
    /// Duration, s.
    pub fn seconds(&self) -> f64 {
        self.tick * f64::from(self.ticks)
    }
}

/// Linearises the node that begins at (q, v) under the command u of every coordinate: A and B of (q, v).
///
/// The force is τ = g u + o; the actuator's delay and lag are left out ([`LinearSystem::lagged`] and [`LinearSystem::delayed`] add them).
///
/// # Errors
/// [`PlanError::Value`] for numbers that fit no node, [`PlanError::Motion`] if the node cannot be computed.
pub fn linearise(
    (replica, actuator): (&Replica, &Actuator),
    step: &NodeStep,
    [q, v, u]: [&[f64]; 3],
) -> Result<LinearSystem, PlanError> {
    for (key, list) in [("q", q), ("v", v), ("u", u)] {
        let (found, n) = (list.len(), replica.n());
        if found != n {
            return Err(PlanError::value(
                key,
                format!("has {found} values, but the model has {n} coordinates"),
            ));
        }
    }
    if !(step.tick as f32 > 0.0 && step.tick.is_finite()) {
        return Err(PlanError::value("h", format!("is {}; it must be positive", step.tick)));
    }
    if step.ticks == 0 {
        return Err(PlanError::value("ticks", "is 0; a node lasts at least one tick"));
    }
    replica.visit_states(Linearising { actuator, step, at: [q, v, u] })
}

/// A linearisation whose sizes become types.
struct Linearising<'t> {
    actuator: &'t Actuator,
    step: &'t NodeStep,
    at: [&'t [f64]; 3],
}

impl<'c> StateVisitor<'c> for Linearising<'_> {
    type Output = Result<LinearSystem, PlanError>;

    fn states<const N: usize, const D: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        let of = |get: fn(&Actuator, usize) -> f64| from_fn(|i| get(self.actuator, i) as f32);
        let actuator =
            forces::Actuator { gain: of(Actuator::gain), offset: of(Actuator::offset), delay: 0.0 };
        let NodeStep { tick, order, ticks } = *self.step;
        let plant =
            Widened::new(system, PlantStep { tick, order, stride: 1, newton: Newton::new(), actuator });
        let [q, v, u] = self.at;
        let x: [f64; D] = from_fn(|i| if i < N { q[i] } else { v[i - N] });
        let found: Result<Transition<f64, D, N>, _> = plant.linearise_at(&x, (ticks, &from_fn(|i| u[i])));
        let Transition { a, b } = found.map_err(|error| PlanError::Motion(error.to_string()))?;
        let system =
            LinearSystem::new(DMatrix::from_fn(D, D, |i, j| a[i][j]), DMatrix::from_fn(D, N, |i, j| b[i][j]));
        system.map_err(|error| PlanError::Motion(error.to_string()))
    }

    fn graph(self) -> Self::Output {
        let message = "graphs of particles have no step in (q, v); inertia networks and trees have";
        Err(PlanError::Motion(message.to_owned()))
    }
}
