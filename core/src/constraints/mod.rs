//! Holonomic constraints φ(q) = 0 between particles: rods, anchors and held coordinates, and the multipliers λ that keep them.
//!
//! With A = ∂φ/∂q, the constraint forces are Aᵀλ, and every method that keeps a constraint solves (A M⁻¹ Aᵀ) λ = b. The mass matrix has one
//! block per node and an equation touches few nodes, so the matrix is banded: its band is 1 for a chain in order, and time and memory are
//! then linear in the length of the chain. [`Constrained::new`] finds the band once.
//!
//! Beside dry friction that sticks, what sticks leaves M⁻¹, and an equation that no other coordinate can change gets no impulse: see
//! [`rattle`](crate::discrete::rattle#dry-friction-that-sticks).
//!
//! Sources: LGNN (its equation 2, corrected); Hairer, Lubich, Wanner, "Geometric Numerical Integration", section VII.1.

mod banded;
mod constrained;
mod holonomic;
mod multipliers;
mod workspace;

pub use constrained::Constrained;
pub use holonomic::Holonomic;

pub(crate) use banded::Banded;
pub(crate) use constrained::check_length;
pub(crate) use multipliers::{Rows, inverse};
pub(crate) use workspace::Workspace;

use crate::linear::SolveError;
use crate::newton::{Report, StepError};
use crate::scalar::{Real, sum};
use core::fmt;

/// Holonomic constraints φ_k(q) = 0, each on a few nodes in `D` dimensions.
///
/// Near φ = 0, φ is scaled to a length: its gradient with respect to a node is about a unit vector. Then A M⁻¹
/// Aᵀ is well scaled and λ is a force in newtons.
pub trait Constraints<R: Real, const D: usize> {
    /// Number of equations.
    fn equations(&self) -> usize;
    /// The nodes that an equation touches, in a fixed order: few, and each only once.
    fn nodes(&self, equation: usize) -> &[usize];
    /// Reference length for a small |φ|, m; positive.
    fn size(&self, equation: usize) -> R;
    /// Value φ, m.
    fn value(&self, equation: usize, x: Positions<R, D>) -> R;
    /// ∂φ/∂q for the node at index `slot` of [`Constraints::nodes`].
    fn gradient(&self, equation: usize, slot: usize, x: Positions<R, D>) -> [R; D];
    /// (Ȧ v) = vᵀ φ_qq v, m/s².
    fn curvature(&self, equation: usize, x: Positions<R, D>, v: &[[R; D]]) -> R;
}

/// Positions q + carry; the carry is the part of q lost to rounding.
///
/// A step divides φ by h, so a rounding error of φ appears in the velocity, multiplied by 1/h. φ should
/// therefore use both parts and, if it can, keep more digits than R has ([`Positions::between`] does so for
/// differences). At the least it should be φ(q) + A carry.
#[derive(Clone, Copy, Debug)]
pub struct Positions<'a, R, const D: usize> {
    q: &'a [[R; D]],
    carry: &'a [[R; D]],
}

impl<'a, R: Real, const D: usize> Positions<'a, R, D> {
    /// Positions without a carry, m.
    pub const fn new(q: &'a [[R; D]]) -> Self {
        Self { q, carry: &[] }
    }

    /// Positions with their carry, m.
    pub const fn with_carry(q: &'a [[R; D]], carry: &'a [[R; D]]) -> Self {
        Self { q, carry }
    }

    /// (q, carry) of a node.
    #[inline(always)]
    pub fn node(&self, node: usize) -> ([R; D], [R; D]) {
        // Positions without a carry have an empty slice.
        (at(self.q, node), self.carry.get(node).copied().unwrap_or([R::zero(); D]))
    }

    /// Difference d from node b to node a, and its remainder; their sum is exact to twice the precision of R.
    #[inline(always)]
    pub fn between(&self, a: usize, b: usize) -> ([R; D], [R; D]) {
        difference(self.node(a), self.node(b))
    }

    /// Difference from a point to node a, like [`Positions::between`].
    #[inline(always)]
    pub fn from_point(&self, a: usize, point: &[R; D]) -> ([R; D], [R; D]) {
        difference(self.node(a), (*point, [R::zero(); D]))
    }
}

