use super::header::{MAX_COORDINATES, require};
use super::loaded::forces_of_coordinates;
use super::{Laws, LoadForces, Model, ModelError, ParsedAs};
use crate::energy::inertia_network::{
    Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape, feature_count, network_shape,
};
use crate::energy::{MAX_HIDDEN, NetworkShape};
use crate::forces::{System, Viscous};
use crate::network::Activation;
use crate::scalar::{FileWeightFormat, Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// The shape of an inertia network.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InertiaNetworkHeader<'a> {
    /// One letter per coordinate: `t` translation, `a` angle, `c` cyclic.
    pub coordinates: &'a str,
    /// Units of the hidden layers; the first 0 ends the list.
    pub widths: [u16; MAX_HIDDEN],
    /// Activation of the hidden layers.
    pub activation: Activation,
    /// Form of the inertia matrix.
    pub inertia: Inertia,
}

/// An inertia network in N coordinates with at most `L` hidden layers of at most `H` units.
///
/// `W` is the storage format of the file's weights: `f32`, or [`struct@f16`](crate::scalar::f16) in half the flash. `F` are the laws of
/// force that the program is compiled for.
pub type InertiaNetworkModel<
    'a,
    const N: usize,
    const H: usize,
    const L: usize,
    W = f32,
    F = Viscous<f32, N>,
> = Model<'a, System<InertiaNetwork<'a, W, N, H, L>, F>>;

impl Coordinate {
    /// The letter for this kind in a model file and on the command line.
    pub const fn letter(self) -> char {
        match self {
            Self::Translation => 't',
            Self::Angle => 'a',
            Self::Cyclic => 'c',
        }
    }

    /// The kind for a letter.
    pub const fn from_letter(letter: char) -> Option<Self> {
        match letter {
            't' => Some(Self::Translation),
            'a' => Some(Self::Angle),
            'c' => Some(Self::Cyclic),
            _ => None,
        }
    }
}

impl<'a> InertiaNetworkHeader<'a> {
    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Number of groups of coordinates: every coordinate is a group of its own.
    pub(super) fn groups(&self) -> usize {
        self.n()
    }

    /// Number of coordinates that every mechanism of a file has.
    pub(super) fn common_coordinates(&self) -> usize {
        self.n()
    }

    /// Returns the kinds of the coordinates, which must be N.
    pub fn kinds<const N: usize>(&self) -> Result<[Coordinate; N], ModelError> {
        let mut kinds = [Coordinate::Cyclic; N];
        if self.n() != N {
            return Err(ModelError::Shape { what: "coordinates", found: self.n(), compiled: N });
        }
        for (slot, kind) in kinds.iter_mut().zip(self.letters()) {
            *slot = kind.ok_or(ModelError::OutOfRange { what: "coordinate kind" })?;
        }
        Ok(kinds)
    }

    /// Number of inputs of the network: one per translation, two per angle.
    pub fn features(&self) -> usize {
        self.letters().flatten().map(|kind| feature_count(&[kind])).sum()
    }

    /// The kind of every coordinate, `None` for an unknown letter. Reads bytes, since decoding characters would take
    /// more code.
    fn letters(&self) -> impl Iterator<Item = Option<Coordinate>> {
        self.coordinates.as_bytes().iter().map(|letter| Coordinate::from_letter(char::from(*letter)))
    }

    /// The shape of the network.
    pub fn network(&self) -> Result<NetworkShape, ModelError> {
        let shape = network_shape(self.features(), &self.widths, (self.inertia, self.n()), self.activation);
        shape.ok_or(ModelError::OutOfRange { what: "number of coordinates" })
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        require((1..=MAX_COORDINATES).contains(&self.n()), "number of coordinates")?;
        require(self.inertia.has_valid_rows(self.n()), "rows of the inertia matrix")?;
        self.network()?.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, _: &[W]) -> Result<(), ModelError> {
        require(self.letters().all(|kind| kind.is_some()), "coordinate kind")?;
        require(self.network()?.is_valid(), "hidden width")?;
        let epsilon = self.inertia.epsilon();
        require(epsilon.is_finite() && epsilon >= 0.0, "epsilon of the inertia matrix")
    }
}

impl InertiaNetworkHeader<'_> {
    /// The system of this shape and these laws over a weight block in any scalar: f32 as shipped, f64 on the host, lanes in
    /// training.
    ///
    /// # Errors
    /// [`ModelError`] if the block or the compiled sizes do not fit, or the program lacks one of the laws.
    pub fn system<'w, W, S, F, const N: usize, const H: usize, const L: usize>(
        &self,
        laws: Laws,
        weights: &'w [W],
    ) -> Result<System<InertiaNetwork<'w, W, N, H, L>, F>, ModelError>
    where
        W: WeightFormat,
        S: Scalar<Weight = W::Wide>,
        F: LoadForces<'w, W, S, N>,
    {
        let shape = InertiaNetworkShape {
            coordinates: self.kinds()?,
            network: self.network()?,
            inertia: self.inertia,
        };
        shape.check_size::<H, L>()?;
        let mut block = weights;
        let needed = self.parameters()?;
        let lagrangian = InertiaNetwork::take(&mut block, &shape)
            .ok_or(ModelError::WeightCount { found: weights.len(), needed })?;
        Ok(System { lagrangian, forces: forces_of_coordinates(laws, block)? })
    }
}

impl<'a, const N: usize, const H: usize, const L: usize, W: FileWeightFormat, F: LoadForces<'a, W, f32, N>>
    InertiaNetworkModel<'a, N, H, L, W, F>
{
    /// Reads, validates and borrows a model file; `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`].
    pub fn load(bytes: &'a [u8]) -> Result<Self, ModelError> {
        Self::read(bytes, F::knows, |parsed: &ParsedAs<InertiaNetworkHeader, W>| {
            Ok((parsed.shape.system(parsed.laws, parsed.weights)?, true))
        })
    }
}
