use super::{Constraints, Positions, at};
use crate::linear::{Matrix, dot, multiply, solve_definite};
use crate::scalar::Real;

/// The Jacobian A = ∂φ/∂q at given positions, row by row and never stored.
pub(crate) struct Rows<'a, R, C: ?Sized, const D: usize> {
    pub constraints: &'a C,
    pub x: Positions<'a, R, D>,
}

impl<R: Real, C: Constraints<R, D> + ?Sized, const D: usize> Rows<'_, R, C, D> {
    /// (A x)_k.
    #[inline(always)]
    pub fn times(&self, equation: usize, x: &[[R; D]]) -> R {
        self.constraints.nodes(equation).iter().enumerate().fold(R::zero(), |sum, (slot, node)| {
            sum + dot(&self.constraints.gradient(equation, slot, self.x), &at(x, *node))
        })
    }

    /// (A W A₀ᵀ)_kl with the Jacobian A₀ of `other` and the blocks W_i of the nodes.
    #[inline(always)]
    pub fn coupling(&self, k: usize, weights: &[Matrix<R, D>], other: &Self, l: usize) -> R {
        let (rows, columns) = (self.constraints, other.constraints);
        rows.nodes(k).iter().enumerate().fold(R::zero(), |sum, (slot, node)| {
            let same = columns.nodes(l).iter().position(|same| same == node);
            let (Some(same), Some(weight)) = (same, weights.get(*node)) else { return sum };
            let (left, right) = (rows.gradient(k, slot, self.x), columns.gradient(l, same, other.x));
            sum + dot(&left, &multiply(weight, &right))
        })
    }

    /// Calls `add` with each node's part of Aᵀλ.
    #[inline(always)]
    pub fn transposed_times(&self, lambda: &[R], mut add: impl FnMut(usize, [R; D])) {
        for (equation, lambda) in lambda.iter().enumerate() {
            for (slot, node) in self.constraints.nodes(equation).iter().enumerate() {
                add(*node, self.constraints.gradient(equation, slot, self.x).map(|a| a * *lambda));
            }
        }
    }
}

/// M⁻¹ of a node's symmetric block; `None` if a pivot vanishes.
#[inline(always)]
pub(crate) fn inverse<R: Real, const D: usize>(mass: Matrix<R, D>) -> Option<Matrix<R, D>> {
    let unit = |i| core::array::from_fn(|j| if i == j { R::one() } else { R::zero() });
    solve_definite(mass, core::array::from_fn::<[R; D], D, _>(unit)).ok()
}
