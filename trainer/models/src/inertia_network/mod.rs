//! Learned inertia matrices: H(q) and V(q) from a single network (SyMo, L-NODE, DeLaN).

pub mod config;
pub mod coordinates;
pub mod describe;

use crate::family::Family;
use crate::layers::random_layers;
use crate::limits::DEPTH;
use crate::source::{ConstantType, LoadedType};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::{InertiaNetworkHeader, Law, Laws, MAX_HIDDEN, ModelError};
use leastaction_core::network::{Activation, Dense};
use leastaction_core::scalar::Scalar;
use leastaction_programs::energies::{Energies, InertiaNetworkEnergies};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// An inertia network over weights on the host; the type has the compiled sizes.
pub type HostSystem<'w, S, const N: usize, const H: usize> =
    System<InertiaNetwork<'w, <S as Scalar>::Weight, N, H, DEPTH>, Viscous<S, N>>;

/// Shape of an inertia network.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InertiaNetworkArchitecture {
    /// Kinds of the coordinates, one letter each: `t` translation, `a` angle, `c` cyclic.
    pub coordinates: String,
    /// Numbers of units in the hidden layers.
    pub widths: Vec<u16>,
    /// Activation of the hidden layers.
    pub activation: Activation,
    /// Form of the inertia matrix.
    pub inertia: Inertia,
    /// Whether viscous damping is learned.
    pub damped: bool,
}

/// Number of rows of the largest factor B that a model file can hold for an inertia matrix of n coordinates: 2n − 1,
/// but B has at most 254 entries, since V also takes an output. `None` if there would be fewer than n rows.
pub fn largest_factor(n: usize) -> Option<u8> {
    let rows = (2 * n).saturating_sub(1).min(254 / n.max(1));
    u8::try_from(rows).ok().filter(|_| rows >= n && n > 0)
}

impl InertiaNetworkArchitecture {
    /// Returns the default network for coordinates of these kinds: two tanh layers; H = softplus for one coordinate and LLᵀ + 1e-9 I for
    /// two, like SyMo; BᵀB + 1e-9 I for more, as long as a file can hold it.
    pub fn new(coordinates: &[Coordinate], width: u16) -> Self {
        let epsilon = 1e-9;
        let inertia = match (coordinates.len(), largest_factor(coordinates.len())) {
            (1, _) => Inertia::Diagonal,
            (3.., Some(rows)) => Inertia::Factor { rows, epsilon },
            _ => Inertia::Cholesky { epsilon },
        };
        Self {
            coordinates: coordinates.iter().map(|c| c.letter()).collect(),
            widths: vec![width, width],
            activation: Activation::Tanh,
            inertia,
            damped: false,
        }
    }

    /// Calls `read` with the shape as the model file states it.
    pub(crate) fn with_header<T>(&self, read: impl FnOnce(InertiaNetworkHeader) -> T) -> T {
        read(self.header())
    }

    /// Shape as the model file states it.
    pub fn header(&self) -> InertiaNetworkHeader<'_> {
        let mut widths = [0; MAX_HIDDEN];
        for (slot, width) in widths.iter_mut().zip(&self.widths) {
            *slot = *width;
        }
        InertiaNetworkHeader {
            coordinates: &self.coordinates,
            widths,
            activation: self.activation,
            inertia: self.inertia,
        }
    }

    /// Returns the shape described by a model file.
    pub(crate) fn from_header(header: &InertiaNetworkHeader, laws: Laws, _: &[f64]) -> Self {
        Self {
            coordinates: header.coordinates.to_owned(),
            widths: header.widths.into_iter().take_while(|width| *width != 0).collect(),
            activation: header.activation,
            inertia: header.inertia,
            damped: laws.contains(Law::Viscous),
        }
    }

    /// Length of the weight block in numbers, damping included.
    ///
    /// # Errors
    /// An error if the shape is outside the range of the format.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        let damping = if self.damped { self.n() } else { 0 };
        Ok(self.header().parameters()? + damping)
    }

    /// Numbers of inputs and outputs of every layer, first to last.
    pub fn layers(&self) -> Vec<(usize, usize)> {
        let header = self.header();
        let mut sizes = vec![header.features()];
        sizes.extend(self.widths.iter().map(|w| usize::from(*w)));
        sizes.push(self.inertia.outputs(self.n()));
        sizes.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    /// Changes the initial weights of the network so that H is well-conditioned.
    fn condition(&self, weights: &mut [f64]) {
        let (n, layers) = (self.n(), self.layers());
        let Some((inputs, outputs)) = layers.last().copied() else { return };
        let shrunk = match self.inertia {
            Inertia::Diagonal => return,
            Inertia::Cholesky { .. } => n..outputs - 1,
            Inertia::Factor { .. } => 0..outputs - 1,
        };
        let start = weights.len().saturating_sub((inputs + 1) * outputs);
        let Some(last) = weights.get_mut(start..) else { return };
        for (i, j) in shrunk.flat_map(|i| (0..inputs).map(move |j| (i, j))) {
            last[Dense::<f64>::position(inputs, outputs, i, j)] /= n.saturating_sub(1).max(1) as f64;
        }
        if let Inertia::Factor { .. } = self.inertia {
            (0..n).for_each(|i| last[inputs * outputs + i * n + i] = 1.0);
        }
    }

    /// Range of the damping in the weight block, if there is any.
    pub fn damping(&self) -> Option<Range<usize>> {
        let start = self.header().parameters().ok().filter(|_| self.damped)?;
        Some(start..start + self.n())
    }

    /// Returns the system of this shape over a weight block.
    ///
    /// # Errors
    /// An error if the block or the compiled sizes do not fit.
    pub fn system<'w, S: Scalar, const N: usize, const H: usize>(
        &self,
        weights: &'w [S::Weight],
    ) -> Result<HostSystem<'w, S, N, H>, ModelError> {
        self.header().system(self.laws(), weights)
    }
}

