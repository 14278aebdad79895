//! Functions of a vector's length alone: kinetic energies as functions of a velocity, pair potentials as functions of a difference.

use crate::linear::dot;
use crate::network::Jet;
use crate::scalar::Scalar;

/// φ(s) with φ′ and φ″ at s = |w|².
#[derive(Clone, Copy, Debug)]
pub(super) struct Radial<S> {
    pub value: S,
    pub first: S,
    pub second: S,
}

impl<S: Scalar> Radial<S> {
    /// φ and its derivatives; derivatives that the series does not carry are 0.
    #[inline(always)]
    pub fn of<const O: usize>(series: &Jet<S, O>) -> Self {
        let at = |k: usize| series.tangent.get(k).copied().unwrap_or(S::zero());
        Self { value: series.value, first: at(0), second: at(1) }
    }

    /// cs.
    #[inline(always)]
    pub fn linear(c: S, s: S) -> Self {
        Self { value: c * s, first: c, second: S::zero() }
    }

    /// c₁φ + c₂φ².
    #[inline(always)]
    pub fn quadratic(&self, [c1, c2]: [S; 2]) -> Self {
        let slope = c1 + (c2 + c2) * self.value;
        Self {
            value: (c1 + c2 * self.value) * self.value,
            first: slope * self.first,
            second: slope * self.second + (c2 + c2) * self.first * self.first,
        }
    }

    /// Adds two functions.
    #[inline(always)]
    pub fn plus(&self, other: &Self) -> Self {
        let Self { value, first, second } = *other;
        Self { value: self.value + value, first: self.first + first, second: self.second + second }
    }

    /// ∂φ/∂w = 2φ′w.
    #[inline(always)]
    pub fn gradient<const D: usize>(&self, w: &[S; D]) -> [S; D] {
        let (c, mut gradient) = (self.first + self.first, *w);
        gradient.iter_mut().for_each(|w| *w = c * *w);
        gradient
    }

    /// ∂²φ/∂w² = 2φ′1 + 4φ″wwᵀ.
    #[inline(always)]
    pub fn hessian<const D: usize>(&self, w: &[S; D]) -> [[S; D]; D] {
        let along = S::constant(4.0) * self.second;
        let mut hessian = [[S::zero(); D]; D];
        for (i, (row, a)) in hessian.iter_mut().zip(w).enumerate() {
            row.iter_mut().zip(w).for_each(|(entry, b)| *entry = along * *a * *b);
            row[i] += self.first + self.first;
        }
        hessian
    }
}

/// |w|².
#[inline(always)]
pub(super) fn square<S: Scalar, const D: usize>(w: &[S; D]) -> S {
    dot(w, w)
}
