//! Calls of every public entry of leastaction-core that a firmware makes, for programs that `.ci/chip` builds for a Cortex-M4F
//! and searches for what panics. They are never run.
#![no_std]

pub mod adapted;

use core::hint::black_box;
use leastaction_core::adapt::Number;
use leastaction_core::continuous::{
    ContinuousState, acceleration, energy, inverse_dynamics, midpoint_step, momentum, rk4_step,
};
use leastaction_core::control::riccati::{Weights, stationary};
use leastaction_core::control::{Plant, Stepped};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, State};
use leastaction_core::forces::{
    Actuator, Coulomb, Directional, Dissipation, Forces, PotentialCorrection, Sticking, Stops, System,
    Viscous,
};
use leastaction_core::guard::{Sweep, Voted};
use leastaction_core::lagrangian::{Column, Lagrangian};
use leastaction_core::model::{Model, ModelError};
use leastaction_core::plan::Plan;
use leastaction_core::static_vectors;
use leastaction_core::stepper::{Actuated, Actuation, Direct, Drive, Held, Kind, Lagged, Linear, Stepper};
use nalgebra::SVector;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    halt()
}

/// Damping and dry friction.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);
/// Friction by direction, friction that sticks, and end stops.
pub type Axes<const N: usize> = (Directional<f32, N>, (Sticking<f32, N>, Stops<f32, N>));
/// Friction and corrections by networks.
pub type AllForces<const N: usize> =
    (Friction<N>, (Dissipation<'static, f32, N, 8, 2>, PotentialCorrection<'static, f32, N, 8, 2>));

/// Everything continuous.
#[inline(never)]
fn evaluate<L, F, const N: usize>(system: &System<L, F>, [q, v, u]: &[[f32; N]; 3]) -> f32
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let a = acceleration(system, q, v, u).unwrap_or(*q);
    let force = inverse_dynamics(system, q, v, &a);
    let p = momentum(&system.lagrangian, q, v);
    let state = ContinuousState { q: *q, v: *v };
    let _ = black_box((a, force, p));
    let _ = black_box(rk4_step(system, &state, u, 0.01));
    let _ = black_box(midpoint_step(system, &state, u, 0.01));
    black_box(system.energies(q, v));
    let mut columns = [Column::zero(); 2];
    let numbers = black_box([Number::Potential(3), Number::Dissipation(1)]);
    system.forces.network_columns(q, v, &numbers, &mut columns);
    black_box(columns);
    energy(&system.lagrangian, q, v)
}

#[inline(never)]
fn step<L: Lagrangian<f32, N>, F: Forces<f32, N>, P: Path, const N: usize>(
    system: &System<L, F>,
    [q, v, u]: &[[f32; N]; 3],
) -> Option<State<f32, N>> {
    let (del, u) = (Del::<f32, P>::new(0.01), Control::held(*u));
    let mut state = State::new(&system.lagrangian, *q, *v).ok()?;
    del.step(system, &mut state, &u).ok()?;
    let mut state = del.start(system, q, &state.q(), &u).ok()?;
    del.step(system, &mut state, &u).ok()?;
    Some(state)
}

/// Everything.
#[inline(never)]
pub fn everything<L, F, const N: usize>(system: &System<L, F>)
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let at = &black_box([[0.1; N]; 3]);
    black_box(evaluate(system, at));
    black_box(vectors(system));
    black_box(step::<L, F, Midpoint, N>(system, at));
    black_box(step::<L, F, Galerkin, N>(system, at));
}

/// Everything through nalgebra's vectors and matrices.
#[inline(never)]
fn vectors<L: Lagrangian<f32, N>, F: Forces<f32, N>, const N: usize>(system: &System<L, F>) -> Option<()> {
    let [q, v, a] = black_box([[0.1; N]; 3]).map(SVector::from);
    let u = static_vectors::inverse_dynamics(system, &q, &v, &a).ok()?;
    let a = static_vectors::acceleration(system, &q, &v, &u).ok()?;
    let l = system.lagrangian.hessian(&q.into(), &v.into());
    let force: SVector<f32, N> = l.mass_matrix() * a + l.l_vq_matrix() * v - l.l_qq_matrix() * q;
    let mut state = State::from_vectors(&system.lagrangian, &q, &v).ok()?;
    Del::<f32, Midpoint>::new(0.01).step(system, &mut state, &Control::from(force)).ok()?;
    black_box((state.q_vector(), state.p_vector(), static_vectors::rows(&l.mass_matrix())));
    Some(())
}

