//! Continuous dynamics: M v̇ = L_q − L_vq v + Q + u, and fixed-step integrators of it.
//!
//! Source: the Euler–Lagrange equation (ModLaNet eq. 2; SyMo eq. 2 with forces).

mod constrained;
mod integrators;

pub use constrained::{Baumgarte, Drive, constrained_acceleration, constrained_room};
pub use integrators::{ContinuousState, midpoint_step, rk4_step};

use crate::forces::{Forces, System};
use crate::lagrangian::{Energies, Lagrangian, MassMatrix};
use crate::linear::Singular;
use crate::scalar::Real;

/// v̇ = M⁻¹(L_q − L_vq v + Q + u), m/s² or rad/s². An error where M is singular.
#[inline]
pub fn acceleration<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    q: &[R; N],
    v: &[R; N],
    u: &[R; N],
) -> Result<[R; N], Singular>
where
    L: Lagrangian<R, N>,
    L::Mass: MassMatrix<R, N>,
    F: Forces<R, N>,
{
    let d = system.lagrangian.dynamics(q, v);
    let force = system.forces.force(q, v);
    d.mass.solve(&core::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + force[i] + u[i]))
}

/// The control u = M v̇ − L_q + L_vq v − Q that produces the acceleration v̇ (inverse dynamics).
pub fn inverse_dynamics<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    q: &[R; N],
    v: &[R; N],
    acceleration: &[R; N],
) -> [R; N]
where
    L: Lagrangian<R, N>,
    L::Mass: MassMatrix<R, N>,
    F: Forces<R, N>,
{
    let d = system.lagrangian.dynamics(q, v);
    let force = system.forces.force(q, v);
    let inertial = d.mass.multiply(acceleration);
    core::array::from_fn(|i| inertial[i] - d.l_q[i] + d.l_vq_v[i] - force[i])
}

/// The energy T + V, J.
pub fn energy<R: Real, L: Lagrangian<R, N>, const N: usize>(lagrangian: &L, q: &[R; N], v: &[R; N]) -> R {
    let Energies { kinetic, potential } = lagrangian.energies(q, v);
    kinetic + potential
}

/// The generalised momentum p = L_v.
pub fn momentum<R: Real, L: Lagrangian<R, N>, const N: usize>(
    lagrangian: &L,
    q: &[R; N],
    v: &[R; N],
) -> [R; N] {
    lagrangian.gradient(q, v).l_v
}
