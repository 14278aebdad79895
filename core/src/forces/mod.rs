//! Generalised forces that no potential gives: friction and damping, with their derivatives, and the actuator between a
//! command and the force that acts.
//!
//! The equation of motion is M v̇ = L_q − L_vq v + τ + Q(q, v, τ). τ is the control force at the actuator's output, which the
//! solvers are given; [`Actuator`] makes it from the commands u. Q may see it: friction grows with the load.
//!
//! Several laws act together as a pair `(A, B)`, which is a law again: Q = Q_A + Q_B. Beside friction with a formula there are
//! networks that correct: [`Dissipation`], which only takes energy away, and [`PotentialCorrection`], which only stores it.

mod actuator;
mod control;
mod correction;
mod coulomb;
mod dissipation;
mod pair;
mod seen;
mod viscous;

pub use actuator::{Actuator, ControlKind};
pub use control::Control;
pub use correction::PotentialCorrection;
pub use coulomb::{Coulomb, DryFriction};
pub use dissipation::Dissipation;
pub use seen::Seen;
pub use viscous::Viscous;

use crate::lagrangian::{Energies, Lagrangian};
use crate::linear::{Matrix, add_scaled};
use crate::scalar::{Real, Scalar};

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

    /// The potential energy that it stores, J: of a force Q = −∂V/∂q its V, 0 of others.
    #[inline(always)]
    fn potential(&self, _q: &[S; N]) -> S {
        S::zero()
    }

    /// A τ with τ + Q(q, v, τ) = `total`, from which inverse dynamics starts: total − Q(q, v, 0), which is exact where Q does not
    /// see τ. A law that does has the solution for itself, and together with laws that do not see τ it remains exact.
    fn control(&self, q: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        add_scaled(total, -S::one(), &self.force(q, v, &[S::zero(); N]))
    }

    /// The part of a change dv of the velocity, in (0, 1], after which Newton's method looks again: 1, but for a law that
    /// bends so sharply that its derivatives would lead past the solution for ever.
    #[inline(always)]
    fn trusted_part(&self, _v: &[S; N], _dv: &[S; N]) -> S
    where
        S: Real,
    {
        S::one()
    }
}

/// The smaller of two numbers; `a` where `b` is none.
#[inline(always)]
fn smaller<R: Real>(a: R, b: R) -> R {
    if b < a { b } else { a }
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

    #[inline(always)]
    fn potential(&self, q: &[S; N]) -> S {
        (**self).potential(q)
    }

    fn control(&self, q: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        (**self).control(q, v, total)
    }

    #[inline(always)]
    fn trusted_part(&self, v: &[S; N], dv: &[S; N]) -> S
    where
        S: Real,
    {
        (**self).trusted_part(v, dv)
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

impl<L, F> System<L, F> {
    /// T and V, J, with the potentials that forces store.
    pub fn energies<S: Scalar, const N: usize>(&self, q: &[S; N], v: &[S; N]) -> Energies<S>
    where
        L: Lagrangian<S, N>,
        F: Forces<S, N>,
    {
        let Energies { kinetic, potential } = self.lagrangian.energies(q, v);
        Energies { kinetic, potential: potential + self.forces.potential(q) }
    }
}

impl<L, S: Scalar, const N: usize> System<L, Viscous<S, N>> {
    /// The Lagrangian system without damping.
    pub fn conservative(lagrangian: L) -> Self {
        Self { lagrangian, forces: Viscous::none() }
    }
}
