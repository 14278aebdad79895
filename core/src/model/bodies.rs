use super::header::{MAX_TREE_COORDINATES, require};
use super::loaded::forces_of_coordinates;
use super::{Laws, LoadForces, Model, ModelError, ParsedAs};
use crate::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, BodyTree, GRAVITY_PARAMETERS, Joint, PlanarBodies, TreeBody, TreeError,
};
use crate::expected::expected;
use crate::forces::{System, Viscous};
use crate::scalar::{FileWeightFormat, Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Dimensions of the space of this format's bodies.
const DIMENSIONS: u8 = 2;

/// The shape of a tree of rigid bodies on joints.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BodiesHeader<'a> {
    /// Dimensions of space: 2.
    pub dimensions: u8,
    /// Two bytes per body ([`TreeBody::to_bytes`]).
    pub bodies: &'a [u8],
}

impl TreeBody {
    /// Bytes of a body in a model file.
    pub const BYTES: usize = 2;

    /// Converts the body to its bytes in a model file: the joint (0 revolute, 1 prismatic), then 0 if the body sits
    /// on the ground or 1 + the index of its parent. `None` if the parent is body 255, which no byte can hold.
    pub fn to_bytes(self) -> Option<[u8; Self::BYTES]> {
        let parent = match self.parent {
            None => 0,
            Some(parent) => parent.checked_add(1)?,
        };
        Some([self.joint as u8, parent])
    }

    /// Reads a body of a model file; `None` for a joint that does not exist.
    pub fn from_bytes([joint, parent]: [u8; Self::BYTES]) -> Option<Self> {
        let joint = match joint {
            0 => Joint::Revolute,
            1 => Joint::Prismatic,
            _ => return None,
        };
        Some(Self { joint, parent: parent.checked_sub(1) })
    }
}

impl<'a> BodiesHeader<'a> {
    /// Wraps a tree in the plane, with two bytes per body.
    pub const fn planar(bodies: &'a [u8]) -> Self {
        Self { dimensions: DIMENSIONS, bodies }
    }

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
        let (bodies, _) = self.bodies.as_chunks();
        bodies.iter().map(|bytes| TreeBody::from_bytes(*bytes))
    }

    /// Returns the tree, which must have N bodies.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a joint that does not exist, [`ModelError::Tree`] if the bodies are no tree of N bodies.
    pub fn tree<const N: usize>(&self) -> Result<BodyTree<N>, ModelError> {
        require(self.bodies().all(|body| body.is_some()), "joint of a body")?;
        BodyTree::new(self.bodies().flatten()).map_err(ModelError::Tree)
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        require(self.dimensions == DIMENSIONS, "dimensions of the space of bodies")?;
        require(self.bodies.len().is_multiple_of(TreeBody::BYTES), "length of a tree")?;
        require(self.n() <= MAX_TREE_COORDINATES, "number of coordinates of a tree")?;
        Ok(GRAVITY_PARAMETERS + BODY_PARAMETERS * self.n())
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError> {
        match self.tree::<0>() {
            // Any number of bodies is valid here.
            Ok(_) | Err(ModelError::Tree(TreeError::Coordinates { .. })) => {}
            Err(error) => return Err(error),
        }
        let (numbers, _) = expected(weights.get(GRAVITY_PARAMETERS..), &[]).as_chunks();
        numbers.iter().try_for_each(|numbers| check(&BodyParameters::from_array(numbers.map(W::wide))))
    }
}

/// A tree of N rigid bodies on joints in the plane.
///
/// `W` and `F` are as in [`InertiaNetworkModel`](super::InertiaNetworkModel).
pub type BodiesModel<'a, const N: usize, W = f32, F = Viscous<f32, N>> =
    Model<'a, System<PlanarBodies<'a, W, N>, F>>;

impl BodiesHeader<'_> {
    /// The system of this tree and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] if the block or the compiled number of bodies does not fit, or the program lacks one of the laws.
    pub fn system<'w, W, S, F, const N: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<PlanarBodies<'w, W, N>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let (tree, needed, mut block) = (self.tree()?, self.parameters()?, weights);
        let lagrangian = PlanarBodies::take(&mut block, tree)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

impl<'a, const N: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>> BodiesModel<'a, N, W, F> {
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<BodiesHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}

/// Checks the numbers of a body, which are already known to be finite.
fn check(body: &BodyParameters<f32>) -> Result<(), ModelError> {
    require(body.mass > 0.0, "mass of a body")?;
    require(body.inertia > 0.0, "moment of inertia of a body")?;
    require(body.rotor >= 0.0, "inertia of a rotor")
}
