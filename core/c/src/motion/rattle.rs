use super::Step;
use crate::arguments::Vector;
use crate::config::{LEASTACTION_COORDINATES as N, LEASTACTION_DIMENSIONS as D, LEASTACTION_RODS as RODS};
use crate::error::Error;
use crate::family::{AnyGraph, Mechanism, constrained};
use leastaction_core::continuous::{
    Baumgarte, Drive, constrained_acceleration, constrained_inverse_dynamics,
};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Control, Newton, Path, Report};
use leastaction_core::lagrangian::Energies;
use leastaction_core::linear::add_scaled;
use leastaction_core::particles::Particles;

const NODES: usize = N / D;

/// Workspace length for any evaluation in the worst case, in which the first and the last rod share a node. An
/// acceleration needs only a part of it.
const WORK: usize = Rattle::<f32>::workspace_of::<D>(NODES, RODS, RODS - 1, AnyGraph::most_workspace(NODES));

/// Workspace length of a state in motion.
const MOVING: usize = ParticleState::<f32, D>::workspace(NODES, RODS);

/// Length of a saved state.
const SAVED: usize = ParticleState::<f32, D>::saved(NODES, RODS);

/// A state as plain numbers.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct CoreState {
    /// State as core saves it; zeros in the places of missing rods.
    saved: [f32; SAVED],
    /// Mean velocity over the last step, m/s.
    w: Vector,
}

impl CoreState {
    fn of(state: &ParticleState<f32, D>, w: Vector) -> Result<Self, Error> {
        let mut new = Self { saved: [0.0; SAVED], w };
        new.keep(state)?;
        Ok(new)
    }

    /// Saves everything but w.
    fn keep(&mut self, state: &ParticleState<f32, D>) -> Result<(), Error> {
        self.saved.fill(0.0);
        Ok(state.save(first_mut(&mut self.saved, numbers(state.lambda().len())))?)
    }

    /// Vector k of a saved state.
    fn vector(&self, k: usize) -> Vector {
        self.saved.as_chunks().0.get(k).copied().unwrap_or([0.0; N])
    }

    /// Positions q, m.
    pub fn q(&self) -> Vector {
        self.vector(0)
    }

    /// Carry of q, lost to rounding, m.
    fn q_carry(&self) -> Vector {
        self.vector(1)
    }

    /// Momenta p, kg m/s.
    pub fn p(&self) -> Vector {
        self.vector(2)
    }

    /// Velocities v, m/s.
    fn v(&self) -> Vector {
        self.vector(4)
    }

    /// Mean velocity over the last step, m/s, or the velocity that the state was started with.
    pub fn last_increment(&self) -> Vector {
        self.w
    }

    /// Multipliers λ over the last step, N.
    pub fn lambda(&self) -> [f32; RODS] {
        let mut lambda = [0.0; RODS];
        lambda.iter_mut().zip(self.saved.iter().skip(numbers(0))).for_each(|(to, from)| *to = *from);
        lambda
    }
}

/// Length of a saved state with `rods` rods.
const fn numbers(rods: usize) -> usize {
    ParticleState::<f32, D>::saved(NODES, rods)
}

/// The first `count` numbers of an array. They always exist: no graph is loaded that has more rods than the library
/// was built for.
fn first_mut(array: &mut [f32], count: usize) -> &mut [f32] {
    array.get_mut(..count).unwrap_or_default()
}

/// Splits a vector into one vector per node.
fn nodes(x: &Vector) -> &[[f32; D]] {
    x.as_chunks().0
}

/// Mean of the control over the step, since the external force of a RATTLE step is constant.
fn mean(control: &Control<f32, N>) -> Vector {
    control.at(0.5)
}

