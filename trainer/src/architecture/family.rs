//! Shapes whose sizes are types.

use super::Constraint;
use leastaction_core::energy::{Learnable, LearnableForces};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::{DenseMass, Lagrangian};
use leastaction_core::model::ModelError;
use leastaction_core::scalar::Scalar;

/// What host weights are evaluated in: f64, or lanes of it.
pub trait HostScalar: Scalar<Weight = f64> + Sync + 'static {}
impl<S: Scalar<Weight = f64> + Sync + 'static> HostScalar for S {}

/// A shape whose sizes are types.
pub trait Family<const N: usize>: Sync {
    /// Its energies over host weights.
    type Lagrangian<'w, S: HostScalar>: Lagrangian<S, N, Mass = DenseMass<S, N>> + Learnable<S, N> + Sync + 'w
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

    /// Whether shapes of this family can have holonomic constraints; then L = T(v) − V(q), and drag depends on v alone.
    const CONSTRAINED: bool = false;

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
