//! The shape of a graph model, apart from its numbers and its graphs.

use super::GraphError;
use crate::energy::placed_network::NetworkShape;
use crate::scalar::{Real, Scalar, Stored};
use serde::{Deserialize, Serialize};

/// Networks of a model at most.
pub const MAX_NETWORKS: usize = 12;
/// Node types of a model at most.
pub const MAX_NODE_TYPES: usize = 6;
/// Edge types of a model at most.
pub const MAX_EDGE_TYPES: usize = 6;
/// Numbers of an edge type: c₁ and c₂ of its law.
pub const EDGE_NUMBERS: usize = 2;
/// Numbers of an embedding at most.
pub const MAX_EMBEDDING: usize = 8;

/// Kinetic energy T(v) of a node; networks by their number from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kinetic {
    /// ½m|v|².
    Mass,
    /// net(k ‖ |v|²), k the type's kinetic embedding (LGNN's T_i).
    Network(u8),
}

/// Potential V(x) of a node at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Potential {
    /// 0.
    None,
    /// g·x: a uniform field, which pulls with −g.
    Uniform,
    /// g·x + net(h ‖ x), h the type's embedding; without g LGNN's V_i.
    ///
    /// What is linear in x, as gravity is, a network alone has only over its data.
    Network(u8),
}

/// Drag Q(v) on a node, component by component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Drag {
    /// 0.
    None,
    /// −cv, c ≥ 0.
    Viscous,
    /// −(c + |net(v_c)|)v_c, without c LGNN's; its slope jumps where the network is 0.
    Network(u8),
}

/// What an edge sees of its ends: only how far they are apart, so linear and angular momentum are conserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Separation {
    /// r = |x_a − x_b|, m (LGNN); not differentiable where the two meet.
    Distance,
    /// r², m²: smooth everywhere, and without a square root.
    Squared,
}

/// The shape of a node type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NodeShape {
    /// T.
    pub kinetic: Kinetic,
    /// V.
    pub potential: Potential,
    /// Q.
    pub drag: Drag,
}

/// The shape of an edge type: U = c₁z + c₂z² + net(z) of what it sees, z. Of the distance, c₁ and c₂ alone are a linear spring,
/// ½k(r − ℓ)² but for a constant; what is so simple a network alone has only over its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EdgeShape {
    /// What its networks see.
    pub separation: Separation,
    /// The network of the pair potential, once an edge.
    pub potential: Option<u8>,
    /// The network f_b of its embedding; all edge types of a model with messages have one, and none without.
    pub embedding: Option<u8>,
}

/// One round of messages (LGNN, as its published program has it), with h_i the embedding of node i's type and e_ij = f_b of
/// the edge's separation:
///
/// n_i = h_i + Σ_j f_v(h_j ‖ e_ij), e′_ij = e_ij + f_e(n_i ∘ n_j), V = 2Σ_edges f₁(e′_ij) + Σ_i f₂(n_i).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageShape {
    /// f_v.
    pub message: u8,
    /// f_e.
    pub update: u8,
    /// f₁, counted once in each direction of an edge.
    pub edge_potential: Option<u8>,
    /// f₂.
    pub node_potential: Option<u8>,
}

/// The shape of a graph model. Its weight block: the networks in order, then of each node type its numbers: mass (kg), viscous
/// drag c (N s/m), field (N, as many as dimensions), kinetic embedding, embedding; then of each edge type c₁ and c₂. What a type does
/// not use has no meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphShape {
    /// Dimensions of space, 2 or 3.
    pub dimension: u8,
    /// Numbers of a node type's kinetic embedding.
    pub kinetic_embedding: u8,
    /// Numbers of a node type's embedding, which potentials and messages see.
    pub embedding: u8,
    /// The networks; the first `None` ends the list. Types may share one.
    pub networks: [Option<NetworkShape>; MAX_NETWORKS],
    /// The node types; the first `None` ends the list.
    pub nodes: [Option<NodeShape>; MAX_NODE_TYPES],
    /// The edge types; the first `None` ends the list.
    pub edges: [Option<EdgeShape>; MAX_EDGE_TYPES],
    /// Messages.
    pub messages: Option<MessageShape>,
}

