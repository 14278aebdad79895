//! Holonomic constraints φ(q) = 0 between particles: rods, anchors and held coordinates, and the multipliers λ that keep them.
//!
//! With A = ∂φ/∂q the constraint forces are Aᵀλ, and everything that keeps a constraint solves (A M⁻¹ Aᵀ) λ = b. Masses are
//! blocks of one node each and an equation touches few nodes, so the matrix has a band: of width 1 for a chain in order, and
//! then time and memory are linear in its length. The band is found once, by [`Constrained::new`].
//!
//! Sources: LGNN (its equation 2, corrected); Hairer, Lubich, Wanner, "Geometric Numerical Integration", section VII.1.

mod banded;
mod constrained;
mod holonomic;
mod multipliers;
mod room;

pub use constrained::Constrained;
pub use holonomic::Holonomic;

pub(crate) use banded::Banded;
pub(crate) use multipliers::{Rows, inverse};
pub(crate) use room::Room;

use crate::scalar::Real;

/// Holonomic constraints φ_k(q) = 0, each of a few nodes in `D` dimensions.
///
/// φ is scaled to a length near φ = 0: its gradient with respect to a node is about a unit vector. Then A M⁻¹ Aᵀ is well
/// scaled and λ is a force in newtons.
pub trait Constraints<R: Real, const D: usize> {
    /// Number of equations.
    fn equations(&self) -> usize;
    /// The nodes that an equation touches, in a fixed order: few, and each once.
    fn nodes(&self, equation: usize) -> &[usize];
    /// The length, m, that |φ| is to be small against; positive.
    fn size(&self, equation: usize) -> R;
    /// φ, m.
    fn value(&self, equation: usize, q: &[[R; D]]) -> R;
    /// ∂φ/∂q of the node at place `slot` of [`Constraints::nodes`].
    fn gradient(&self, equation: usize, slot: usize, q: &[[R; D]]) -> [R; D];
    /// (Ȧ v) = vᵀ φ_qq v, m/s².
    fn curvature(&self, equation: usize, q: &[[R; D]], v: &[[R; D]]) -> R;

    /// φ, m, at q + carry, where carry is what rounding took from q.
    ///
    /// A step divides φ by h: what rounding does to φ, it does to the velocity 1/h times. Whoever can compute φ beyond the
    /// precision of R should; by default φ(q) + A carry.
    fn carried_value(&self, equation: usize, q: &[[R; D]], carry: &[[R; D]]) -> R {
        self.value(equation, q) + Rows { constraints: self, q }.times(equation, carry)
    }
}

/// Why constrained motion was refused; a state is as it was before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConstraintError<R> {
    /// A constraint touches a node that the system does not have.
    Node {
        /// The equation.
        constraint: usize,
        /// The node it names.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The length of a constraint is not positive and finite.
    Length {
        /// The equation.
        constraint: usize,
        /// Its length, m.
        length: R,
    },
    /// A slice of nodes or of multipliers is not as long as it should be.
    Shape {
        /// The length it should have.
        expected: usize,
        /// The length it has.
        given: usize,
    },
    /// The room is too short.
    Room {
        /// Numbers needed.
        needed: usize,
        /// Numbers given.
        given: usize,
    },
    /// Positions at the start do not satisfy a constraint.
    Off {
        /// The equation that is furthest off.
        constraint: usize,
        /// |φ| relative to its length.
        residual: R,
    },
    /// A constraint follows from the ones before it, or contradicts them: A M⁻¹ Aᵀ has no usable pivot.
    Redundant {
        /// The equation.
        constraint: usize,
    },
    /// The mass of a node is singular.
    Mass {
        /// The node.
        node: usize,
    },
    /// Positions, momenta, forces or energies are infinite or not numbers.
    NotFinite,
    /// The equations of a step were not solved within the bound of iterations.
    NotConverged {
        /// Newton updates taken.
        iterations: u8,
        /// Largest relative residual.
        residual: R,
    },
}

/// The vector of a node; zero for a node that is not there (which [`Constrained::new`] excludes).
#[inline(always)]
pub(crate) fn at<R: Real, const D: usize>(x: &[[R; D]], node: usize) -> [R; D] {
    x.get(node).copied().unwrap_or([R::zero(); D])
}
