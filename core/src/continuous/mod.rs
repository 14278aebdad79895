//! Continuous dynamics: M v̇ = L_q − L_vq v + Q + τ, and fixed-step integrators of it.
//!
//! Source: the Euler–Lagrange equation (ModLaNet eq. 2; SyMo eq. 2 with forces).

mod constrained;
mod integrators;

pub use constrained::{
    Baumgarte, Drive, constrained_acceleration, constrained_inverse_dynamics, constrained_workspace,
};
pub use integrators::{ContinuousState, midpoint_step, rk4_step};

use crate::forces::{Forces, System};
use crate::lagrangian::{Energies, Lagrangian};
use crate::linear::{self, Matrix, SolveError};
use crate::newton::{Equations, Newton, StepError, relative};
use crate::scalar::{Real, all_finite, max_abs};

/// v̇ = M⁻¹(L_q − L_vq v + Q + τ), m/s² or rad/s².
///
/// # Errors
/// [`SolveError`] if M is singular or a number is not finite.
#[inline]
pub fn acceleration<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    q: &[R; N],
    v: &[R; N],
    tau: &[R; N],
) -> Result<[R; N], SolveError>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    if system.lagrangian.solves() {
        let force = system.forces.force(q, v, tau);
        let force = core::array::from_fn(|i| force[i] + tau[i]);
        return finite(system.lagrangian.forward_dynamics(q, v, &force)?);
    }
    let d = system.lagrangian.dynamics(q, v);
    let force = system.forces.force(q, v, tau);
    finite(linear::solve(d.mass, core::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + force[i] + tau[i]))?)
}

/// Fails if a number is not finite.
#[inline(always)]
fn finite<R: Real, const N: usize>(x: [R; N]) -> Result<[R; N], SolveError> {
    if all_finite(&x) { Ok(x) } else { Err(SolveError::NotFinite) }
}

/// The control force τ that produces the acceleration v̇ (inverse dynamics): τ + Q(q, v, τ) = M v̇ − L_q + L_vq v.
///
/// If Q depends on τ, the equation is implicit. It has exactly one solution if friction grows more slowly than
/// the load, |∂Q/∂τ| < 1. [`Forces::control`] gives this solution if a single law depends on τ, and Newton's
/// method with ∂Q/∂τ starts from it. At least one update is made, to remove rounding errors. If several laws
/// depend on τ, up to 16 updates are made.
///
/// # Errors
/// An error if 1 + ∂Q/∂τ is singular, a number is not finite, or 16 updates do not solve the equation.
pub fn inverse_dynamics<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    q: &[R; N],
    v: &[R; N],
    acceleration: &[R; N],
) -> Result<[R; N], StepError<R>>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let d = system.lagrangian.dynamics(q, v);
    let inertial = linear::multiply(&d.mass, acceleration);
    let total = core::array::from_fn(|i| inertial[i] - d.l_q[i] + d.l_vq_v[i]);
    let size = core::array::from_fn(|i| inertial[i].abs() + d.l_q[i].abs() + d.l_vq_v[i].abs());
    let tau = system.forces.control(q, v, &total);
    let mut load = Load { forces: &system.forces, q, v, total, size, tau, left: [R::zero(); N] };
    Newton { max_iterations: 16, ..Newton::new() }.solve(&mut load)?;
    Ok(finite(load.tau)?)
}

/// The equation τ + Q(q, v, τ) = `total` in τ.
struct Load<'a, R, F, const N: usize> {
    forces: &'a F,
    q: &'a [R; N],
    v: &'a [R; N],
    total: [R; N],
    /// Size of the terms of `total`.
    size: [R; N],
    tau: [R; N],
    /// Residual of the equation.
    left: [R; N],
}

impl<R: Real, F: Forces<R, N>, const N: usize> Equations<R> for Load<'_, R, F, N> {
    type Error = StepError<R>;

    fn residual(&mut self) -> R {
        let Self { total, size, tau, .. } = self;
        let force = self.forces.force(self.q, self.v, tau);
        self.left = core::array::from_fn(|i| (total[i] - force[i]) - tau[i]);
        max_abs::<R, N>(&core::array::from_fn(|i| {
            relative(self.left[i].abs(), size[i] + force[i].abs() + tau[i].abs())
        }))
    }

    fn update(&mut self) -> Result<(), StepError<R>> {
        let matrix = plus_identity(self.forces.load_derivative(self.q, self.v, &self.tau));
        self.tau = linear::add_scaled(&self.tau, R::one(), &linear::solve(matrix, self.left)?);
        Ok(())
    }
}

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
