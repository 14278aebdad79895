use super::header::{MAX_TREE_COORDINATES, require};
use super::loaded::forces_of_coordinates;
use super::{BodiesHeader, Laws, LoadForces, Model, ModelError, ParsedAs};
use crate::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies, ArmParameters, BodyTree, TreeBody,
};
use crate::energy::modular::TreeError;
use crate::expected::expected;
use crate::forces::{System, Viscous};
use crate::scalar::{FileWeightFormat, Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// The shape of a tree of rigid bodies on joints in space.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmHeader<'a> {
    /// Two bytes per body ([`TreeBody::to_bytes`]).
    pub bodies: &'a [u8],
}

/// Tolerance of the orthonormality check, by bits of a weight: the error that rounding to single or half precision
/// may leave in the dot products of a rotation's rows and of a joint's axis.
const ROUNDING: [(u8, f32); 2] = [(32, 1e-5), (16, 4e-3)];

impl<'a> ArmHeader<'a> {
    /// Number of coordinates n, one per body.
    pub fn n(&self) -> usize {
        self.bodies.len() / TreeBody::BYTES
    }

    /// Number of groups of coordinates: every coordinate is a group of its own.
    pub(super) fn groups(&self) -> usize {
        self.n()
    }

    /// Number of coordinates that every mechanism of a file has.
    pub(super) fn common_coordinates(&self) -> usize {
        self.n()
    }

    /// The bodies in order; `None` for a body whose joint does not exist.
    pub fn bodies(&self) -> impl Iterator<Item = Option<TreeBody>> + use<'a> {
        BodiesHeader::planar(self.bodies).bodies()
    }

    /// Returns the tree, which must have N bodies.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a joint that does not exist, [`ModelError::Tree`] if the bodies are no tree of N bodies.
    pub fn tree<const N: usize>(&self) -> Result<BodyTree<N>, ModelError> {
        BodiesHeader::planar(self.bodies).tree()
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        require(self.bodies.len().is_multiple_of(TreeBody::BYTES), "length of a tree")?;
        require(self.n() <= MAX_TREE_COORDINATES, "number of coordinates of a tree")?;
        Ok(ARM_GRAVITY_PARAMETERS + ARM_PARAMETERS * self.n())
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError> {
        match self.tree::<0>() {
            // Any number of bodies is valid here.
            Ok(_) | Err(ModelError::Tree(TreeError::Coordinates { .. })) => {}
            Err(error) => return Err(error),
        }
        let (numbers, _) = expected(weights.get(ARM_GRAVITY_PARAMETERS..), &[]).as_chunks();
        let rounding = ROUNDING.iter().find(|(bits, _)| *bits == W::BITS).map_or(0.0, |(_, most)| *most);
        numbers.iter().try_for_each(|n| check(&ArmParameters::from_array(n.map(W::wide)), rounding))
    }
}

/// A tree of N rigid bodies on joints in space.
///
/// `W` and `F` are as in [`InertiaNetworkModel`](super::InertiaNetworkModel).
pub type ArmModel<'a, const N: usize, W = f32, F = Viscous<f32, N>> =
    Model<'a, System<ArmBodies<'a, W, N>, F>>;

impl ArmHeader<'_> {
    /// The system of this tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] if the block or the compiled number of bodies does not fit, or the program lacks one of the laws.
    pub fn system<'w, W, S, F, const N: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<ArmBodies<'w, W, N>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let (tree, needed, mut block) = (self.tree()?, self.parameters()?, weights);
        let lagrangian = ArmBodies::take(&mut block, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

impl<'a, const N: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>> ArmModel<'a, N, W, F> {
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<ArmHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}

/// Checks the numbers of a body, which are already known to be finite.
fn check(body: &ArmParameters<f32>, rounding: f32) -> Result<(), ModelError> {
    let near = |a: f32, b: f32| (a - b).max(b - a) <= rounding;
    let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z] = &body.rotation;
    let unit = |a: &[f32; 3]| near(dot(a, a), 1.0);
    let orthonormal =
        [x, y, z].into_iter().all(unit) && [(x, y), (y, z), (z, x)].iter().all(|(a, b)| near(dot(a, b), 0.0));
    let volume = x[0] * (y[1] * z[2] - y[2] * z[1])
        + x[1] * (y[2] * z[0] - y[0] * z[2])
        + x[2] * (y[0] * z[1] - y[1] * z[0]);
    require(orthonormal && volume > 0.0, "rotation of a joint's frame")?;
    require(unit(&body.axis), "axis of a joint")?;
    let [xx, _, yy, _, _, zz] = body.inertia.matrix;
    require(body.inertia.mass >= 0.0, "mass of a body")?;
    require(xx >= 0.0 && yy >= 0.0 && zz >= 0.0, "moment of inertia of a body")?;
    require(body.rotor >= 0.0, "inertia of a rotor")
}
