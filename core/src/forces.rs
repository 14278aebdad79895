//! Generalised forces that no potential gives: damping, with its derivatives for Newton's method. Control forces u are
//! added by the solvers.

use crate::scalar::Scalar;

/// A dissipative force Q(q, v) and its derivatives.
pub trait Forces<S: Scalar, const N: usize> {
    /// Q(q, v), N or N m, with the sign of a force: damping opposes v.
    fn force(&self, q: &[S; N], v: &[S; N]) -> [S; N];
    /// (∂Q/∂q, ∂Q/∂v), entry \[i\]\[j\] = ∂Q_i/∂x_j.
    fn derivatives(&self, q: &[S; N], v: &[S; N]) -> ([[S; N]; N], [[S; N]; N]);
}

impl<S: Scalar, F: Forces<S, N>, const N: usize> Forces<S, N> for &F {
    fn force(&self, q: &[S; N], v: &[S; N]) -> [S; N] {
        (**self).force(q, v)
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N]) -> ([[S; N]; N], [[S; N]; N]) {
        (**self).derivatives(q, v)
    }
}

/// Linear viscous damping in every coordinate, Q_i = −c_i v_i, c_i ≥ 0 in N s/m or N m s/rad. All zero: no damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscous<S, const N: usize> {
    /// c.
    pub coefficients: [S; N],
}

impl<S: Scalar, const N: usize> Viscous<S, N> {
    /// No damping.
    pub fn none() -> Self {
        Self { coefficients: [S::zero(); N] }
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for Viscous<S, N> {
    fn force(&self, _: &[S; N], v: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| -(self.coefficients[i] * v[i]))
    }

    fn derivatives(&self, _: &[S; N], _: &[S; N]) -> ([[S; N]; N], [[S; N]; N]) {
        let zero = [[S::zero(); N]; N];
        let mut q_v = zero;
        for (i, row) in q_v.iter_mut().enumerate() {
            row[i] = -self.coefficients[i];
        }
        (zero, q_v)
    }
}

/// A Lagrangian with the forces that act beside it: what the solvers step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System<L, F> {
    /// L = T − V.
    pub lagrangian: L,
    /// Q beside the control force.
    pub forces: F,
}

impl<L, S: Scalar, const N: usize> System<L, Viscous<S, N>> {
    /// The Lagrangian system without damping.
    pub fn conservative(lagrangian: L) -> Self {
        Self { lagrangian, forces: Viscous::none() }
    }
}
