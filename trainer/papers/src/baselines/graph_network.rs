//! Graph networks with one round of messages, with which LGNN's authors compare, for any graph.

use super::layers_of;
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_models::NamedGraph;
use leastaction_programs::energies::Network;
use leastaction_programs::{Builder, Function, Node};

/// Sizes of a graph network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraphSizes {
    /// Number of components D of a position, 1 or more.
    pub dimension: usize,
    /// Number of entries of a node's embedding, 1 or more.
    pub node: usize,
    /// Number of entries of an edge's embedding, 1 or more.
    pub edge: usize,
    /// Number of units of each of the two hidden layers, 1 or more.
    pub hidden: usize,
}

impl GraphSizes {
    /// Sizes of LGNN's program.
    pub const LGNN: Self = Self { dimension: 2, node: 8, edge: 8, hidden: 16 };

    /// Numbers of inputs, hidden layers and outputs of the networks, in the order of the weight block; the last network
    /// is the read-out.
    fn networks(self, outputs: usize) -> [[usize; 3]; 5] {
        let Self { dimension, node, edge, .. } = self;
        [
            [1, 0, edge],
            [2 * dimension + 1, 0, node],
            [edge + 2 * node, 2, edge],
            [node + 2 * edge, 2, node],
            [node, 2, outputs],
        ]
    }
}

/// Networks, and a graph whose edges carry messages both ways.
///
/// Nodes h_i = N_h(x_i, v_i, type_i) and edges e_ij = N_e(|x_i − x_j|) are embedded linearly; then e′_ij = N_m(e_ij, h_i, h_j) for both
/// directions of an edge, and h′_i = N_u(h_i, Σ_j e′_ij, Σ_j e′_ji).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GraphNetwork {
    pub sizes: GraphSizes,
    outputs: usize,
    /// Types of all nodes.
    types: Vec<u8>,
    ends: Vec<[usize; 2]>,
    embed_edge: Network,
    embed_node: Network,
    message: Network,
    update: Network,
    read_out: Network,
}

impl GraphNetwork {
    /// Creates the network on the nodes and edges of a graph, with a read-out of `outputs` numbers. An error if an edge
    /// refers to a node that does not exist.
    pub fn new(
        (sizes, outputs): (GraphSizes, usize),
        graph: &NamedGraph,
        ends: impl Iterator<Item = [u16; 2]>,
    ) -> Result<Self, ModelError> {
        let ends: Vec<_> = ends.map(|ends| ends.map(usize::from)).collect();
        let (nodes, last) = (graph.nodes.len(), ends.iter().flatten().copied().max());
        if let Some(last) = last.filter(|last| *last >= nodes) {
            return Err(ModelError::Shape { what: "nodes", found: last + 1, compiled: nodes });
        }
        let mut start = 0;
        let [embed_edge, embed_node, message, update, read_out] =
            sizes.networks(outputs).map(|[inputs, hidden, outputs]| {
                let widths = vec![sizes.hidden; hidden];
                let network = Network::of_widths(inputs, &widths, (outputs, Activation::Squareplus), start);
                start = network.end();
                network
            });
        let types = graph.nodes.clone();
        Ok(Self { sizes, outputs, types, ends, embed_edge, embed_node, message, update, read_out })
    }

    pub fn nodes(&self) -> usize {
        self.types.len()
    }

    pub fn coordinates(&self) -> usize {
        self.sizes.dimension * self.nodes()
    }

    /// Length of the weight block in numbers, the same for any graph.
    pub fn parameters(&self) -> usize {
        self.read_out.end()
    }

    /// Numbers of inputs and outputs of every layer, in the order of the weight block.
    pub fn layers(&self) -> impl Iterator<Item = (usize, usize)> {
        let width = self.sizes.hidden;
        self.sizes.networks(self.outputs).into_iter().flat_map(move |[inputs, hidden, outputs]| {
            layers_of(&[&[inputs][..], &vec![width; hidden], &[outputs]].concat()).collect::<Vec<_>>()
        })
    }