pub(crate) fn acceleration(mechanism: &Mechanism, [q, v, u]: [&Vector; 3]) -> Result<Vector, Error> {
    let system = constrained(mechanism)?;
    let (mut a, mut lambda, mut work) = ([0.0; N], [0.0; RODS], [0.0; WORK]);
    let drive = Drive { force: Some(nodes(u)), baumgarte: Baumgarte::none() };
    let lambda = first_mut(&mut lambda, system.equations());
    let out = (a.as_chunks_mut().0, lambda);
    constrained_acceleration(&system, (nodes(q), nodes(v)), &drive, &mut work, out)?;
    Ok(a)
}

pub(crate) fn inverse_dynamics(mechanism: &Mechanism, [q, v, a]: [&Vector; 3]) -> Result<Vector, Error> {
    let (mut u, mut work) = ([0.0; N], [0.0; WORK]);
    let at = [nodes(q), nodes(v), nodes(a)];
    constrained_inverse_dynamics(&constrained(mechanism)?, at, &mut work, u.as_chunks_mut().0)?;
    Ok(u)
}

pub(crate) fn momentum(mechanism: &Mechanism, [_, v]: [&Vector; 2]) -> Result<Vector, Error> {
    let mut p = [0.0; N];
    mechanism.system.graph.momenta(0, nodes(v), p.as_chunks_mut().0);
    Ok(p)
}

pub(crate) fn energies(mechanism: &Mechanism, [q, v]: [&Vector; 2]) -> Result<Energies<f32>, Error> {
    Ok(mechanism.system.graph.energies(nodes(q), nodes(v), &mut [0.0; WORK]))
}

/// Starts a state at position q and at the part of velocity v that the rods allow.
pub(crate) fn start(mechanism: &Mechanism, q: Vector, v: Vector) -> Result<CoreState, Error> {
    let system = constrained(mechanism)?;
    let (mut moving, mut work) = ([0.0; MOVING], [0.0; WORK]);
    let state = ParticleState::new(&system, nodes(&q), nodes(&v), &mut moving, &mut work)?;
    let started = CoreState::of(&state, [0.0; N])?;
    Ok(CoreState { w: started.v(), ..started })
}

/// Starts a state from two positions and the control between them.
pub(crate) fn between<P: Path>(
    mechanism: &Mechanism,
    h: f32,
    [q0, q1]: [&Vector; 2],
    control: &Control<f32, N>,
) -> Result<CoreState, Error> {
    let system = constrained(mechanism)?;
    let (mut moving, mut work) = ([0.0; MOVING], [0.0; WORK]);
    let (rattle, force, q) = (Rattle::new(h, P::ORDER), mean(control), [nodes(q0), nodes(q1)]);
    let state = rattle.start(&system, q, Some(nodes(&force)), &mut moving, &mut work)?;
    CoreState::of(&state, minus(q1, q0).map(|way| way / h))
}

pub(crate) fn step<P: Path>(
    mechanism: &Mechanism,
    state: &mut CoreState,
    Step { h, newton }: Step,
    control: &Control<f32, N>,
) -> Result<Report<f32>, Error> {
    let system = constrained(mechanism)?;
    let (mut moving, mut work, force) = ([0.0; MOVING], [0.0; WORK], mean(control));
    let before = [state.q(), state.q_carry()];
    let saved = first_mut(&mut state.saved, numbers(system.equations()));
    let mut next = ParticleState::resume(&system, saved, &mut moving)?;
    let rattle = Rattle::with_newton(h, P::ORDER, newton);
    let report = rattle.step(&system, &mut next, Some(nodes(&force)), &mut work)?;
    state.keep(&next)?;
    state.w = increment(&before, &[state.q(), state.q_carry()], h);
    Ok(report)
}

/// Increment (q₁ − q₀)/h, m/s, of positions with their carries.
fn increment([q0, carry0]: &[Vector; 2], [q1, carry1]: &[Vector; 2], h: f32) -> Vector {
    add_scaled(&minus(q1, q0), 1.0, &minus(carry1, carry0)).map(|way| way / h)
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    add_scaled(a, -1.0, b)
}

pub(crate) fn default_newton() -> Newton<f32> {
    Rattle::default_newton()
}
