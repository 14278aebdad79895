//! Shape of a graph model, without its numbers and its graphs.

use super::GraphError;
use super::round::NODE_QUANTITIES;
use crate::energy::distance::DistanceFeature;
use crate::energy::network_shape::first_invalid;
use crate::energy::{List, NetworkShape, SizeError};
use crate::scalar::{Real, Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Maximum number of networks of a model.
pub const MAX_NETWORKS: usize = 12;
/// Maximum number of node types of a model.
pub const MAX_NODE_TYPES: usize = 6;
/// Maximum number of edge types of a model.
pub const MAX_EDGE_TYPES: usize = 6;
/// Number of parameters of an edge type: c₁ and c₂ of its law.
pub const EDGE_NUMBERS: usize = 2;
/// Maximum length of an embedding.
pub const MAX_EMBEDDING: usize = 8;

/// Kinetic energy T(v) of a node; networks are given by number, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kinetic {
    /// ½m|v|².
    Mass,
    /// net(k ‖ |v|²), with k the type's kinetic embedding (LGNN's T_i).
    Network(u8),
}

/// Potential V(x) of a node at position x.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Potential {
    /// 0.
    None,
    /// g·x: a uniform field, which pulls with −g.
    Uniform,
    /// g·x + net(h ‖ x), with h the type's embedding; without g it is LGNN's V_i.
    ///
    /// A network alone represents a uniform field such as gravity only within the range of its data.
    Network(u8),
}

/// Drag Q(v) on a node, by component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Drag {
    /// 0.
    None,
    /// −cv, c ≥ 0.
    Viscous,
    /// −(c + |net(v_i)|)v_i for each component i; LGNN's drag if c = 0. The slope jumps where the network is 0.
    Network(u8),
}

/// Input of an edge's networks: a function of the distance of the edge's ends alone, so linear and angular momentum are conserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Separation {
    /// r = |x_a − x_b|, m (LGNN); not differentiable at 0.
    Distance,
    /// r², m²: smooth everywhere, and without a square root.
    Squared,
}

impl Separation {
    /// The feature of the distance for the networks.
    #[inline(always)]
    pub(super) fn feature(self) -> DistanceFeature {
        match self {
            Self::Distance => DistanceFeature::Distance,
            Self::Squared => DistanceFeature::Squared,
        }
    }
}

/// The shape of a node type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NodeShape {
    /// Kinetic energy T.
    pub kinetic: Kinetic,
    /// Potential V.
    pub potential: Potential,
    /// Drag Q.
    pub drag: Drag,
}

/// The shape of an edge type: U = c₁z + c₂z² + net(z), with z given by the [`Separation`]. If z = r, c₁ and c₂ alone are a linear spring,
/// ½k(r − ℓ)² up to a constant, which a network alone represents only within the range of its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EdgeShape {
    /// Feature z of the distance.
    pub separation: Separation,
    /// Network of the pair potential, counted once per edge.
    pub potential: Option<u8>,
    /// Network f_b of the edge's embedding: present in all edge types of a model with messages, and in none of a model without.
    pub embedding: Option<u8>,
}

/// Networks of one round of messages (LGNN, as in its published program), with h_i the embedding of node i's type and e_ij = f_b of the
/// edge's separation:
///
/// n_i = h_i + Σ_j f_v(h_j ‖ e_ij), e′_ij = e_ij + f_e(n_i ∘ n_j), V = 2Σ_edges f₁(e′_ij) + Σ_i f₂(n_i).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageShape {
    /// Network f_v.
    pub message: u8,
    /// Network f_e.
    pub update: u8,
    /// Network f₁, counted once per direction of an edge.
    pub edge_potential: Option<u8>,
    /// Network f₂.
    pub node_potential: Option<u8>,
}

/// The shape of a graph model. Its weight block has the networks in order, then the numbers of each node type: mass (kg), viscous drag c (N
/// s/m), field (N, one per dimension), kinetic embedding, embedding; then c₁ and c₂ of each edge type. Numbers that a type does not use
/// have no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphShape {
    /// Dimensions of space, 2 or 3.
    pub dimension: u8,
    /// Length of a node type's kinetic embedding.
    pub kinetic_embedding: u8,
    /// Length of a node type's embedding, an input of potentials and messages.
    pub embedding: u8,
    /// The networks. Types may share a network.
    pub networks: List<NetworkShape, MAX_NETWORKS>,
    /// The node types.
    pub nodes: List<NodeShape, MAX_NODE_TYPES>,
    /// The edge types.
    pub edges: List<EdgeShape, MAX_EDGE_TYPES>,
    /// The messages, if any.
    pub messages: Option<MessageShape>,
}

impl GraphShape {
    /// Workspace length of a graph of `nodes` nodes for the evaluation of its messages; 0 without messages.
    pub fn workspace(&self, nodes: usize) -> usize {
        self.messages.map_or(0, |_| NODE_QUANTITIES * usize::from(self.embedding) * nodes)
    }

    /// Creates a shape without embeddings and messages; `None` if a list is too long.
    pub fn new(
        dimension: u8,
        networks: &[NetworkShape],
        nodes: &[NodeShape],
        edges: &[EdgeShape],
    ) -> Option<Self> {
        Some(Self {
            dimension,
            kinetic_embedding: 0,
            embedding: 0,
            networks: List::new(networks)?,
            nodes: List::new(nodes)?,
            edges: List::new(edges)?,
            messages: None,
        })
    }

