//! The shape of a modular model, apart from its numbers and its trees.

use super::Modular;
use super::element::{ELEMENT_PARAMETERS, ElementParameters, ElementType, Input, Transform};
use super::potential::{Pair, PairInput};
use super::tree::{SPACE, Tree, TreeElement, TreeError};
use crate::energy::placed_network::{NetworkShape, PlacedNetwork};
use crate::scalar::Stored;
use serde::{Deserialize, Serialize};

/// Networks of a model at most.
pub const MAX_NETWORKS: usize = 8;
/// Element types of a model at most.
pub const MAX_TYPES: usize = 6;

/// How the coordinates of an element type move it; networks by their number from 0. See [`Transform`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TransformShape {
    /// A learned position.
    Network {
        /// T.
        position: u8,
        /// T_v; without it ẋ is the exact derivative of T.
        velocity: Option<u8>,
        /// How q enters.
        input: Input,
    },
    /// A rod turning about a pivot.
    Rod,
    /// A slide along the horizontal.
    Slide,
    /// A free point.
    Free,
}

/// The shape of an element type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TypeShape {
    /// How it moves.
    pub transform: TransformShape,
    /// The network of U₁, where it has a potential.
    pub potential: Option<u8>,
}

impl TypeShape {
    /// Coordinates of such an element.
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
    /// The network of U₂.
    pub network: u8,
    /// What it sees.
    pub input: PairInput,
}

/// The shape of a modular model. Its weight block: the networks in order, then the [`ElementParameters`] of each type, then c₁ and c₂.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModularShape {
    /// The networks; the first `None` ends the list. Types may share one.
    pub networks: [Option<NetworkShape>; MAX_NETWORKS],
    /// The element types; the first `None` ends the list.
    pub types: [Option<TypeShape>; MAX_TYPES],
    /// The pair potential.
    pub pair: Option<PairShape>,
}

impl ModularShape {
    /// Of these networks, types and pair potential; `None` for more than the lists hold.
    pub fn new(networks: &[NetworkShape], types: &[TypeShape], pair: Option<PairShape>) -> Option<Self> {
        let mut shape = Self { networks: [None; MAX_NETWORKS], types: [None; MAX_TYPES], pair };
        for (slot, network) in shape.networks.get_mut(..networks.len())?.iter_mut().zip(networks) {
            *slot = Some(*network);
        }
        for (slot, kind) in shape.types.get_mut(..types.len())?.iter_mut().zip(types) {
            *slot = Some(*kind);
        }
        Some(shape)
    }

    /// The networks in order.
    pub fn networks(&self) -> impl Iterator<Item = &NetworkShape> {
        self.networks.iter().map_while(Option::as_ref)
    }

    /// The element types in order.
    pub fn types(&self) -> impl Iterator<Item = &TypeShape> {
        self.types.iter().map_while(Option::as_ref)
    }

    /// ElementParameters in the weight block; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        let networks =
            self.networks().try_fold(0usize, |sum, network| sum.checked_add(network.parameters()?))?;
        networks.checked_add(ELEMENT_PARAMETERS * self.types().count() + 2)
    }

    /// Checks a tree against the types.
    ///
    /// # Errors
    /// See [`TreeError`].
    pub fn tree<const N: usize>(
        &self,
        nodes: impl IntoIterator<Item = TreeElement>,
    ) -> Result<Tree<N>, TreeError> {
        let coordinates = |kind| self.types().nth(kind).map(TypeShape::coordinates);
        Tree::new(nodes, self.types().count(), coordinates)
    }

    /// What of the shape is out of range, if anything is.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let serves = |network: u8, inputs: usize, outputs: usize| {
            let network = self.networks().nth(network.into());
            network.is_some_and(|n| n.serves(inputs, outputs))
        };
        let moves = |kind: &TypeShape| match kind.transform {
            TransformShape::Network { position, velocity, input } => {
                let serves = |network| serves(network, input.features(), SPACE);
                serves(position) && velocity.is_none_or(serves)
            }
            TransformShape::Rod | TransformShape::Slide | TransformShape::Free => true,
        };
        let fits = [
            (self.types().next().is_some(), "number of element types"),
            (self.networks.iter().flatten().count() == self.networks().count(), "list of networks"),
            (self.types.iter().flatten().count() == self.types().count(), "list of element types"),
            (self.networks().all(NetworkShape::is_valid), "hidden width"),
            (self.types().all(moves), "network of a transform"),
            (self.types().filter_map(|t| t.potential).all(|n| serves(n, SPACE, 1)), "network of a potential"),
            (
                self.pair.is_none_or(|p| serves(p.network, p.input.features(), 1)),
                "network of the pair potential",
            ),
        ];
        fits.into_iter().find(|(fits, _)| !fits).map(|(_, what)| what)
    }
}

impl<'a, W: Stored, const N: usize, const E: usize, const H: usize, const L: usize>
    Modular<'a, W, N, E, H, L>
{
    /// Builds a tree of this shape's elements on the front of `block` and leaves the rest there. `None` where the block is too
    /// short, the shape does not fit in itself (see [`ModularShape::invalid_part`]), or it has more than `E` types, `L` hidden layers or `H`
    /// units in one.
    pub fn take(block: &mut &'a [W], shape: &ModularShape, tree: Tree<N>) -> Option<Self> {
        if shape.invalid_part().is_some() || shape.types().count() > E {
            return None;
        }
        let mut start = 0;
        let mut networks = [None; MAX_NETWORKS];
        for (slot, network) in networks.iter_mut().zip(shape.networks()) {
            *slot = Some(PlacedNetwork::take::<H>(block, &mut start, network)?);
        }
        let network = |i: u8| networks.get(usize::from(i)).copied().flatten();
        let mut types = [None; E];
        for (slot, kind) in types.iter_mut().zip(shape.types()) {
            *slot = Some(take_type(block, &mut start, kind, network)?);
        }
        let pair = match shape.pair {
            None => None,
            Some(pair) => Some(Pair { potential: network(pair.network)?, input: pair.input }),
        };
        let (coefficients, rest) = block.split_first_chunk::<2>()?;
        *block = rest;
        Some(Self { types, pair, coefficients: *coefficients, start, tree })
    }
}

fn take_type<'a, W: Stored, const L: usize>(
    block: &mut &'a [W],
    start: &mut usize,
    shape: &TypeShape,
    network: impl Fn(u8) -> Option<PlacedNetwork<'a, W, L>>,
) -> Option<ElementType<'a, W, L>> {
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
    let element = ElementType { transform, potential, numbers, start: *start };
    *start += ELEMENT_PARAMETERS;
    Some(element)
}
