use super::{Constraints, at};
use crate::linear::dot;
use crate::scalar::{Real, product, sum};

/// One holonomic constraint of particles; a slice of them implements [`Constraints`], one equation each.
///
/// A distance d is kept at ℓ by φ = (|d|² − ℓ²)/(2ℓ), which is |d| − ℓ to first order but needs no square root: its
/// gradient d/ℓ is smooth everywhere and its curvature |ḋ|²/ℓ has no projection to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holonomic<R, const D: usize> {
    /// A massless rod between two nodes.
    Rod {
        /// The nodes.
        nodes: [usize; 2],
        /// ℓ, m.
        length: R,
    },
    /// A massless rod from a node to a fixed point.
    Anchor {
        /// The node.
        node: usize,
        /// The fixed point, m.
        to: [R; D],
        /// ℓ, m.
        length: R,
    },
    /// One coordinate of a node is held; [`Holonomic::held`] holds all of them.
    Held {
        /// The node.
        node: usize,
        /// The coordinate, from 0.
        axis: usize,
        /// Its value, m.
        at: R,
    },
}

impl<R: Real, const D: usize> Holonomic<R, D> {
    /// A node held at a fixed point: one equation for each coordinate.
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
            Self::Held { at, .. } => R::one() + at.abs(),
        }
    }

    /// d, from the second node or the fixed point to the first; not of a held coordinate.
    #[inline(always)]
    fn distance(&self, q: &[[R; D]]) -> [R; D] {
        match self {
            Self::Rod { nodes: [a, b], .. } => minus(&at(q, *a), &at(q, *b)),
            Self::Anchor { node, to, .. } => minus(&at(q, *node), to),
            Self::Held { .. } => [R::zero(); D],
        }
    }

    #[inline(always)]
    fn value(&self, q: &[[R; D]]) -> R {
        match *self {
            Self::Held { node, axis, at: value } => component(&at(q, node), axis) - value,
            Self::Rod { length, .. } | Self::Anchor { length, .. } => {
                let d = self.distance(q);
                (dot(&d, &d) - length * length).half() / length
            }
        }
    }

    #[inline(always)]
    fn carried_value(&self, q: &[[R; D]], carry: &[[R; D]]) -> R {
        let zero = [R::zero(); D];
        match *self {
            Self::Rod { nodes: [a, b], length } => {
                stretch([&at(q, a), &at(carry, a)], [&at(q, b), &at(carry, b)], length)
            }
            Self::Anchor { node, to, length } => {
                stretch([&at(q, node), &at(carry, node)], [&to, &zero], length)
            }
            Self::Held { node, axis, .. } => self.value(q) + component(&at(carry, node), axis),
        }
    }

    #[inline(always)]
    fn gradient(&self, slot: usize, q: &[[R; D]]) -> [R; D] {
        match *self {
            Self::Held { axis, .. } => core::array::from_fn(|i| if i == axis { R::one() } else { R::zero() }),
            Self::Rod { length, .. } | Self::Anchor { length, .. } => {
                let length = if slot == 0 { length } else { -length };
                self.distance(q).map(|d| d / length)
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

/// Zero for an axis that is not there, as if it were held already: then its equation has no gradient and is redundant.
#[inline(always)]
fn component<R: Real, const D: usize>(x: &[R; D], axis: usize) -> R {
    x.get(axis).copied().unwrap_or(R::zero())
}

/// (|a − b|² − ℓ²)/(2ℓ) to twice the precision of R where it is near zero; both points as value and carry.
#[inline]
fn stretch<R: Real, const D: usize>(a: [&[R; D]; 2], b: [&[R; D]; 2], length: R) -> R {
    let (square, error) = product(length, length);
    let (mut high, mut low) = (-square, -error);
    for i in 0..D {
        let (d, lost) = sum(a[0][i], -b[0][i]);
        let rest = (a[1][i] - b[1][i]) + lost;
        let (square, error) = product(d, d);
        let (total, lost) = sum(high, square);
        high = total;
        low += lost + error + (d + d) * rest;
    }
    (high + low).half() / length
}

impl<R: Real, const D: usize> Constraints<R, D> for [Holonomic<R, D>] {
    fn equations(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn nodes(&self, equation: usize) -> &[usize] {
        self.get(equation).map_or(&[], Holonomic::nodes)
    }

    fn size(&self, equation: usize) -> R {
        self.get(equation).map_or(R::zero(), Holonomic::size)
    }

    fn value(&self, equation: usize, q: &[[R; D]]) -> R {
        self.get(equation).map_or(R::zero(), |item| item.value(q))
    }

    #[inline(always)]
    fn carried_value(&self, equation: usize, q: &[[R; D]], carry: &[[R; D]]) -> R {
        self.get(equation).map_or(R::zero(), |item| item.carried_value(q, carry))
    }

    #[inline(always)]
    fn gradient(&self, equation: usize, slot: usize, q: &[[R; D]]) -> [R; D] {
        self.get(equation).map_or([R::zero(); D], |item| item.gradient(slot, q))
    }

    fn curvature(&self, equation: usize, _: &[[R; D]], v: &[[R; D]]) -> R {
        self.get(equation).map_or(R::zero(), |item| item.curvature(v))
    }
}
