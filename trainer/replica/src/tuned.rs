//! A model whose numbers may be changed while it runs.

use crate::file::{ArmLoader, BodiesLoader};
use crate::sizes::Load;
use crate::{AnyLagrangian, ForcesOf, ModelFile, ReplicaError, SystemOf};
use leastaction_core::adapt::{Number, Tunable};
use leastaction_core::model::{Family, Laws, Layout, ModelError};

/// A model of bodies whose numbers may be changed, as [`leastaction_core::model::Tuned`]: its file, which stays what it is, and a block of
/// numbers in memory.
pub struct TunedOf<'f, const N: usize> {
    family: Family<'f>,
    laws: Laws<'f>,
    layout: Layout<'f>,
    weights: &'f [f32],
    block: Vec<f32>,
    file: SystemOf<'f, N>,
}

impl<'f, const N: usize> TunedOf<'f, N> {
    /// Creates the model of a file, with the numbers of the file.
    ///
    /// # Errors
    /// [`ReplicaError::Model`] for a family whose numbers cannot be changed, and for another number of coordinates.
    pub fn new(file: &'f ModelFile) -> Result<Self, ReplicaError> {
        let (family, laws, weights) = file.changeable()?;
        let layout = Layout::of(&family, laws)?;
        let system = system((&family, laws), weights)?;
        Ok(Self { family, laws, layout, weights, block: weights.to_vec(), file: system })
    }
}

impl<'f, const N: usize> Tunable<N> for TunedOf<'f, N> {
    type Lagrangian<'s>
        = AnyLagrangian<'s, N>
    where
        Self: 's;
    type Forces<'s>
        = ForcesOf<'s, N>
    where
        Self: 's;

    fn of_file(&self) -> &SystemOf<'_, N> {
        &self.file
    }

    fn in_use(&self) -> SystemOf<'_, N> {
        system((&self.family, self.laws), &self.block)
            .unwrap_or_else(|_| self.file.lagrangian.with_forces(self.file.forces.clone()))
    }

    fn set(&mut self, numbers: &[Number], distances: &[f32]) {
        self.layout.write(self.weights, (numbers, distances), &mut self.block);
    }
}

/// The system of bodies over a block of weights.
fn system<'s, const N: usize>(
    (family, laws): (&Family<'s>, Laws<'s>),
    weights: &'s [f32],
) -> Result<SystemOf<'s, N>, ModelError> {
    match family {
        Family::Bodies(header) => BodiesLoader { header: *header, laws, weights }.load(),
        Family::Arm(header) => ArmLoader { header: *header, laws, weights }.load(),
        other => Err(ModelError::OtherFamily { found: other.name() }),
    }
}