/// A regulator about a rest, by the derivative of a step of a plant of one control; D is 2N.
#[inline(never)]
pub fn regulated<L, F, P: Path, const N: usize, const D: usize>(system: &System<L, F>) -> Option<f32>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let (del, inputs, stride) = (Del::<f32, P>::new(0.01), black_box([0]), black_box(1));
    let plant = Stepped { system, del, actuator: Actuator::ideal(), inputs, stride };
    black_box(plant.linearise_rest::<D>(&black_box([0.1; N]), (black_box(1), &[0.1])).ok()?);
    let transition = plant.linearise_at(&black_box([0.1; D]), (black_box(2), &[0.1])).ok()?;
    let regulator = stationary(&transition, &black_box(Weights { x: [1.0; D], u: [1.0] })).ok()?;
    let closed = transition.a_matrix() - transition.b_matrix() * regulator.gain_matrix();
    Some((closed.transpose() * regulator.cost_matrix() * closed).trace())
}

/// Everything in a model file besides its mechanism: the trained step, the actuator and the range.
#[inline(never)]
pub fn said<M, const N: usize>(model: &Model<M>) {
    let at = &black_box([0.1; N]);
    let _ = black_box((model.step(), model.del::<f32, Midpoint>().is_ok()));
    if let Ok(Some(actuator)) = model.actuator()
        && let Ok((steps, actuator)) = actuator.at_step::<N>(black_box(0.01))
    {
        black_box((steps, actuator.held(at, at), actuator.linear(at, at, at), actuator.command(at)));
    }
    if let Ok(Some(actuator)) = model.actuator()
        && let Ok((steps, actuator, lag)) = actuator.at_step_with_lag::<N>(black_box(0.01))
    {
        black_box((steps, actuator.lagging(|i| lag.held(at[i], at[i], at[i]))));
        black_box(actuator.lagging(|i| lag.linear(at[i], [at[i]; 3])));
    }
    if let Ok(Some(range)) = model.range() {
        let _ = black_box(range.outside(at, at, at));
    }
}

/// Everything of a stepper of this kind.
#[inline(never)]
fn stepper<L, F, P, K, A, const N: usize, const PAST: usize>(
    model: &Model<System<L, F>>,
) -> Result<Option<[f32; N]>, ModelError>
where
    L: Lagrangian<f32, N> + Copy,
    F: Forces<f32, N> + Copy,
    P: Path,
    K: Kind,
    A: Actuation<N>,
{
    let at = black_box([0.1; N]);
    let mut stepper = match Stepper::<_, P, Drive<K, A, N, PAST>, N>::new(*model) {
        Err(ModelError::NoStep) => Stepper::with_step(*model, black_box(0.01))?,
        found => found?,
    }
    .with_newton(black_box(Newton::new()));
    let _ = black_box((stepper.start(at, at), stepper.step(at), stepper.v()));
    let _ = black_box((stepper.commanded(at), stepper.start_from([at, at], at), stepper.step(at)));
    black_box((stepper.p(), stepper.h(), stepper.state()));
    Ok(stepper.v().ok())
}

/// Steppers of both orders, both kinds of control, without and with an actuator.
#[inline(never)]
pub fn steppers<L, F, const N: usize>(model: &Model<System<L, F>>)
where
    L: Lagrangian<f32, N> + Copy,
    F: Forces<f32, N> + Copy,
{
    let _ = black_box(stepper::<L, F, Midpoint, Held, Direct, N, 0>(model));
    let _ = black_box(stepper::<L, F, Galerkin, Linear, Direct, N, 1>(model));
    let _ = black_box(stepper::<L, F, Midpoint, Linear, Actuated<N>, N, 5>(model));
    let _ = black_box(stepper::<L, F, Galerkin, Held, Actuated<N>, N, 3>(model));
    let _ = black_box(stepper::<L, F, Galerkin, Held, Lagged<N>, N, 3>(model));
    let _ = black_box(stepper::<L, F, Midpoint, Linear, Lagged<N>, N, 5>(model));
}

/// Guards of a file and of a state.
#[inline(never)]
pub fn guards(file: &[u8]) {
    let (mut sweep, mut voted) = (black_box(Sweep::new()), black_box(Voted::new(0.1, [0.0; 3])));
    let _ = black_box(sweep.advance(file, black_box(Sweep::slice(file.len(), 6))));
    let _ = black_box(voted.run(&black_box([0.3; 3]), |gain, x, input| {
        *x = x.map(|x: f32| x + gain * input);
        x[0]
    }));
    black_box(voted.state());
}

/// Everything of a plan.
#[inline(never)]
pub fn followed<const N: usize, const M: usize>(plan: &Plan<N, M>) {
    let (tick, at) = (black_box(7), &black_box([0.1; N]));
    let _ = black_box((plan.command(tick, at, at), plan.force(tick, at, at), plan.reference(tick)));
    black_box((plan.ticks(), plan.seconds(), plan.file().record(tick)));
}

/// A file in flash, of which the compiler knows nothing.
#[repr(align(4))]
pub struct Flash([u8; 64]);

impl Flash {
    /// An empty one.
    pub const fn new() -> Self {
        Self([0; 64])
    }

    /// The bytes in flash.
    pub fn bytes(&'static self) -> &'static [u8] {
        black_box(&self.0)
    }
}

impl Default for Flash {
    fn default() -> Self {
        Self::new()
    }
}

/// The end of a program.
pub fn halt() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
