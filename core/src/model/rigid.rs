use super::{ModelError, RigidHeader, TrainedStep, parse_as};
use crate::energy::rigid::{Rigid, RigidShape};
use crate::forces::{System, Viscous};
use crate::scalar::{Scalar, Shipped, Stored, f16};

/// A loaded rigid model in N coordinates, with at most `L` hidden layers of at most `H` units, ready for the solvers.
///
/// `W` is how the file stores its weights: `f32`, or [`struct@f16`] in half the flash.
#[derive(Clone, Copy, Debug)]
pub struct RigidModel<'a, const N: usize, const H: usize, const L: usize, W = f32> {
    /// Energies over the file's weights, and damping.
    pub system: System<Rigid<'a, W, N, H, L>, Viscous<f32, N>>,
    /// The step and order the model was trained for.
    pub trained_step: Option<TrainedStep>,
}

impl<'a, const N: usize, const H: usize, const L: usize> RigidModel<'a, N, H, L> {
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes)
    }
}

impl<'a, const N: usize, const H: usize, const L: usize> RigidModel<'a, N, H, L, f16> {
    /// [`RigidModel::load`] of a file with weights in half precision.
    pub fn load_half(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes)
    }
}

impl<'a, const N: usize, const H: usize, const L: usize, W: Shipped> RigidModel<'a, N, H, L, W> {
    fn read(bytes: &'a [u8]) -> Result<Self, ModelError> {
        let parsed = parse_as::<RigidHeader, W>(bytes)?;
        let header = parsed.shape;
        let system = header.system(parsed.weights)?;
        Ok(Self { system, trained_step: parsed.trained_step })
    }
}

impl RigidHeader<'_> {
    /// The system of this shape over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in training.
    #[allow(clippy::type_complexity, reason = "a Lagrangian and its forces, spelled out once")]
    pub fn system<'w, W, S, const N: usize, const H: usize, const L: usize>(
        &self,
        weights: &'w [W],
    ) -> Result<System<Rigid<'w, W, N, H, L>, Viscous<S, N>>, ModelError>
    where
        W: Stored,
        S: Scalar<Weight = W::Wide>,
    {
        let shape =
            RigidShape { coordinates: self.kinds()?, network: self.network()?, inertia: self.inertia };
        shape.check_size::<H, L>()?;
        let mut block = weights;
        let needed = self.parameters()?;
        let short = ModelError::WeightCount { found: weights.len(), needed };
        let lagrangian = Rigid::take(&mut block, &shape).ok_or(short)?;
        let mut forces = Viscous::none();
        if self.damped {
            let damping = block.split_first_chunk::<N>().ok_or(short)?.0;
            forces.coefficients = damping.map(W::scalar);
        }
        Ok(System { lagrangian, forces })
    }
}
