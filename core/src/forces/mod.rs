//! Generalised forces in addition to the Lagrangian: friction, damping and corrections with their derivatives, and
//! the actuator between a command and the acting force.
//!
//! The equation of motion is M v̇ = L_q − L_vq v + τ + Q(q, v, τ). τ is the control force at the actuator's output, an input of the
//! solvers; [`Actuator`] computes it from the commands u. Q may depend on τ: friction grows with the load, and a [`Servo`] takes τ for a
//! position.
//!
//! Several laws act together as a pair `(A, B)`, which is again a law: Q = Q_A + Q_B. Beside friction by formula there are corrections by
//! networks: [`Dissipation`], which only takes energy away, and [`PotentialCorrection`], which only stores it.

mod actuator;
mod coefficient;
mod control;
mod correction;
mod coulomb;
mod directional;
mod dissipation;
mod lag;
mod pair;
mod seen;
mod servo;
mod sticking;
mod stops;
mod viscous;

pub use actuator::{Actuator, ControlKind};
pub use coefficient::Coefficient;
pub use control::Control;
pub use correction::PotentialCorrection;
pub use coulomb::{Coulomb, DryFriction};
pub use directional::{Directional, DirectionalFriction};
pub use dissipation::Dissipation;
pub use lag::{Lag, Lagging, Rise};
pub use seen::Seen;
pub use servo::Servo;
pub use sticking::{Grip, Sticking, StickingFriction};
pub use stops::{Stop, Stops};
pub use viscous::Viscous;

use crate::adapt::Number;
use crate::lagrangian::{Column, Energies, Lagrangian};
use crate::linear::{Matrix, add_scaled};
use crate::scalar::{Real, Scalar};

/// A force Q(q, v, τ) in addition to the control force τ, with its derivatives.
///
/// Signs are those of a force: damping opposes v. Evaluation cannot fail: if numbers leave the range of S, the result is not finite, and
/// the solvers report it.
///
/// A law of friction may be set-valued at rest ([`Forces::sticks`]): a step then takes [`Forces::single_valued`] at its Gauss points, and finds
/// which coordinates stick from [`Forces::grips`]. All other methods are those of a smooth law with the same levels.
pub trait Forces<S: Scalar, const N: usize> {
    /// Q, N or N m.
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N];
    /// (∂Q/∂q, ∂Q/∂v), entry \[i\]\[j\] = ∂Q_i/∂x_j: used by Newton's method in a step, where τ is given.
    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>);
    /// ∂Q/∂τ, entry \[i\]\[j\] = ∂Q_i/∂τ_j: used by inverse dynamics, where τ is the unknown.
    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N>;

    /// Whether a part of the law is set-valued at rest. A program whose laws say no has no code for it.
    #[inline(always)]
    fn sticks(&self) -> bool
    where
        S: Real,
    {
        false
    }

    /// Q without its set-valued part, and thus all of it for most laws.
    #[inline(always)]
    fn single_valued(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        self.force(q, v, tau)
    }

    /// [`Forces::derivatives`] of [`Forces::single_valued`].
    #[inline(always)]
    fn single_valued_derivatives(
        &self,
        q: &[S; N],
        v: &[S; N],
        tau: &[S; N],
    ) -> (Matrix<S, N>, Matrix<S, N>) {
        self.derivatives(q, v, tau)
    }

    /// Levels of the set-valued part, N or N m.
    #[inline(always)]
    fn grips(&self, _tau: &[S; N]) -> [Grip<S>; N] {
        [Grip::none(); N]
    }

    /// End stops of every coordinate.
    #[inline(always)]
    fn stops(&self) -> [Stop<S>; N] {
        [Stop::none(); N]
    }

    /// ∂Q_i/∂c_i of a coefficient c of every coordinate; 0 for one that these laws do not have.
    #[inline(always)]
    fn slopes(&self, _coefficient: Coefficient, _v: &[S; N]) -> [S; N] {
        [S::zero(); N]
    }

    /// Adds ∂Q/∂π to the columns of those [numbers](Number) π that belong to networks of these laws.
    #[inline(always)]
    fn network_columns(&self, _q: &[S; N], _v: &[S; N], _numbers: &[Number], _columns: &mut [Column<S, N>]) {}

    /// Potential energy that the force stores, J: V for a force Q = −∂V/∂q, 0 for any other force.
    #[inline(always)]
    fn potential(&self, _q: &[S; N]) -> S {
        S::zero()
    }

    /// A guess of the τ that solves τ + Q(q, v, τ) = `total`, from which inverse dynamics starts. The default, total
    /// − Q(q, v, 0), is exact if Q does not depend on τ. A law that depends on τ returns its own solution, which
    /// stays exact beside laws that do not depend on τ.
    fn control(&self, q: &[S; N], v: &[S; N], total: &[S; N]) -> [S; N]
    where
        S: Real,
    {
        add_scaled(total, -S::one(), &self.force(q, v, &[S::zero(); N]))
    }

    /// The fraction, in (0, 1], of a change dv of the velocity that Newton's method takes before it evaluates again.
    /// It is 1, except for a law that bends so sharply that full updates would overshoot the solution forever.
    #[inline(always)]
    fn trusted_part(&self, _v: &[S; N], _dv: &[S; N]) -> S
    where
        S: Real,
    {
        S::one()
    }
}

/// The smaller of two numbers; `a` if `b` is NaN.
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
    fn sticks(&self) -> bool
    where
        S: Real,
    {
        (**self).sticks()
    }

    #[inline(always)]
    fn single_valued(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        (**self).single_valued(q, v, tau)
    }

    #[inline(always)]
    fn single_valued_derivatives(
        &self,
        q: &[S; N],
        v: &[S; N],
        tau: &[S; N],
    ) -> (Matrix<S, N>, Matrix<S, N>) {
        (**self).single_valued_derivatives(q, v, tau)
    }

    #[inline(always)]
    fn grips(&self, tau: &[S; N]) -> [Grip<S>; N] {
        (**self).grips(tau)
    }

    #[inline(always)]
    fn stops(&self) -> [Stop<S>; N] {
        (**self).stops()
    }

    #[inline(always)]
    fn slopes(&self, coefficient: Coefficient, v: &[S; N]) -> [S; N] {
        (**self).slopes(coefficient, v)
    }

    #[inline(always)]
    fn network_columns(&self, q: &[S; N], v: &[S; N], numbers: &[Number], columns: &mut [Column<S, N>]) {
        (**self).network_columns(q, v, numbers, columns);
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

/// A Lagrangian and forces in addition to it: the system that the solvers step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System<L, F> {
    /// L = T − V.
    pub lagrangian: L,
    /// Forces Q other than the control force.
    pub forces: F,
}

impl<L, F> System<L, F> {
    /// T and V, J, including the potentials that forces store.
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
