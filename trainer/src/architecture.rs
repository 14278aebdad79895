//! The shape of a model on the host, where widths and the number of coordinates are known only at run time, and the one
//! place where they become types.

use leastaction_core::energy::rigid::{Coordinate, Inertia, Rigid};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::{MAX_HIDDEN, ModelError, RigidHeader};
use leastaction_core::network::{Activation, Dense};
use leastaction_core::scalar::Scalar;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Hidden layers at most on the host.
pub const DEPTH: usize = 3;
/// Coordinates at most on the host.
pub const MAX_COORDINATES: usize = 4;
/// Units of a hidden layer at most on the host.
pub const MAX_WIDTH: usize = 256;

/// A system over host weights: its type has the compiled sizes.
pub type HostSystem<'w, S, const N: usize, const H: usize> =
    System<Rigid<'w, <S as Scalar>::Weight, N, H, DEPTH>, Viscous<S, N>>;

/// The shape of a rigid model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Architecture {
    /// One letter a coordinate: `t` translation, `a` angle, `c` cyclic.
    pub coordinates: String,
    /// Units of the hidden layers.
    pub widths: Vec<u16>,
    /// Of the hidden layers.
    pub activation: Activation,
    /// Of the inertia matrix.
    pub inertia: Inertia,
    /// Whether viscous damping is learned.
    pub damped: bool,
}

impl Architecture {
    /// The default network for coordinates of these kinds: two tanh layers, H = softplus for one coordinate and
    /// LLᵀ + 1e-9 I for more, as SyMo.
    pub fn new(coordinates: &[Coordinate], width: u16) -> Self {
        let inertia =
            if coordinates.len() == 1 { Inertia::Diagonal } else { Inertia::Cholesky { epsilon: 1e-9 } };
        Self {
            coordinates: coordinates.iter().map(|c| c.letter()).collect(),
            widths: vec![width, width],
            activation: Activation::Tanh,
            inertia,
            damped: false,
        }
    }

    /// The shape in the words of the model file.
    pub fn header(&self) -> RigidHeader<'_> {
        let mut widths = [0; MAX_HIDDEN];
        for (slot, width) in widths.iter_mut().zip(&self.widths) {
            *slot = *width;
        }
        RigidHeader {
            coordinates: &self.coordinates,
            widths,
            activation: self.activation,
            inertia: self.inertia,
            damped: self.damped,
        }
    }

    /// The shape that a model file has.
    pub fn from_header(header: &RigidHeader) -> Self {
        let (_, depth) = header.widths();
        Self {
            coordinates: header.coordinates.to_owned(),
            widths: header.widths.iter().copied().take(depth).collect(),
            activation: header.activation,
            inertia: header.inertia,
            damped: header.damped,
        }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// Numbers in the weight block, damping included.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.header().parameters()
    }

    /// Inputs and outputs of every layer, first to last.
    pub fn layers(&self) -> Vec<(usize, usize)> {
        let header = self.header();
        let mut sizes = vec![header.features()];
        sizes.extend(self.widths.iter().map(|w| usize::from(*w)));
        sizes.push(self.inertia.outputs(self.n()));
        sizes.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    /// Random weights: uniform with Glorot's variance, biases and damping zero.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut stream = Pcg64::seed_from_u64(seed);
        let mut weights = Vec::new();
        for (inputs, outputs) in self.layers() {
            let limit = (6.0 / (inputs + outputs) as f64).sqrt();
            let mut layer = vec![0.0; inputs * outputs];
            for i in 0..outputs {
                for j in 0..inputs {
                    layer[Dense::<f64>::position(inputs, outputs, i, j)] = stream.random_range(-limit..limit);
                }
            }
            weights.extend(layer);
            weights.extend(std::iter::repeat_n(0.0, outputs));
        }
        weights.extend(std::iter::repeat_n(0.0, if self.damped { self.n() } else { 0 }));
        weights
    }

    /// The damping coefficients in a weight block; empty where none are learned.
    pub fn damping<'w>(&self, weights: &'w mut [f64]) -> &'w mut [f64] {
        let n = if self.damped { self.n() } else { 0 };
        let start = weights.len().saturating_sub(n);
        &mut weights[start..]
    }

    /// The system of this shape over a weight block.
    ///
    /// # Errors
    /// Where the block or the compiled sizes do not fit.
    pub fn system<'w, S: Scalar, const N: usize, const H: usize>(
        &self,
        weights: &'w [S::Weight],
    ) -> Result<HostSystem<'w, S, N, H>, ModelError> {
        self.header().system(weights)
    }

    /// Calls the visitor with this shape's number of coordinates and the least compiled width that holds it.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for more coordinates, layers or units than this program was compiled for.
    pub fn dispatch<V: Visitor>(&self, visitor: V) -> Result<V::Output, ModelError> {
        let width = self.widths.iter().copied().max().map_or(0, usize::from);
        let too_many = |what, found, compiled| Err(ModelError::Shape { what, found, compiled });
        if self.widths.len() > DEPTH {
            return too_many("hidden layers", self.widths.len(), DEPTH);
        }
        match (self.n(), width) {
            (1, 0..=32) => Ok(visitor.visit::<1, 32>()),
            (2, 0..=32) => Ok(visitor.visit::<2, 32>()),
            (3, 0..=32) => Ok(visitor.visit::<3, 32>()),
            (4, 0..=32) => Ok(visitor.visit::<4, 32>()),
            (1, 33..=MAX_WIDTH) => Ok(visitor.visit::<1, MAX_WIDTH>()),
            (2, 33..=MAX_WIDTH) => Ok(visitor.visit::<2, MAX_WIDTH>()),
            (3, 33..=MAX_WIDTH) => Ok(visitor.visit::<3, MAX_WIDTH>()),
            (4, 33..=MAX_WIDTH) => Ok(visitor.visit::<4, MAX_WIDTH>()),
            (n, 0..=MAX_WIDTH) => too_many("coordinates", n, MAX_COORDINATES),
            (_, width) => too_many("units in a hidden layer", width, MAX_WIDTH),
        }
    }
}

/// Something to do once the sizes are types.
pub trait Visitor {
    /// What it gives.
    type Output;
    /// Does it for N coordinates and hidden layers of at most H units.
    fn visit<const N: usize, const H: usize>(self) -> Self::Output;
}
