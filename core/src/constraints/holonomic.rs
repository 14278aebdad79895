use super::{Constraints, Positions, at};
use crate::linear::dot;
use crate::scalar::{Real, product, sum};

/// One holonomic constraint of particles. A slice of them implements [`Constraints`], with one equation each.
///
/// A distance d is kept at ℓ by φ = (|d|² − ℓ²)/(2ℓ), which equals |d| − ℓ to first order but needs no square root: its gradient d/ℓ is
/// smooth everywhere, and its curvature |ḋ|²/ℓ needs no projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holonomic<R, const D: usize> {
    /// A massless rod between two nodes.
    Rod {
        /// The nodes.
        nodes: [usize; 2],
        /// Length ℓ, m.
        length: R,
    },
    /// A massless rod from a node to a fixed point.
    Anchor {
        /// The node.
        node: usize,
        /// The fixed point, m.
        to: [R; D],
        /// Length ℓ, m.
        length: R,
    },
    /// One held coordinate of a node; [`Holonomic::held`] holds all coordinates.
    Held {
        /// The node.
        node: usize,
        /// The coordinate, from 0.
        axis: usize,
        /// Value of the coordinate, m.
        at: R,
    },
}

/// Coordinate 0 of node 0 held at 0: a placeholder for the unfilled places of a list.
impl<R: Real, const D: usize> Default for Holonomic<R, D> {
    fn default() -> Self {
        Self::Held { node: 0, axis: 0, at: R::zero() }
    }
}

impl<R: Real, const D: usize> Holonomic<R, D> {
    /// Holds a node at a fixed point: one equation per coordinate.
    pub fn held(node: usize, at: [R; D]) -> [Self; D] {
        core::array::from_fn(|axis| Self::Held { node, axis, at: at[axis] })
    }

    fn nodes(&self) -> &[usize] {
        match self {
            Self::Rod { nodes, .. } => nodes,
            Self::Anchor { node, .. } | Self::Held { node, .. } => core::slice::from_ref(node),
        }
    }

    fn size(&self) -> R {
        match *self {
            Self::Rod { length, .. } | Self::Anchor { length, .. } => length,
            Self::Held { axis, at, .. } if axis < D => R::one() + at.abs(),
            Self::Held { .. } => R::zero(),
        }
    }

    /// Vector d from the second node or the fixed point to the first, and its remainder; 0 for a held coordinate.
    #[inline(always)]
    fn distance(&self, x: Positions<R, D>) -> ([R; D], [R; D]) {
        match self {
            Self::Rod { nodes: [a, b], .. } => x.between(*a, *b),
            Self::Anchor { node, to, .. } => x.from_point(*node, to),
            Self::Held { .. } => ([R::zero(); D], [R::zero(); D]),
        }
    }

    #[inline(always)]
    fn value(&self, x: Positions<R, D>) -> R {
        match *self {
            Self::Rod { length, .. } | Self::Anchor { length, .. } => stretch(self.distance(x), length),
            Self::Held { node, axis, at } => {
                let (q, carry) = x.node(node);
                (component(&q, axis) - at) + component(&carry, axis)
            }
        }
    }

    #[inline(always)]
    fn gradient(&self, slot: usize, x: Positions<R, D>) -> [R; D] {
        match *self {
            Self::Held { axis, .. } => core::array::from_fn(|i| if i == axis { R::one() } else { R::zero() }),
            Self::Rod { length, .. } | Self::Anchor { length, .. } => {
                let length = if slot == 0 { length } else { -length };
                let (d, rest) = self.distance(x);
                core::array::from_fn(|i| (d[i] + rest[i]) / length)
            }
        }
    }

    fn curvature(&self, v: &[[R; D]]) -> R {
        match *self {
            Self::Held { .. } => R::zero(),
            Self::Rod { nodes: [a, b], length } => {
                let rate = minus(&at(v, a), &at(v, b));
                dot(&rate, &rate) / length
            }
            Self::Anchor { node, length, .. } => {
                let rate = at(v, node);
                dot(&rate, &rate) / length
            }
        }
    }
}

#[inline(always)]
fn minus<R: Real, const D: usize>(a: &[R; D], b: &[R; D]) -> [R; D] {
    core::array::from_fn(|i| a[i] - b[i])
}

/// Component `axis` of x. It always exists: an equation with any other axis has size 0 and is refused.
#[inline(always)]
fn component<R: Real, const D: usize>(x: &[R; D], axis: usize) -> R {
    debug_assert!(axis < D, "axis {axis} of {D}");
    x.get(axis).copied().unwrap_or(R::zero())
}

/// (|d|² − ℓ²)/(2ℓ), to twice the precision of R near zero.
#[inline(always)]
fn stretch<R: Real, const D: usize>((d, rest): ([R; D], [R; D]), length: R) -> R {
    let (square, error) = product(length, length);
    let (mut high, mut low) = (-square, -error);
    for i in 0..D {
        let (square, error) = product(d[i], d[i]);
        let (total, lost) = sum(high, square);
        high = total;
        low += lost + error + (d[i] + d[i]) * rest[i];
    }
    (high + low).half() / length
}

/// Equation number `equation` of the list. It always exists: callers count up to [`Constraints::equations`].
#[inline(always)]
fn equation_of<R, const D: usize>(list: &[Holonomic<R, D>], equation: usize) -> Option<&Holonomic<R, D>> {
    debug_assert!(equation < list.len(), "equation {equation} of {}", list.len());
    list.get(equation)
}

impl<R: Real, const D: usize> Constraints<R, D> for [Holonomic<R, D>] {
    fn equations(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn nodes(&self, equation: usize) -> &[usize] {
        equation_of(self, equation).map_or(&[], Holonomic::nodes)
    }

    fn size(&self, equation: usize) -> R {
        equation_of(self, equation).map_or(R::zero(), Holonomic::size)
    }

    #[inline(always)]
    fn value(&self, equation: usize, x: Positions<R, D>) -> R {
        equation_of(self, equation).map_or(R::zero(), |item| item.value(x))
    }

    #[inline(always)]
    fn gradient(&self, equation: usize, slot: usize, x: Positions<R, D>) -> [R; D] {
        equation_of(self, equation).map_or([R::zero(); D], |item| item.gradient(slot, x))
    }

    fn curvature(&self, equation: usize, _: Positions<R, D>, v: &[[R; D]]) -> R {
        equation_of(self, equation).map_or(R::zero(), |item| item.curvature(v))
    }
}