impl GraphShape {
    /// Of these networks and types, without embeddings and messages; `None` for more than the lists hold.
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
            networks: list(networks)?,
            nodes: list(nodes)?,
            edges: list(edges)?,
            messages: None,
        })
    }

    /// The networks in order.
    pub fn networks(&self) -> impl Iterator<Item = &NetworkShape> {
        self.networks.iter().map_while(Option::as_ref)
    }

    /// The node types in order.
    pub fn nodes(&self) -> impl Iterator<Item = &NodeShape> {
        self.nodes.iter().map_while(Option::as_ref)
    }

    /// The edge types in order.
    pub fn edges(&self) -> impl Iterator<Item = &EdgeShape> {
        self.edges.iter().map_while(Option::as_ref)
    }

    /// Numbers of a node type beside its networks.
    #[inline(always)]
    pub fn numbers(&self) -> usize {
        let field_and_embeddings = [self.dimension, self.kinetic_embedding, self.embedding].map(usize::from);
        2 + field_and_embeddings.iter().sum::<usize>()
    }

    /// Numbers of all node types, then of all edge types: what follows the networks in the weight block.
    pub fn all_numbers(&self) -> usize {
        self.numbers() * self.nodes().count() + EDGE_NUMBERS * self.edges().count()
    }

    /// Numbers in the weight block; `None` on overflow.
    pub fn parameters(&self) -> Option<usize> {
        let networks =
            self.networks().try_fold(0usize, |sum, network| sum.checked_add(network.parameters()?))?;
        networks.checked_add(self.all_numbers())
    }

    /// Checks the numbers of all node types that must be positive: masses that are used, and coefficients of viscous drag.
    ///
    /// # Errors
    /// [`GraphError::Mass`] and [`GraphError::Drag`].
    pub fn check_numbers<W: Stored<Wide: Real>>(&self, numbers: &[W]) -> Result<(), GraphError> {
        for (kind, node) in self.nodes().enumerate() {
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

    /// Numbers of an edge's embedding: what the networks of all edge types give, 0 without messages.
    pub(super) fn edge_embedding(&self) -> usize {
        let network = self.edges().next().and_then(|edge| self.networks().nth(edge.embedding?.into()));
        network.map_or(0, |network| network.outputs.into())
    }

    /// What of the shape is out of range, if anything is.
    pub fn invalid_part(&self) -> Option<&'static str> {
        let [kinetic, h] = [self.kinetic_embedding, self.embedding].map(usize::from);
        let few = |n: usize| n <= MAX_EMBEDDING;
        let fits = [
            (matches!(self.dimension, 2 | 3), "number of dimensions"),
            (few(kinetic) && few(h) && few(self.edge_embedding()), "length of an embedding"),
            (self.nodes().next().is_some(), "number of node types"),
            (self.networks.iter().flatten().count() == self.networks().count(), "list of networks"),
            (self.nodes.iter().flatten().count() == self.nodes().count(), "list of node types"),
            (self.edges.iter().flatten().count() == self.edges().count(), "list of edge types"),
            (self.networks().all(NetworkShape::is_valid), "hidden width"),
            (self.nodes().all(|node| self.fits_node(node)), "network of a node type"),
            (self.edges().all(|edge| self.fits_edge(edge)), "network of an edge type"),
            (self.messages.is_none_or(|messages| self.fits_messages(&messages)), "network of the messages"),
        ];
        fits.into_iter().find(|(fits, _)| !fits).map(|(_, what)| what)
    }

    fn serves(&self, network: u8, inputs: usize, outputs: usize) -> bool {
        self.networks().nth(network.into()).is_some_and(|network| network.serves(inputs, outputs))
    }

    fn fits_node(&self, node: &NodeShape) -> bool {
        let [d, kinetic, h] = [self.dimension, self.kinetic_embedding, self.embedding].map(usize::from);
        let misfits = [
            matches!(node.kinetic, Kinetic::Network(n) if !self.serves(n, kinetic + 1, 1)),
            matches!(node.potential, Potential::Network(n) if !self.serves(n, h + d, 1)),
            matches!(node.drag, Drag::Network(n) if !self.serves(n, 1, 1)),
        ];
        misfits.iter().all(|invalid_part| !invalid_part)
    }

    fn fits_edge(&self, edge: &EdgeShape) -> bool {
        edge.embedding.is_some() == self.messages.is_some()
            && edge.potential.is_none_or(|n| self.serves(n, 1, 1))
            && edge.embedding.is_none_or(|n| self.serves(n, 1, self.edge_embedding()))
    }

    fn fits_messages(&self, messages: &MessageShape) -> bool {
        let (h, e) = (usize::from(self.embedding), self.edge_embedding());
        h > 0
            && self.serves(messages.message, h + e, h)
            && self.serves(messages.update, h, e)
            && messages.edge_potential.is_none_or(|n| self.serves(n, e, 1))
            && messages.node_potential.is_none_or(|n| self.serves(n, h, 1))
    }
}

fn list<T: Copy, const N: usize>(of: &[T]) -> Option<[Option<T>; N]> {
    let mut list = [None; N];
    for (slot, item) in list.get_mut(..of.len())?.iter_mut().zip(of) {
        *slot = Some(*item);
    }
    Some(list)
}
