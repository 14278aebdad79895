use crate::linear::{Matrix, add_scaled};
use crate::particles::Particles;
use crate::scalar::Real;

/// Which of the two lines of a step is solved, for velocities v and impulses Λ.
#[derive(Clone, Copy)]
pub(super) enum Stage<R> {
    /// L_v(v) = p + A(q)ᵀΛ, φ(q + hv) = 0.
    Positions { h: R },
    /// L_v(v) = p + ½h Q(v) + A(q)ᵀΛ, A(q) v = 0.
    Velocities { half: R },
}

impl<R: Real> Stage<R> {
    /// p + ½h Q(v) − L_v(v) of a node, and the size of its terms.
    #[inline(always)]
    pub fn imbalance<S: Particles<R, D>, const D: usize>(
        self,
        system: &S,
        node: usize,
        v: &[R; D],
        p: &[R; D],
    ) -> ([R; D], R) {
        let l_v = system.l_v(node, v);
        let r = add_scaled(p, -R::one(), &l_v);
        let r = match self {
            Self::Positions { .. } => r,
            Self::Velocities { half } => add_scaled(&r, half, &system.drag(node, v)),
        };
        (r, size(p) + size(&l_v))
    }

    /// M − ½h ∂Q/∂v of a node.
    #[inline(always)]
    pub fn effective_mass<S: Particles<R, D>, const D: usize>(
        self,
        system: &S,
        node: usize,
        v: &[R; D],
    ) -> Matrix<R, D> {
        let mut mass = system.mass(node, v);
        if let Self::Velocities { half } = self {
            let slope = system.drag_slope(node, v);
            for i in 0..D {
                mass[i][i] -= half * slope[i];
            }
        }
        mass
    }
}

/// The terms that rounding acts on, largest over the nodes.
#[derive(Clone, Copy)]
pub(super) struct Scale<R> {
    /// What a stage changes momenta by before constraints answer, kg m/s.
    pub impulse: R,
    /// Velocities and their change, m/s.
    pub velocity: R,
}

/// The larger; not finite if either is not.
#[inline(always)]
pub(super) fn worse<R: Real>(a: R, b: R) -> R {
    if a > b || !a.is_finite() { a } else { b }
}

/// Σ|x_i|; not finite if any is not.
#[inline(always)]
pub(super) fn size<R: Real, const D: usize>(x: &[R; D]) -> R {
    x.iter().fold(R::zero(), |sum, x| sum + x.abs())
}

pub(super) fn largest<R: Real, const D: usize>(x: &[[R; D]]) -> R {
    x.iter().fold(R::zero(), |largest, x| worse(largest, size(x)))
}

/// a relative to the size of its terms; 0 where all vanish.
#[inline(always)]
pub(super) fn relative<R: Real>(a: R, size: R) -> R {
    a / (size + R::EPSILON * R::EPSILON * R::EPSILON)
}
