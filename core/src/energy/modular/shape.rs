//! Shape of a modular model, without its numbers and its trees.

use super::Modular;
use super::element::{ELEMENT_PARAMETERS, ElementParameters, ElementType, Input, Transform};
use super::potential::{Pair, PairInput};
use super::tree::{SPACE, Tree, TreeElement, TreeError};
use crate::energy::network_shape::first_invalid;
use crate::energy::{List, NetworkShape, SizeError};
use crate::network::Mlp;
use crate::scalar::WeightFormat;
use serde::{Deserialize, Serialize};

/// Maximum number of networks of a model.
pub const MAX_NETWORKS: usize = 8;
/// Maximum number of element types of a model.
pub const MAX_TYPES: usize = 6;

/// Displacement of an element type; networks are given by number, from 0. See [`Transform`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TransformShape {
    /// A learned position.
    Network {
        /// T.
        position: u8,
        /// T_v; without it, ẋ is the exact derivative of T.
        velocity: Option<u8>,
        /// Form in which q enters.
        input: Input,
    },
    /// A rod rotating about a pivot.
    Rod,
    /// A slide along the horizontal.
    Slide,
    /// A free point.
    Free,
}

/// The shape of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TypeShape {
    /// Displacement of the element.
    pub transform: TransformShape,
    /// Network of U₁, if the element has a potential.
    pub potential: Option<u8>,
}

impl TypeShape {
    /// Number of coordinates of an element.
    pub const fn coordinates(&self) -> usize {
        match self.transform {
            TransformShape::Free => 2,
            TransformShape::Network { .. } | TransformShape::Rod | TransformShape::Slide => 1,
        }
    }
}

/// The pair potential.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PairShape {
    /// Network of U₂.
    pub network: u8,
    /// Input of the network.
    pub input: PairInput,
}

/// The shape of a modular model. Its weight block has the networks in order, then the [`ElementParameters`] of each type, then c₁ and c₂.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModularShape {
    /// The networks. Types may share a network.
    pub networks: List<NetworkShape, MAX_NETWORKS>,
    /// The element types.
    pub types: List<TypeShape, MAX_TYPES>,
    /// The pair potential.
    pub pair: Option<PairShape>,
}

impl ModularShape {
    /// Creates a shape; `None` if a list is too long.
    pub fn new(networks: &[NetworkShape], types: &[TypeShape], pair: Option<PairShape>) -> Option<Self> {
        Some(Self { networks: List::new(networks)?, types: List::new(types)?, pair })
    }

    /// Length of the weight block, in numbers; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        self.networks.parameters()?.checked_add(ELEMENT_PARAMETERS * self.types.len() + 2)
    }

    /// Checks a tree against the types.
    ///
    /// # Errors
    /// See [`TreeError`].
    pub fn tree<const N: usize>(
        &self,
        nodes: impl IntoIterator<Item = TreeElement>,
    ) -> Result<Tree<N>, TreeError> {
        let coordinates = |kind: usize| self.types.get(kind).map(TypeShape::coordinates);
        Tree::new(nodes, self.types.len(), coordinates)
    }

    /// Name of the first invalid part; `None` if the shape is valid.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let serves = |network, inputs, outputs| self.networks.serves(network, inputs, outputs);
        let moves = |kind: &TypeShape| match kind.transform {
            TransformShape::Network { position, velocity, input } => {
                let serves = |network| serves(network, input.features(), SPACE);
                serves(position) && velocity.is_none_or(serves)
            }
            TransformShape::Rod | TransformShape::Slide | TransformShape::Free => true,
        };
        let has_potential = |kind: &TypeShape| kind.potential.is_none_or(|n| serves(n, SPACE, 1));
        let has_pair = self.pair.is_none_or(|pair| serves(pair.network, pair.input.features(), 1));
        let invalid = [
            (self.types.is_empty(), "number of element types"),
            (self.types.has_gap(), "list of element types"),
            (!self.types.iter().all(moves), "network of a transform"),
            (!self.types.iter().all(has_potential), "network of a potential"),
            (!has_pair, "network of the pair potential"),
        ];
        self.networks.invalid_part().or_else(|| first_invalid(&invalid))
    }

    /// Checks that there are at most `E` element types, and that networks have at most `L` hidden layers of at most `H` units.
    ///
    /// # Errors
    /// [`SizeError`] with the first limit that is exceeded.
    pub fn check_size<const E: usize, const H: usize, const L: usize>(&self) -> Result<(), SizeError> {
        SizeError::check("element types", self.types.len(), E)?;
        self.networks.check_size::<MAX_NETWORKS, H, L>()
    }
}

impl<'a, W: WeightFormat, const N: usize, const E: usize, const H: usize, const L: usize>
    Modular<'a, W, N, E, H, L>
{
    /// Builds a tree of this shape's elements on the front of `block` and leaves the rest there. `None` if the block is too short, the
    /// shape is inconsistent (see [`ModularShape::invalid_part`]), or it has more than `E` types, `L` hidden layers or `H` units in a
    /// layer.
    pub fn take(block: &mut &'a [W], shape: &ModularShape, tree: Tree<N>) -> Option<Self> {
        if shape.invalid_part().is_some() {
            return None;
        }
        let networks = shape.networks.take::<W, MAX_NETWORKS, H, L>(block)?;
        let network = |i: u8| networks.get(i).copied();
        let types = shape.types.try_map(|kind| take_type(block, kind, network))?;
        let pair = match shape.pair {
            None => None,
            Some(pair) => Some(Pair { potential: network(pair.network)?, input: pair.input }),
        };
        let (coefficients, rest) = block.split_first_chunk::<2>()?;
        *block = rest;
        Some(Self { types, pair, coefficients: *coefficients, tree })
    }
}

fn take_type<'a, W: WeightFormat, const H: usize, const L: usize>(
    block: &mut &'a [W],
    shape: &TypeShape,
    network: impl Fn(u8) -> Option<Mlp<'a, W, H, L>>,
) -> Option<ElementType<'a, W, H, L>> {
    let transform = match shape.transform {
        TransformShape::Network { position, velocity, input } => {
            let velocity = match velocity {
                None => None,
                Some(velocity) => Some(network(velocity)?),
            };
            Transform::Network { position: network(position)?, velocity, input }
        }
        TransformShape::Rod => Transform::Rod,
        TransformShape::Slide => Transform::Slide,
        TransformShape::Free => Transform::Free,
    };
    let potential = match shape.potential {
        None => None,
        Some(potential) => Some(network(potential)?),
    };
    let numbers = ElementParameters::take(block)?;
    Some(ElementType { transform, potential, numbers })
}
