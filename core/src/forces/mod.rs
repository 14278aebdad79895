//! Generalised forces that no potential gives: friction and damping, with their derivatives, and the actuator between a
//! command and the force that acts.
//!
//! The equation of motion is M v̇ = L_q − L_vq v + τ + Q(q, v, τ). τ is the control force at the actuator's output, which the
//! solvers are given; [`Actuator`] makes it from the commands u. Q may see it: friction grows with the load.
//!
//! Several laws act together as a pair `(A, B)`, which is a law again: Q = Q_A + Q_B.

mod actuator;
mod control;
mod pair;
mod viscous;

pub use actuator::{Actuator, ControlKind};
pub use control::Control;
pub use viscous::Viscous;

use crate::linear::Matrix;
use crate::scalar::Scalar;

/// A force Q(q, v, τ) beside the control force τ, with its derivatives.
///
/// Signs are those of a force: damping opposes v. Evaluation cannot fail: where the numbers leave the range of S the result
/// is not finite, and the solvers say so.
pub trait Forces<S: Scalar, const N: usize> {
    /// Q, N or N m.
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N];
    /// (∂Q/∂q, ∂Q/∂v), entry \[i\]\[j\] = ∂Q_i/∂x_j: what Newton's method needs of a step, in which τ is given.
    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>);
    /// ∂Q/∂τ, entry \[i\]\[j\] = ∂Q_i/∂τ_j: what inverse dynamics needs, in which τ is the unknown.
    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N>;
}

impl<S: Scalar, F: Forces<S, N>, const N: usize> Forces<S, N> for &F {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        (**self).force(q, v, tau)
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        (**self).derivatives(q, v, tau)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        (**self).load_derivative(q, v, tau)
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