impl Family for InertiaNetworkArchitecture {
    fn n(&self) -> usize {
        self.coordinates.len()
    }

    fn laws(&self) -> Laws<'static> {
        if self.damped { Laws::VISCOUS } else { Laws::NONE }
    }

    /// # Errors
    /// [`ModelError::OutOfRange`] if a coordinate has no valid kind or the network has a width of 0.
    fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        self.header().parameters()?;
        let kinds = self.coordinates.chars().map(Coordinate::from_letter).collect::<Option<Vec<_>>>();
        let kinds = kinds.ok_or(ModelError::OutOfRange { what: "coordinates" })?;
        let widths: Vec<usize> = self.widths.iter().map(|width| usize::from(*width)).collect();
        Ok(Box::new(InertiaNetworkEnergies::new(
            kinds,
            (&widths, self.activation),
            self.inertia,
            self.damped,
        )))
    }

    /// Returns random weights: uniform with Glorot's variance; biases and damping are zero. H is made well-conditioned
    /// for any number of coordinates, since with a nearly singular H the mechanism would move by radians in a step. The
    /// weights that give L below its diagonal are divided by n − 1, because the condition number of a random triangular
    /// matrix grows exponentially with n (Viswanath and Trefethen, SIAM J. Matrix Anal. Appl. 19, 1998). The weights
    /// that give B are divided likewise, and their bias is the unit matrix above zeros.
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = random_layers(self.layers(), seed);
        self.condition(&mut weights);
        weights.extend(std::iter::repeat_n(0.0, if self.damped { self.n() } else { 0 }));
        weights
    }

    fn project(&self, weights: &mut [f64]) {
        let damping = self.damping().and_then(|own| weights.get_mut(own)).unwrap_or_default();
        damping.iter_mut().for_each(|damping| *damping = damping.max(0.0));
    }

    fn coordinates(&self) -> String {
        self.coordinates.clone()
    }

    fn mismatch(&self, data: usize) -> String {
        let model = self.n();
        format!(
            "[model] coordinates names {model} coordinates, but the data has {data}; name every coordinate of q, in order"
        )
    }

    fn networks(&self) -> Vec<Vec<usize>> {
        vec![self.widths.iter().map(|width| usize::from(*width)).collect()]
    }

    fn loaded_type(&self) -> LoadedType {
        LoadedType::new("InertiaNetworkModel", "N, H, L")
    }

    fn constant_type(&self) -> Result<ConstantType, &'static str> {
        let InertiaNetworkHeader { coordinates, widths, activation, inertia } = self.header();
        let hidden: Vec<usize> =
            widths.iter().take_while(|width| **width > 0).map(|width| usize::from(*width)).collect();
        Ok(ConstantType {
            energies: "InertiaNetwork",
            module: "inertia_network::{Inertia, InertiaNetwork}",
            header: "InertiaNetworkHeader",
            shape: format!(
                "InertiaNetworkHeader {{ coordinates: {coordinates:?}, widths: {widths:?}, activation: Activation::{activation:?}, \
                 inertia: Inertia::{inertia:?} }}"
            ),
            network: Some([hidden.iter().copied().max().unwrap_or(0), hidden.len()]),
        })
    }
}