    /// Embeddings of the nodes after the messages, node after node.
    pub fn messages(&self, builder: &mut Builder, q: Node, v: Node) -> Node {
        let GraphSizes { node, edge, .. } = self.sizes;
        let (h, e) = (self.embedded_nodes(builder, q, v), self.embedded_edges(builder, q));
        let sources = builder.joined(&[h, e]);
        let edges = self.nodes() * node;
        let seen = self.directions().flat_map(|(k, [from, to])| {
            entries(edges, k, edge).chain(entries(0, from, node)).chain(entries(0, to, node))
        });
        let seen = builder.gather(sources, &seen.collect::<Vec<_>>());
        let sent = self.message.outputs(builder, 2 * self.ends.len(), seen);
        self.updated(builder, h, sent)
    }

    /// Outputs of the read-out network for `columns` nodes, or for other inputs of the same length.
    pub fn read_out(&self, builder: &mut Builder, columns: usize, x: Node) -> Node {
        self.read_out.outputs(builder, columns, x)
    }

    /// Every edge in both directions: its number, and its sender and receiver.
    fn directions(&self) -> impl Iterator<Item = (usize, [usize; 2])> {
        self.ends.iter().enumerate().flat_map(|(k, [a, b])| [(k, [*a, *b]), (k, [*b, *a])])
    }

    /// Embeddings h = N_h(x, v, type).
    fn embedded_nodes(&self, builder: &mut Builder, q: Node, v: Node) -> Node {
        let (n, d) = (self.coordinates(), self.sizes.dimension);
        let types: Vec<f64> = self.types.iter().copied().map(f64::from).collect();
        let types = builder.constant(&types);
        let sources = builder.joined(&[q, v, types]);
        let seen = (0..self.nodes())
            .flat_map(|i| entries(0, i, d).chain(entries(n, i, d)).chain(entries(2 * n, i, 1)));
        let seen = builder.gather(sources, &seen.collect::<Vec<_>>());
        self.embed_node.outputs(builder, self.nodes(), seen)
    }

    /// Embeddings e = N_e(|x_i − x_j|), equal in both directions.
    fn embedded_edges(&self, builder: &mut Builder, q: Node) -> Node {
        let (d, count) = (self.sizes.dimension, self.ends.len());
        let [a, b] = [0, 1].map(|end| {
            let places = self.ends.iter().flat_map(|ends| entries(0, ends[end], d));
            builder.gather(q, &places.collect::<Vec<_>>())
        });
        let along = builder.difference(a, b);
        let squares = builder.product(along, along);
        let owners: Vec<usize> = (0..count * d).map(|entry| entry / d).collect();
        let square = builder.scatter(squares, &owners, count);
        let distance = builder.map(Function::SquareRoot, square);
        self.embed_edge.outputs(builder, count, distance)
    }

    /// Updated embeddings h′ = N_u(h, sum of the messages sent, sum of those received).
    fn updated(&self, builder: &mut Builder, h: Node, sent: Node) -> Node {
        let GraphSizes { node, edge, .. } = self.sizes;
        let nodes = self.nodes();
        let [from, to] = [0, 1].map(|end| {
            let places = self.directions().flat_map(|(_, ends)| entries(0, ends[end], edge));
            builder.scatter(sent, &places.collect::<Vec<_>>(), nodes * edge)
        });
        let sources = builder.joined(&[h, from, to]);
        let starts = [nodes * node, nodes * (node + edge)];
        let seen = (0..nodes).flat_map(|i| {
            entries(0, i, node).chain(entries(starts[0], i, edge)).chain(entries(starts[1], i, edge))
        });
        let seen = builder.gather(sources, &seen.collect::<Vec<_>>());
        self.update.outputs(builder, nodes, seen)
    }
}

/// Positions of an item's entries, `each` per item, from `start` on.
fn entries(start: usize, item: usize, each: usize) -> impl Iterator<Item = usize> {
    start + item * each..start + (item + 1) * each
}
