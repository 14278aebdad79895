//! Continuous dynamics: M v̇ = L_q − L_vq v + Q + u, and fixed-step integrators of it.
//!
//! Source: the Euler–Lagrange equation (ModLaNet eq. 2; SyMo eq. 2 with forces).

mod constrained;
mod integrators;

pub use constrained::{Baumgarte, Drive, constrained_acceleration, constrained_workspace};
pub use integrators::{ContinuousState, midpoint_step, rk4_step};

use crate::forces::{Forces, System};
use crate::lagrangian::{Energies, Lagrangian};
use crate::linear::{self, Matrix, Singular};
use crate::scalar::{Real, max_abs};

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
    F: Forces<R, N>,
{
    let d = system.lagrangian.dynamics(q, v);
    let force = system.forces.force(q, v, u);
    linear::solve(d.mass, core::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + force[i] + u[i]))
}

/// The control force τ that produces the acceleration v̇ (inverse dynamics): τ + Q(q, v, τ) = M v̇ − L_q + L_vq v.
///
/// Where Q sees τ the equation is implicit and solved by Newton's method with ∂Q/∂τ; friction that grows with the load more
/// slowly than the load itself leaves one solution. An error where 1 + ∂Q/∂τ is singular.
pub fn inverse_dynamics<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    q: &[R; N],
    v: &[R; N],
    acceleration: &[R; N],
) -> Result<[R; N], Singular>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let d = system.lagrangian.dynamics(q, v);
    let inertial = linear::multiply(&d.mass, acceleration);
    let total: [R; N] = core::array::from_fn(|i| inertial[i] - d.l_q[i] + d.l_vq_v[i]);
    let mut tau = [R::zero(); N];
    for _ in 0..MAX_LOAD_UPDATES {
        let force = system.forces.force(q, v, &tau);
        let residual: [R; N] = core::array::from_fn(|i| (total[i] - force[i]) - tau[i]);
        let matrix = plus_identity(system.forces.load_derivative(q, v, &tau));
        let change = linear::solve(matrix, residual)?;
        tau = linear::add_scaled(&tau, R::one(), &change);
        if max_abs(&change) <= R::constant(2.0) * R::EPSILON * max_abs(&tau) {
            break;
        }
    }
    Ok(tau)
}

/// Updates of the load at most.
const MAX_LOAD_UPDATES: usize = 16;

fn plus_identity<R: Real, const N: usize>(mut matrix: Matrix<R, N>) -> Matrix<R, N> {
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] += R::one();
    }
    matrix
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
