use crate::ForcesOf;
use leastaction_core::energy::MAX_HIDDEN;
use leastaction_core::forces::System;
use leastaction_core::lagrangian::{
    Column, Dynamics, Energies, Gradient, Hessian, Lagrangian, Linearization,
};
use leastaction_core::linear::SolveError;

/// Maximum number of hidden layers of a network, as in a model file.
pub const LAYERS: usize = MAX_HIDDEN;
/// Maximum number of units in a hidden layer of an inertia network. A layer takes stack only for the units that it has.
pub const INERTIA_NETWORK_UNITS: usize = 1024;
/// Maximum number of units in a hidden layer of a network of an element, a node or an edge.
pub const UNITS: usize = 64;

/// A Lagrangian in N coordinates, of any family and shape that a file may have.
pub struct AnyLagrangian<'f, const N: usize>(Box<dyn Lagrangian<f32, N> + Send + Sync + 'f>);

/// A model in N coordinates with the forces of its file, which the solvers of core step.
pub type SystemOf<'f, const N: usize> = System<AnyLagrangian<'f, N>, ForcesOf<'f, N>>;

impl<'f, const N: usize> AnyLagrangian<'f, N> {
    /// Wraps a Lagrangian for the solvers.
    pub(crate) fn new(lagrangian: impl Lagrangian<f32, N> + Send + Sync + 'f) -> Self {
        Self(Box::new(lagrangian))
    }

    /// Returns the same system with its Lagrangian wrapped in this type.
    pub(crate) fn erased<L: Lagrangian<f32, N> + Send + Sync + 'f>(
        System { lagrangian, forces }: System<L, ForcesOf<'f, N>>,
    ) -> SystemOf<'f, N> {
        System { lagrangian: Self::new(lagrangian), forces }
    }

    /// A system with this Lagrangian and other forces.
    pub fn with_forces<'s>(&'s self, forces: ForcesOf<'s, N>) -> SystemOf<'s, N> {
        System { lagrangian: AnyLagrangian::new(self), forces }
    }
}

impl<const N: usize> Lagrangian<f32, N> for AnyLagrangian<'_, N> {
    fn energies(&self, q: &[f32; N], v: &[f32; N]) -> Energies<f32> {
        self.0.energies(q, v)
    }

    fn gradient(&self, q: &[f32; N], v: &[f32; N]) -> Gradient<f32, N> {
        self.0.gradient(q, v)
    }

    fn dynamics(&self, q: &[f32; N], v: &[f32; N]) -> Dynamics<f32, N> {
        self.0.dynamics(q, v)
    }

    fn linearization(&self, q: &[f32; N], v: &[f32; N]) -> Linearization<f32, N> {
        self.0.linearization(q, v)
    }

    fn hessian(&self, q: &[f32; N], v: &[f32; N]) -> Hessian<f32, N> {
        self.0.hessian(q, v)
    }

    fn solves(&self) -> bool {
        self.0.solves()
    }

    fn forward_dynamics(&self, q: &[f32; N], v: &[f32; N], force: &[f32; N]) -> Result<[f32; N], SolveError> {
        self.0.forward_dynamics(q, v, force)
    }

    fn inertial_columns(
        &self,
        body: usize,
        q: &[f32; N],
        v: &[f32; N],
        columns: &mut [Column<f32, N>],
    ) -> usize {
        self.0.inertial_columns(body, q, v, columns)
    }
}
