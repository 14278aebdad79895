//! One round of messages (LGNN). Every node sums the messages of its edges, every edge is updated by its two nodes, and
//! updated nodes and edges have potentials.

use super::GraphEnergies;
use crate::builder::Builder;
use crate::energies::network::{Kinds, entries};
use crate::operation::Node;
use leastaction_core::energy::graph::{Edge, GraphShape, MessageShape};

/// Messages of a graph.
///
/// A message f_v(h ‖ e) depends on its sender only through the sender's type, so an edge whose ends have the same type
/// sends one message to both ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Messages {
    shape: MessageShape,
    /// Length of an edge's embedding.
    width: usize,
    /// Ends of every edge.
    ends: Vec<[usize; 2]>,
    /// Edge of every message, and the type of its sender.
    sent: Vec<[usize; 2]>,
    /// Every arriving message, with the node at which it arrives.
    received: Vec<[usize; 2]>,
}

impl Messages {
    /// Returns the messages of a graph; `None` if the model has none.
    pub fn new(shape: &GraphShape, nodes: &[u8], edges: &[Edge]) -> Option<Self> {
        let embedding = shape.edges.iter().next().and_then(|edge| shape.networks.get(edge.embedding?));
        let mut messages = Self {
            shape: shape.messages?,
            width: embedding.map_or(0, |network| network.outputs.into()),
            ends: edges.iter().map(|edge| edge.ends.map(usize::from)).collect(),
            sent: Vec::new(),
            received: Vec::new(),
        };
        for edge in 0..edges.len() {
            messages.add(edge, nodes);
        }
        Some(messages)
    }

    /// Adds the messages of one edge.
    fn add(&mut self, edge: usize, nodes: &[u8]) {
        let [a, b] = self.ends[edge];
        let kinds = [a, b].map(|node| usize::from(nodes[node]));
        for (sender, receiver) in [(0, b), (1, a)] {
            if sender == 0 || kinds[0] != kinds[1] {
                self.sent.push([edge, kinds[sender]]);
            }
            self.received.push([self.sent.len() - 1, receiver]);
        }
    }
}

impl GraphEnergies {
    /// Potential V = 2Σ_edges f₁(e′) + Σ_i f₂(n_i), from the separations of all groups of edges.
    pub(super) fn round(&self, builder: &mut Builder, messages: &Messages, separations: &[Node]) -> Node {
        let e = self.edge_embeddings(builder, messages, separations);
        let n = self.received(builder, messages, e);
        let mut potential = builder.zeros(1);
        if let Some(network) = messages.shape.edge_potential {
            let updated = self.updated(builder, messages, e, n);
            let own = self.total(builder, network, messages.ends.len(), updated);
            potential = builder.scaled(2.0, own);
        }
        if let Some(network) = messages.shape.node_potential {
            let own = self.total(builder, network, self.kinds.len(), n);
            potential = builder.sum(potential, own);
        }
        potential
    }

    /// Embeddings e = f_b(z) of all edges, in their order.
    fn edge_embeddings(&self, builder: &mut Builder, messages: &Messages, separations: &[Node]) -> Node {
        let length = messages.width * messages.ends.len();
        let mut e = builder.zeros(length);
        for (group, z) in self.edges.iter().zip(separations) {
            let Some(network) = group.shape.embedding else { continue };
            let own = self.network(network).outputs(builder, group.places.len(), *z);
            let own = builder.scatter(own, &entries(group.places.iter().copied(), messages.width), length);
            e = builder.sum(e, own);
        }
        e
    }

    /// Sums n_i = h_i + Σ_j f_v(h_j ‖ e_ij) for all nodes, with h_i the embedding of node i's type.
    fn received(&self, builder: &mut Builder, messages: &Messages, e: Node) -> Node {
        let (width, types) = (self.numbers.embedding, self.numbers.node_types);
        let table: Vec<Node> = (0..types).map(|kind| self.numbers.embedding(builder, kind)).collect();
        let table = builder.joined(&table);
        let [edges, kinds] = [0, 1].map(|of| messages.sent.iter().map(|sent| sent[of]).collect::<Vec<_>>());
        let e = builder.gather(e, &entries(edges, messages.width));
        let kinds = Kinds { table, width, of: &kinds };
        let sent = self.network(messages.shape.message).outputs_of_kinds(builder, &kinds, e);
        let arriving =
            builder.gather(sent, &entries(messages.received.iter().map(|[message, _]| *message), width));
        let receivers = entries(messages.received.iter().map(|[_, receiver]| *receiver), width);
        let sums = builder.scatter(arriving, &receivers, width * self.kinds.len());
        let own = builder.gather(table, &entries(self.kinds.iter().map(|kind| usize::from(*kind)), width));
        builder.sum(own, sums)
    }

    /// Updated embeddings e′_ij = e_ij + f_e(n_i ∘ n_j) of all edges.
    fn updated(&self, builder: &mut Builder, messages: &Messages, e: Node, n: Node) -> Node {
        let [a, b] = [0, 1].map(|end| {
            let nodes = entries(messages.ends.iter().map(|ends| ends[end]), self.numbers.embedding);
            builder.gather(n, &nodes)
        });
        let product = builder.product(a, b);
        let change = self.network(messages.shape.update).outputs(builder, messages.ends.len(), product);
        builder.sum(e, change)
    }
}