/// Difference a − b of two numbers that each come as (value, carry); the result is again a value and its carry.
#[inline(always)]
fn difference<R: Real, const D: usize>(a: ([R; D], [R; D]), b: ([R; D], [R; D])) -> ([R; D], [R; D]) {
    let (mut d, mut rest) = ([R::zero(); D], [R::zero(); D]);
    for i in 0..D {
        let lost;
        (d[i], lost) = sum(a.0[i], -b.0[i]);
        rest[i] = (a.1[i] - b.1[i]) + lost;
    }
    (d, rest)
}

/// Reason for refusing constrained motion; the state is unchanged.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConstraintError<R> {
    /// A constraint touches a node that the system does not have.
    Node {
        /// The equation.
        constraint: usize,
        /// The node that the constraint names.
        node: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// The length of a constraint is not positive and finite; a held coordinate beyond the dimensions has length 0.
    Length {
        /// The equation.
        constraint: usize,
        /// Length of the equation, m.
        length: R,
    },
    /// A slice of nodes, of multipliers or of a saved state has the wrong length.
    Shape {
        /// Expected length.
        expected: usize,
        /// Given length.
        given: usize,
    },
    /// The workspace is too short.
    Workspace {
        /// Length needed.
        needed: usize,
        /// Length given.
        given: usize,
    },
    /// Positions at the start do not satisfy a constraint.
    Off {
        /// The equation with the largest violation.
        constraint: usize,
        /// |φ| relative to the equation's length.
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
    /// Dry friction of a node that is no number of at least 0, or a breakaway ratio below 1.
    Grip {
        /// The node.
        node: usize,
        /// The coordinate, from 0.
        axis: usize,
    },
    /// The width of the smooth law of dry friction is not positive and finite.
    Width {
        /// The width ε, m/s.
        width: R,
    },
    /// A step, or a part of one of order 4, that goes back in time or nowhere, where dry friction that sticks has no solution.
    Backward {
        /// Length of the step or of its part, s.
        h: R,
    },
    /// Positions, momenta, forces or energies are infinite or NaN.
    NotFinite,
    /// The equations of a step were not solved within the allowed iterations.
    NotConverged(Report<R>),
}

impl<R> From<StepError<R>> for ConstraintError<R> {
    fn from(error: StepError<R>) -> Self {
        match error {
            StepError::Singular { column } => Self::Redundant { constraint: column.into() },
            StepError::NotFinite => Self::NotFinite,
            StepError::NotConverged(report) => Self::NotConverged(report),
        }
    }
}

impl<R: fmt::Display> fmt::Display for ConstraintError<R> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Node { constraint, node, nodes } => {
                write!(f, "constraint {constraint} names node {node}, but there are {nodes} nodes")
            }
            Self::Length { constraint, length } => {
                write!(f, "the length of constraint {constraint}, {length} m, is not positive and finite")
            }
            Self::Shape { expected, given } => {
                write!(f, "a slice holds {given} nodes, multipliers or saved numbers instead of {expected}")
            }
            Self::Workspace { needed, given } => {
                write!(f, "the workspace holds {given} numbers, but {needed} are needed")
            }
            Self::Off { constraint, residual } => {
                write!(f, "the start violates constraint {constraint} by {residual} of its length")
            }
            Self::Redundant { constraint } => {
                write!(f, "constraint {constraint} follows from those before it, or contradicts them")
            }
            Self::Mass { node } => write!(f, "the mass of node {node} is singular"),
            Self::Grip { node, axis } => write!(
                f,
                "the dry friction of node {node} along axis {axis} needs levels of at least 0 and a breakaway ratio of at least 1"
            ),
            Self::Width { width } => {
                write!(
                    f,
                    "the width of the smooth law of dry friction, {width} m/s, is not positive and finite"
                )
            }
            Self::Backward { h } => write!(
                f,
                "friction that sticks cannot be stepped by {h} s: use order 2 and a step above 0, for order 4 goes back in time"
            ),
            Self::NotFinite => SolveError::NotFinite.fmt(f),
            Self::NotConverged(report) => report.not_converged(f),
        }
    }
}

impl<R: fmt::Debug + fmt::Display> core::error::Error for ConstraintError<R> {}

/// The vector of a node. The node always exists: [`Constrained::new`] checks the nodes of the constraints, and
/// every entry point checks its slices.
#[inline(always)]
pub(crate) fn at<R: Real, const D: usize>(x: &[[R; D]], node: usize) -> [R; D] {
    debug_assert!(node < x.len(), "node {node} of {}", x.len());
    x.get(node).copied().unwrap_or([R::zero(); D])
}
