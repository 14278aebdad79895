//! Shapes whose sizes are types.

use super::Constraint;
use leastaction_core::energy::{Learnable, LearnableForces};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::ModelError;
use leastaction_core::scalar::{Lanes, Scalar};

/// What host weights are evaluated in: f64, lanes of it, or either with a derivative.
pub trait HostScalar: Scalar<Weight = f64> + Sync + 'static {
    /// `then` where this is greater, else `otherwise`; in every lane for itself.
    #[must_use]
    fn if_greater(self, than: Self, then: Self, otherwise: Self) -> Self;
}

impl HostScalar for f64 {
    #[inline]
    fn if_greater(self, than: Self, then: Self, otherwise: Self) -> Self {
        if self > than { then } else { otherwise }
    }
}

impl HostScalar for Lanes {
    #[inline]
    fn if_greater(self, than: Self, then: Self, otherwise: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].if_greater(than.0[k], then.0[k], otherwise.0[k])))
    }
}

/// A shape whose sizes are types.
pub trait Family<const N: usize>: Sync {
    /// Its energies over host weights.
    type Lagrangian<'w, S: HostScalar>: Lagrangian<S, N> + Learnable<S, N> + Sync + 'w
    where
        Self: 'w;
    /// Its forces over host weights.
    type Forces<'w, S: HostScalar>: Forces<S, N> + LearnableForces<S, N> + Sync + 'w
    where
        Self: 'w;

    /// The system of this shape over a weight block.
    ///
    /// # Errors
    /// Where the block or the compiled sizes do not fit.
    fn system<'w, S: HostScalar>(
        &'w self,
        weights: &'w [f64],
    ) -> Result<FamilySystem<'w, Self, S, N>, ModelError>;

    /// Whether L_vv is positive definite wherever the weights are in their range: on constraints there is no acceleration elsewhere.
    const DEFINITE: bool = true;

    /// The holonomic constraints φ(q) = 0 of this shape. None for most.
    fn constraints(&self, _q: &[f64; N]) -> Vec<Constraint<N>> {
        Vec::new()
    }
}

/// The system of a family in a scalar.
pub type FamilySystem<'w, F, S, const N: usize> =
    System<<F as Family<N>>::Lagrangian<'w, S>, <F as Family<N>>::Forces<'w, S>>;

/// Something to do once the sizes are types.
pub trait Visitor {
    /// What it gives.
    type Output;
    /// Does it for N coordinates.
    fn visit<F: Family<N> + Clone + 'static, const N: usize>(self, family: &F) -> Self::Output;
}
