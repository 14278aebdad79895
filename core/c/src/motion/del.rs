use super::Step;
use crate::arguments::Vector;
use crate::config::LEASTACTION_COORDINATES as N;
use crate::error::Error;
use crate::family::{Mechanism, system};
use leastaction_core::continuous;
use leastaction_core::discrete::{Control, Del, Newton, Path, Report, State};
use leastaction_core::forces::Forces;
use leastaction_core::lagrangian::Energies;
#[cfg(not(feature = "arm"))]
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear;

/// State in the form of core.
pub(crate) type CoreState = State<f32, N>;

pub(crate) fn acceleration(mechanism: &Mechanism, [q, v, u]: [&Vector; 3]) -> Result<Vector, Error> {
    Ok(continuous::acceleration(&system(mechanism), q, v, u)?)
}

pub(crate) fn inverse_dynamics(mechanism: &Mechanism, [q, v, a]: [&Vector; 3]) -> Result<Vector, Error> {
    Ok(continuous::inverse_dynamics(&system(mechanism), q, v, a)?)
}

pub(crate) fn momentum(mechanism: &Mechanism, [q, v]: [&Vector; 2]) -> Result<Vector, Error> {
    Ok(continuous::momentum(system(mechanism).lagrangian, q, v))
}

pub(crate) fn energies(mechanism: &Mechanism, [q, v]: [&Vector; 2]) -> Result<Energies<f32>, Error> {
    Ok(system(mechanism).energies(q, v))
}

pub(crate) fn mass_matrix(mechanism: &Mechanism, q: &Vector) -> [Vector; N] {
    #[cfg(feature = "arm")]
    return system(mechanism).lagrangian.mass_matrix(q);
    #[cfg(not(feature = "arm"))]
    system(mechanism).lagrangian.linearization(q, &[0.0; N]).l_vv
}

/// V_q, including the potentials that forces store.
pub(crate) fn gravity_torque(mechanism: &Mechanism, q: &Vector) -> Vector {
    let (system, rest) = (system(mechanism), [0.0; N]);
    #[cfg(feature = "arm")]
    let torque = system.lagrangian.gravity_torque(q);
    #[cfg(not(feature = "arm"))]
    let torque = system.lagrangian.gradient(q, &rest).l_q.map(|l_q| -l_q);
    linear::add_scaled(&torque, -1.0, &system.forces.force(q, &rest, &rest))
}

/// Starts a state at position q and velocity v.
pub(crate) fn start(mechanism: &Mechanism, q: Vector, v: Vector) -> Result<CoreState, Error> {
    Ok(CoreState::new(system(mechanism).lagrangian, q, v)?)
}

/// Starts a state from two positions and the control between them.
pub(crate) fn between<P: Path>(
    mechanism: &Mechanism,
    h: f32,
    [q0, q1]: [&Vector; 2],
    control: &Control<f32, N>,
) -> Result<CoreState, Error> {
    Ok(Del::<f32, P>::new(h).start(&system(mechanism), q0, q1, control)?)
}

pub(crate) fn step<P: Path>(
    mechanism: &Mechanism,
    state: &mut CoreState,
    Step { h, newton }: Step,
    control: &Control<f32, N>,
) -> Result<Report<f32>, Error> {
    Ok(Del::<f32, P>::with_newton(h, newton).step(&system(mechanism), state, control)?)
}

pub(crate) fn default_newton() -> Newton<f32> {
    Newton::default()
}
