use super::{ModelError, ModularHeader, TrainedStep, TreeHeader, parse_as};
use crate::energy::modular::Modular;
use crate::forces::{System, Viscous};
use crate::scalar::{Scalar, Shipped, Stored, f16};

/// A loaded tree in N coordinates of at most `E` element types, networks with at most `L` hidden layers of at most `H` units,
/// ready for the solvers.
///
/// `W` is how the file stores its weights: `f32`, or [`struct@f16`] in half the flash.
#[derive(Clone, Copy, Debug)]
pub struct ModularModel<'a, const N: usize, const E: usize, const H: usize, const L: usize, W = f32> {
    /// Energies over the file's weights, and damping.
    pub system: System<Modular<'a, W, N, E, H, L>, Viscous<f32, N>>,
    /// The step and order the model was trained for.
    pub trained_step: Option<TrainedStep>,
}

impl<'a, const N: usize, const E: usize, const H: usize, const L: usize> ModularModel<'a, N, E, H, L> {
    /// Reads, validates and borrows a model file, and takes the tree called `name`; `bytes` must be 4-aligned.
    pub fn load(bytes: &'a [u8], name: &str) -> Result<Self, ModelError> {
        Self::read(bytes, name)
    }
}

impl<'a, const N: usize, const E: usize, const H: usize, const L: usize> ModularModel<'a, N, E, H, L, f16> {
    /// [`ModularModel::load`] of a file with weights in half precision.
    pub fn load_half(bytes: &'a [u8], name: &str) -> Result<Self, ModelError> {
        Self::read(bytes, name)
    }
}

impl<'a, const N: usize, const E: usize, const H: usize, const L: usize, W: Shipped>
    ModularModel<'a, N, E, H, L, W>
{
    fn read(bytes: &'a [u8], name: &str) -> Result<Self, ModelError> {
        let parsed = parse_as::<ModularHeader, W>(bytes)?;
        let header = parsed.shape;
        let system = header.system(header.tree(name)?, parsed.weights)?;
        Ok(Self { system, trained_step: parsed.trained_step })
    }
}

impl ModularHeader<'_> {
    /// The system of a tree over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in training.
    #[allow(clippy::type_complexity, reason = "a Lagrangian and its forces, spelled out once")]
    pub fn system<'w, W, S, const N: usize, const E: usize, const H: usize, const L: usize>(
        &self,
        tree: &TreeHeader,
        weights: &'w [W],
    ) -> Result<System<Modular<'w, W, N, E, H, L>, Viscous<S, N>>, ModelError>
    where
        W: Stored,
        S: Scalar<Weight = W::Wide>,
    {
        self.shape.check_size::<E, H, L>()?;
        let tree = self.shape.tree(tree.nodes()).map_err(ModelError::Tree)?;
        let mut block = weights;
        let short = ModelError::WeightCount { found: weights.len(), needed: self.parameters()? };
        let lagrangian = Modular::take(&mut block, &self.shape, tree).ok_or(short)?;
        Ok(System { forces: Viscous { coefficients: lagrangian.damping() }, lagrangian })
    }
}