    /// Number of parameters of a node type, not counting its networks.
    #[inline(always)]
    pub fn numbers(&self) -> usize {
        let field_and_embeddings = [self.dimension, self.kinetic_embedding, self.embedding].map(usize::from);
        2 + field_and_embeddings.iter().sum::<usize>()
    }

    /// Number of parameters of all node types and edge types, which follow the networks in the weight block.
    pub fn all_numbers(&self) -> usize {
        self.numbers() * self.nodes.len() + EDGE_NUMBERS * self.edges.len()
    }

    /// Length of the weight block, in numbers; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        self.networks.parameters()?.checked_add(self.all_numbers())
    }

    /// Checks the signs of the node types' numbers: masses in use must be positive, coefficients of viscous drag not negative.
    ///
    /// # Errors
    /// [`GraphError::Mass`] and [`GraphError::Drag`] for the first number that is out of range.
    pub fn check_numbers<W: WeightFormat<Wide: Real>>(&self, numbers: &[W]) -> Result<(), GraphError> {
        for (kind, node) in self.nodes.iter().enumerate() {
            let own = numbers.get(kind * self.numbers()..).and_then(|rest| rest.first_chunk::<2>());
            let Some([mass, drag]) = own.map(|own| own.map(W::wide)) else { return Ok(()) };
            let zero = W::Wide::zero();
            if node.kinetic == Kinetic::Mass && !(mass > zero && mass.is_finite()) {
                return Err(GraphError::Mass { kind });
            }
            if node.drag != Drag::None && !(drag >= zero && drag.is_finite()) {
                return Err(GraphError::Drag { kind });
            }
        }
        Ok(())
    }

    /// Length of an edge's embedding, the same for all edge types; 0 without messages.
    pub(super) fn edge_embedding(&self) -> usize {
        let network = self.edges.iter().next().and_then(|edge| self.networks.get(edge.embedding?));
        network.map_or(0, |network| network.outputs.into())
    }

    /// Name of the first invalid part; `None` if the shape is valid.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let e = self.edge_embedding();
        let embeddings = [self.kinetic_embedding.into(), self.embedding.into(), e];
        let invalid = [
            (!matches!(self.dimension, 2 | 3), "number of dimensions"),
            (embeddings.into_iter().any(|length| length > MAX_EMBEDDING), "length of an embedding"),
            (self.nodes.is_empty(), "number of node types"),
            (self.nodes.has_gap(), "list of node types"),
            (self.edges.has_gap(), "list of edge types"),
            (!self.nodes.iter().all(|node| self.serves_node(node)), "network of a node type"),
            (!self.edges.iter().all(|edge| self.serves_edge(edge, e)), "network of an edge type"),
            (!self.messages.is_none_or(|of| self.serves_messages(&of, e)), "network of the messages"),
        ];
        self.networks.invalid_part().or_else(|| first_invalid(&invalid))
    }

    /// Checks that space has `D` dimensions, and that there are at most `K` networks of at most `L` hidden layers of at most `H` units
    /// each.
    ///
    /// # Errors
    /// [`SizeError`] with the first size that does not fit the compiled one.
    pub fn check_size<const D: usize, const K: usize, const H: usize, const L: usize>(
        &self,
    ) -> Result<(), SizeError> {
        let dimension = usize::from(self.dimension);
        if dimension != D {
            return Err(SizeError { what: "dimensions", found: dimension, compiled: D });
        }
        self.networks.check_size::<K, H, L>()
    }

    fn serves(&self, network: u8, inputs: usize, outputs: usize) -> bool {
        self.networks.serves(network, inputs, outputs)
    }

    fn serves_node(&self, node: &NodeShape) -> bool {
        let [d, kinetic, h] = [self.dimension, self.kinetic_embedding, self.embedding].map(usize::from);
        let kinetic = match node.kinetic {
            Kinetic::Mass => true,
            Kinetic::Network(network) => self.serves(network, kinetic + 1, 1),
        };
        let potential = match node.potential {
            Potential::None | Potential::Uniform => true,
            Potential::Network(network) => self.serves(network, h + d, 1),
        };
        let drag = match node.drag {
            Drag::None | Drag::Viscous => true,
            Drag::Network(network) => self.serves(network, 1, 1),
        };
        kinetic && potential && drag
    }

    fn serves_edge(&self, edge: &EdgeShape, e: usize) -> bool {
        edge.embedding.is_some() == self.messages.is_some()
            && edge.potential.is_none_or(|n| self.serves(n, 1, 1))
            && edge.embedding.is_none_or(|n| self.serves(n, 1, e))
    }

    fn serves_messages(&self, messages: &MessageShape, e: usize) -> bool {
        let h = usize::from(self.embedding);
        h > 0
            && self.serves(messages.message, h + e, h)
            && self.serves(messages.update, h, e)
            && messages.edge_potential.is_none_or(|n| self.serves(n, e, 1))
            && messages.node_potential.is_none_or(|n| self.serves(n, h, 1))
    }
}
