use super::loaded::forces_of_coordinates;
use super::{Layout, LoadForces, ModelError, ParsedAs, ShapeHeader};
use crate::adapt::{Number, Tunable};
use crate::energy::arm::{Bodies, BodyTree};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;

/// A model of bodies whose numbers may be changed while it runs: its file, which stays what it is, and a block of at most K numbers in memory.
///
/// `D`, `B` and `N` are those of [`Bodies`], `F` the laws of force that the program is compiled for; laws by networks cannot be changed, as
/// they read their numbers where they lie.
#[derive(Clone, Debug)]
pub struct Tuned<'f, F, const D: usize, const B: usize, const N: usize, const K: usize> {
    file: System<Bodies<'f, f32, D, B, N>, F>,
    weights: &'f [f32],
    layout: Layout<'f>,
    block: [f32; K],
    forces: F,
}

impl<'f, F, const D: usize, const B: usize, const N: usize, const K: usize> Tuned<'f, F, D, B, N, K>
where
    F: Forces<f32, N> + Clone + for<'w> LoadForces<'w, f32, f32, N>,
{
    /// Creates the model of a file, with the numbers of the file; `tree` is that of its shape.
    ///
    /// # Errors
    /// [`ModelError::WeightCount`] for a block of more than K numbers, [`ModelError::Law`] for a law that the program does not have.
    pub fn new<H: ShapeHeader<'f>>(
        parsed: &ParsedAs<'f, H, f32>,
        tree: BodyTree<N>,
    ) -> Result<Self, ModelError> {
        let (weights, laws) = (parsed.weights, parsed.laws);
        let wrong = ModelError::WeightCount { found: weights.len(), needed: K };
        let mut block = [0.0; K];
        block.get_mut(..weights.len()).ok_or(wrong)?.copy_from_slice(weights);
        let mut rest = weights;
        let lagrangian = Bodies::take(&mut rest, tree).ok_or(wrong)?;
        let forces: F = forces_of_coordinates(laws, rest)?;
        let (file, layout) =
            (System { lagrangian, forces: forces.clone() }, Layout::new(&parsed.shape, laws)?);
        Ok(Self { file, weights, layout, block, forces })
    }

    /// Value of a number in the file; `None` if the file does not have it.
    pub fn value(&self, number: Number) -> Option<f32> {
        self.layout.value(self.weights, number)
    }
}

impl<F, const D: usize, const B: usize, const N: usize, const K: usize> Tunable<N>
    for Tuned<'_, F, D, B, N, K>
where
    F: Forces<f32, N> + Clone + for<'w> LoadForces<'w, f32, f32, N>,
    for<'s> Bodies<'s, f32, D, B, N>: Lagrangian<f32, N>,
{
    type Lagrangian<'s>
        = Bodies<'s, f32, D, B, N>
    where
        Self: 's;
    type Forces<'s>
        = F
    where
        Self: 's;

    fn of_file(&self) -> &System<Bodies<'_, f32, D, B, N>, F> {
        &self.file
    }

    fn in_use(&self) -> System<Bodies<'_, f32, D, B, N>, F> {
        let mut block = self.block.as_slice();
        let lagrangian = Bodies::take(&mut block, self.file.lagrangian.tree);
        System { lagrangian: lagrangian.unwrap_or(self.file.lagrangian), forces: self.forces.clone() }
    }

    fn set(&mut self, numbers: &[Number], distances: &[f32]) {
        self.layout.write_knowing(self.weights, (numbers, distances), &mut self.block, F::knows);
        let laws = self.block.get(self.layout.energies..self.weights.len()).unwrap_or_default();
        if let Ok(forces) = forces_of_coordinates(self.layout.laws, laws) {
            self.forces = forces;
        }
    }
}
