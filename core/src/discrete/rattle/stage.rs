use crate::linear::{Matrix, add_scaled};
use crate::particles::Particles;
use crate::scalar::Real;

/// The line of a step that is being solved, for velocities v and impulses Λ.
#[derive(Clone, Copy)]
pub(super) enum Stage<R> {
    /// L_v(v) = p + A(q)ᵀΛ, φ(q + hv) = 0.
    Positions { h: R },
    /// L_v(v) = p + ½h Q(v) + A(q)ᵀΛ, A(q) v = 0.
    Velocities { half: R },
}

/// Maximum number of nodes evaluated side by side.
pub(super) const BLOCK: usize = 8;

impl<R: Real> Stage<R> {
    /// Writes p + ½h Q(v) − L_v(v) for a block of nodes, and the size of its terms.
    // Not inlined, so that all solvers share one copy of the code.
    #[inline(never)]
    pub fn imbalances<S: Particles<R, D>, const D: usize>(
        self,
        system: &S,
        first: usize,
        (v, p): (&[[R; D]], &[[R; D]]),
        (r, terms): (&mut [[R; D]], &mut [R; BLOCK]),
    ) {
        system.momenta(first, v, r);
        for ((r, terms), p) in r.iter_mut().zip(terms).zip(p) {
            *terms = size(p) + size(r);
            *r = add_scaled(p, -R::one(), r);
        }
        if let Self::Velocities { half } = self {
            let mut drags = [[R::zero(); D]; BLOCK];
            system.single_valued_drags(first, v, &mut drags);
            r.iter_mut().zip(&drags).for_each(|(r, drag)| *r = add_scaled(r, half, drag));
        }
    }

    /// Writes M − ½h ∂Q/∂v for a block of nodes.
    #[inline]
    pub fn effective_masses<S: Particles<R, D>, const D: usize>(
        self,
        system: &S,
        first: usize,
        v: &[[R; D]],
        masses: &mut [Matrix<R, D>],
    ) {
        system.masses(first, v, masses);
        if let Self::Velocities { half } = self {
            let mut slopes = [[R::zero(); D]; BLOCK];
            system.single_valued_drag_slopes(first, v, &mut slopes);
            for (mass, slope) in masses.iter_mut().zip(&slopes) {
                for i in 0..D {
                    mass[i][i] -= half * slope[i];
                }
            }
        }
    }
}

/// Sizes of the terms that rounding acts on, the largest over the nodes.
#[derive(Clone, Copy)]
pub(super) struct Scale<R> {
    /// Change of momenta in a stage before the constraints respond, kg m/s.
    pub impulse: R,
    /// Velocities or their change, whichever is larger, m/s.
    pub velocity: R,
}

impl<R: Real> Scale<R> {
    /// The scale before the first update, when none is known.
    #[inline(always)]
    pub fn ones() -> Self {
        Self { impulse: R::one(), velocity: R::one() }
    }
}

/// The larger number; not finite if either is not.
#[inline(always)]
pub(super) fn worse<R: Real>(a: R, b: R) -> R {
    if a > b || !a.is_finite() { a } else { b }
}

/// Σ|x_i|; not finite if any is not.
#[inline(always)]
pub(super) fn size<R: Real, const D: usize>(x: &[R; D]) -> R {
    x.iter().fold(R::zero(), |sum, x| sum + x.abs())
}

#[inline(never)]
pub(super) fn largest<R: Real, const D: usize>(x: &[[R; D]]) -> R {
    x.iter().fold(R::zero(), |largest, x| worse(largest, size(x)))
}
