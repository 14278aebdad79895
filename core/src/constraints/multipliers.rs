use super::{Constraints, Positions, at};
use crate::linear::{Matrix, dot, multiply, solve_definite};
use crate::scalar::Real;

/// The Jacobian A = ∂φ/∂q at positions, row by row and never stored.
pub(crate) struct Rows<'a, R, C: ?Sized, const D: usize> {
    pub constraints: &'a C,
    pub x: Positions<'a, R, D>,
}

impl<R: Real, C: Constraints<R, D> + ?Sized, const D: usize> Rows<'_, R, C, D> {
    /// Σ over the nodes of an equation.
    #[inline(always)]
    fn sum(&self, equation: usize, term: impl Fn(usize, [R; D]) -> R) -> R {
        let nodes = self.constraints.nodes(equation).iter().enumerate();
        nodes.fold(R::zero(), |sum, (slot, node)| {
            sum + term(*node, self.constraints.gradient(equation, slot, self.x))
        })
    }

    /// (A x)_k.
    #[inline(always)]
    pub fn times(&self, equation: usize, x: &[[R; D]]) -> R {
        self.sum(equation, |node, gradient| dot(&gradient, &at(x, node)))
    }

    /// (A W A₀ᵀ)_kl with the blocks W_i of the nodes.
    #[inline(always)]
    pub fn coupling(&self, k: usize, weights: &[Matrix<R, D>], other: &Self, l: usize) -> R {
        let shared = self.constraints.nodes(k).iter().any(|node| self.constraints.nodes(l).contains(node));
        if !shared {
            return R::zero();
        }
        self.sum(k, |node, left| {
            let weight = weights.get(node).copied().unwrap_or([[R::zero(); D]; D]);
            let weighted = multiply(&weight, &left);
            other.sum(l, |same, right| if node == same { dot(&weighted, &right) } else { R::zero() })
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

/// M⁻¹ of a node's symmetric block; none where a pivot vanishes.
#[inline(always)]
pub(crate) fn inverse<R: Real, const D: usize>(mass: Matrix<R, D>) -> Option<Matrix<R, D>> {
    let unit = |i| core::array::from_fn(|j| if i == j { R::one() } else { R::zero() });
    solve_definite(mass, core::array::from_fn::<[R; D], D, _>(unit)).ok()
}
