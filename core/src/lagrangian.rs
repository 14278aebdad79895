//! Interface between the solvers and a mechanical system: a Lagrangian L(q, v) = T − V with its derivatives.

use crate::linear::{SolveError, multiply, solve};
use crate::scalar::{Real, Scalar};

/// Kinetic and potential energy, J.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energies<S> {
    /// Kinetic energy T(q, v).
    pub kinetic: S,
    /// Potential energy V(q).
    pub potential: S,
}

/// First derivatives of the Lagrangian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient<S, const N: usize> {
    /// L_q, N or N m.
    pub l_q: [S; N],
    /// p = L_v, the generalised momentum.
    pub l_v: [S; N],
}

/// The terms of M v̇ = L_q − L_vq v + Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dynamics<S, const N: usize> {
    /// M = L_vv, symmetric, row by row.
    pub mass: [[S; N]; N],
    /// L_q.
    pub l_q: [S; N],
    /// p = L_v.
    pub l_v: [S; N],
    /// L_vq v, the change of momentum along the motion at constant velocity.
    pub l_vq_v: [S; N],
}

/// M⁻¹(force + L_q − L_vq v).
#[inline(always)]
pub(crate) fn eliminated<R: Real, const N: usize>(
    d: Dynamics<R, N>,
    force: &[R; N],
) -> Result<[R; N], SolveError> {
    solve(d.mass, core::array::from_fn(|i| d.l_q[i] - d.l_vq_v[i] + force[i]))
}

/// Derivatives for a step of the discrete Euler–Lagrange equation: all first and second derivatives of the Lagrangian except L_qq.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linearization<S, const N: usize> {
    /// L_q.
    pub l_q: [S; N],
    /// p = L_v.
    pub l_v: [S; N],
    /// ∂²L/∂v_i∂q_j; the transpose is L_qv.
    pub l_vq: [[S; N]; N],
    /// M = ∂²L/∂v_i∂v_j, symmetric.
    pub l_vv: [[S; N]; N],
}

impl<S: Scalar, const N: usize> Linearization<S, N> {
    /// The terms of the equation of motion at velocity v.
    #[inline]
    pub fn dynamics(self, v: &[S; N]) -> Dynamics<S, N> {
        let Self { l_q, l_v, l_vq, l_vv } = self;
        Dynamics { mass: l_vv, l_q, l_v, l_vq_v: multiply(&l_vq, v) }
    }
}

impl<S, const N: usize> From<Hessian<S, N>> for Linearization<S, N> {
    fn from(Hessian { l_q, l_v, l_vq, l_vv, .. }: Hessian<S, N>) -> Self {
        Self { l_q, l_v, l_vq, l_vv }
    }
}

/// First and second derivatives of the Lagrangian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hessian<S, const N: usize> {
    /// L_q.
    pub l_q: [S; N],
    /// p = L_v.
    pub l_v: [S; N],
    /// ∂²L/∂q_i∂q_j, symmetric.
    pub l_qq: [[S; N]; N],
    /// ∂²L/∂v_i∂q_j; the transpose is L_qv.
    pub l_vq: [[S; N]; N],
    /// M = ∂²L/∂v_i∂v_j, symmetric.
    pub l_vv: [[S; N]; N],
}

/// Derivatives of a system's momentum and forces in one number π of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column<S, const N: usize> {
    /// ∂p/∂π.
    pub momentum: [S; N],
    /// ∂(L_q + Q)/∂π.
    pub force: [S; N],
}

impl<S: Scalar, const N: usize> Column<S, N> {
    /// The column of a number on which nothing depends.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { momentum: [S::zero(); N], force: [S::zero(); N] }
    }
}

/// A Lagrangian in N coordinates, evaluated in the scalar S.
///
/// A family implements this once; continuous and discrete dynamics, on the host and on the chip, use nothing else. Evaluation cannot fail:
/// if numbers leave the range of S, the result is not finite, and the solvers report it.
pub trait Lagrangian<S: Scalar, const N: usize> {
    /// T(q, v) and V(q), J. L = T − V; the energy is T + V.
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S>;
    /// L_q and L_v at (q, v).
    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N>;
    /// The terms of the equation of motion at (q, v).
    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        self.linearization(q, v).dynamics(v)
    }
    /// First and second derivatives at (q, v) except L_qq: all that a step needs. A family implements this method if
    /// it costs less than the Hessian.
    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        self.hessian(q, v).into()
    }
    /// All first and second derivatives at (q, v).
    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N>;

    /// Whether [`Lagrangian::forward_dynamics`] has a faster way than [`Lagrangian::dynamics`] and elimination.
    #[inline(always)]
    fn solves(&self) -> bool {
        false
    }

    /// v̇ = M⁻¹(force + L_q − L_vq v) for the sum of all forces on the coordinates.
    ///
    /// # Errors
    /// [`SolveError::Singular`] if M is singular; [`SolveError::NotFinite`] if its pivots are not finite. The result may not be finite, too.
    fn forward_dynamics(&self, q: &[S; N], v: &[S; N], force: &[S; N]) -> Result<[S; N], SolveError>
    where
        S: Real,
    {
        eliminated(self.dynamics(q, v), force)
    }

    /// Writes the columns of a body's inertial numbers, in which L is linear, and returns how many there are: ten for a body in space
    /// ([`BodyInertia`](crate::energy::arm::BodyInertia)), four in the plane ([`PlanarInertia`](crate::energy::bodies::PlanarInertia)), in
    /// their order, and none for a family without bodies. Columns beyond the end of `columns` are left out.
    #[inline(always)]
    fn inertial_columns(
        &self,
        _body: usize,
        _q: &[S; N],
        _v: &[S; N],
        _columns: &mut [Column<S, N>],
    ) -> usize {
        0
    }
}

impl<S: Scalar, L: Lagrangian<S, N>, const N: usize> Lagrangian<S, N> for &L {
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        (**self).energies(q, v)
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        (**self).gradient(q, v)
    }

    fn dynamics(&self, q: &[S; N], v: &[S; N]) -> Dynamics<S, N> {
        (**self).dynamics(q, v)
    }

    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        (**self).linearization(q, v)
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        (**self).hessian(q, v)
    }

    #[inline(always)]
    fn solves(&self) -> bool {
        (**self).solves()
    }

    #[inline(always)]
    fn forward_dynamics(&self, q: &[S; N], v: &[S; N], force: &[S; N]) -> Result<[S; N], SolveError>
    where
        S: Real,
    {
        (**self).forward_dynamics(q, v, force)
    }

    #[inline(always)]
    fn inertial_columns(&self, body: usize, q: &[S; N], v: &[S; N], columns: &mut [Column<S, N>]) -> usize {
        (**self).inertial_columns(body, q, v, columns)
    }
}
