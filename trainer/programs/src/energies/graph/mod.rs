//! Particles with energies of their own, of the edges between them, and of messages along the edges
//! ([`leastaction_core::energy::graph`]), for any number of nodes and edges.
//!
//! All nodes of a type, and all edges of a type, are columns of the same operations. The list is therefore as long for
//! two nodes as for thousands, and evaluating it takes time in proportion to the number of nodes and edges.

mod edges;
mod messages;
mod nodes;

use super::network::{Kinds, entries};
use super::{Energies, Network};
use crate::builder::Builder;
use crate::operation::Node;
use edges::EdgeGroup;
use leastaction_core::energy::graph::{EDGE_NUMBERS, Edge, GraphShape};
use leastaction_core::model::ModelError;
use messages::Messages;
use nodes::NodeGroup;

/// A graph of particles (LGNN; Bhattoo, Ranu, Krishnan, MLST 2023), with coordinates node after node:
///
/// L = Σ_i T_i(|v_i|²) − Σ_i V_i(x_i) − Σ_edges U(z) − V_messages,
///
/// with drag Q on every node, a function of its own velocity; [`GraphShape`] defines the terms.
///
/// The size is limited only by the fields of the model file (65,536 nodes) and by core's constants for the numbers of
/// types, networks and hidden layers and for the length of an embedding.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphEnergies {
    dimension: usize,
    /// Types of all nodes.
    kinds: Vec<u8>,
    nodes: Vec<NodeGroup>,
    edges: Vec<EdgeGroup>,
    networks: Vec<Network>,
    numbers: Numbers,
    messages: Option<Messages>,
}

impl GraphEnergies {
    /// Creates the graph of these nodes, given by their types, and of these edges. `start` is the position of the
    /// model's first number in the weight block; the numbers before it belong to other parts.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an inconsistent shape, [`ModelError::Graph`] for a graph that does not fit the shape.
    pub fn new(shape: &GraphShape, nodes: &[u8], edges: &[Edge], start: usize) -> Result<Self, ModelError> {
        if let Some(what) = shape.invalid_part() {
            return Err(ModelError::OutOfRange { what });
        }
        shape.check_graph(nodes, edges.iter().copied()).map_err(ModelError::Graph)?;
        let mut end = start;
        let networks = shape.networks.iter().map(|network| {
            let network = Network::new(network, end);
            end = network.end();
            network
        });
        let networks = networks.collect();
        Ok(Self {
            dimension: shape.dimension.into(),
            kinds: nodes.to_vec(),
            nodes: NodeGroup::all(shape, nodes),
            edges: EdgeGroup::all(shape, edges),
            networks,
            numbers: Numbers::new(shape, end),
            messages: Messages::new(shape, nodes, edges),
        })
    }

    fn network(&self, network: u8) -> &Network {
        &self.networks[usize::from(network)]
    }

    /// Sum of a network's outputs over `columns` inputs x, as a vector of one number.
    fn total(&self, builder: &mut Builder, network: u8, columns: usize, x: Node) -> Node {
        let y = self.network(network).outputs(builder, columns, x);
        builder.total(y)
    }

    /// Positions of the vectors of these nodes among the coordinates, node after node.
    fn coordinates(&self, nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        entries(nodes, self.dimension)
    }
}

impl Energies for GraphEnergies {
    fn n(&self) -> usize {
        self.dimension * self.kinds.len()
    }

    fn parameters(&self) -> usize {
        self.numbers.end()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let (mut kinetic, mut potential) = (builder.zeros(1), builder.zeros(1));
        for group in &self.nodes {
            let own = self.kinetic(builder, group, v);
            kinetic = builder.sum(kinetic, own);
            let own = self.potential(builder, group, q);
            potential = builder.sum(potential, own);
        }
        let separations = self.separations(builder, q);
        for (group, z) in self.edges.iter().zip(&separations) {
            let own = self.pairs(builder, group, *z);
            potential = builder.sum(potential, own);
        }
        if let Some(messages) = &self.messages {
            let own = self.round(builder, messages, &separations);
            potential = builder.sum(potential, own);
        }
        [kinetic, potential]
    }

    fn force(&self, builder: &mut Builder, _: Node, v: Node, _: Node) -> Node {
        let mut force = builder.zeros(self.n());
        for group in &self.nodes {
            let own = self.drag(builder, group, v);
            force = builder.sum(force, own);
        }
        force
    }
}

/// Positions of the types' numbers in the weight block: mass, drag, field, kinetic embedding and embedding of each node type; then c₁ and
/// c₂ of each edge type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Numbers {
    start: usize,
    dimension: usize,
    kinetic_embedding: usize,
    embedding: usize,
    node_types: usize,
    edge_types: usize,
}

impl Numbers {
    fn new(shape: &GraphShape, start: usize) -> Self {
        Self {
            start,
            dimension: shape.dimension.into(),
            kinetic_embedding: shape.kinetic_embedding.into(),
            embedding: shape.embedding.into(),
            node_types: shape.nodes.len(),
            edge_types: shape.edges.len(),
        }
    }

    /// Position of a node type's first number.
    fn node(&self, kind: usize) -> usize {
        self.start + kind * (2 + self.dimension + self.kinetic_embedding + self.embedding)
    }

    fn mass(&self, builder: &mut Builder, kind: usize) -> Node {
        builder.parameters(self.node(kind), 1)
    }

    fn viscous(&self, builder: &mut Builder, kind: usize) -> Node {
        builder.parameters(self.node(kind) + 1, 1)
    }

    fn field(&self, builder: &mut Builder, kind: usize) -> Node {
        builder.parameters(self.node(kind) + 2, self.dimension)
    }

    fn kinetic_embedding(&self, builder: &mut Builder, kind: usize) -> Node {
        builder.parameters(self.node(kind) + 2 + self.dimension, self.kinetic_embedding)
    }

    fn embedding(&self, builder: &mut Builder, kind: usize) -> Node {
        let start = self.node(kind) + 2 + self.dimension + self.kinetic_embedding;
        builder.parameters(start, self.embedding)
    }

    /// Coefficients c₁ and c₂ of an edge type.
    fn law(&self, builder: &mut Builder, kind: usize) -> Node {
        builder.parameters(self.node(self.node_types) + EDGE_NUMBERS * kind, EDGE_NUMBERS)
    }

    /// Position of the number after the last one.
    fn end(&self) -> usize {
        self.node(self.node_types) + EDGE_NUMBERS * self.edge_types
    }
}

/// Outputs f(`embedding` ‖ x) for `columns` inputs x.
fn embedded(builder: &mut Builder, network: &Network, embedding: Node, (columns, x): (usize, Node)) -> Node {
    let kinds = Kinds { table: embedding, width: builder.length(embedding), of: &vec![0; columns] };
    network.outputs_of_kinds(builder, &kinds, x)
}
