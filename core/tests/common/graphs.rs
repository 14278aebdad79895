//! Graphs of every kind, with a naive evaluation of their energies.

use super::Random;
use super::oracle::Learned;
use super::shapes::naive_network;
use super::trees::network;
use leastaction_core::energy::List;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, Fixed, Graph, GraphShape, Kinetic, MessageShape, NodeShape,
    Potential, Separation, Types,
};
use leastaction_core::network::Activation;
use leastaction_core::scalar::{Scalar, WeightFormat};

pub const NETWORKS: usize = 11;
pub const WIDTH: usize = 11;
pub const DEPTH: usize = 3;

pub type LearnedTypes<'a, W, const D: usize> = Types<'a, W, D, NETWORKS, WIDTH, DEPTH>;
pub type LearnedGraph<'a, W, const D: usize> = Graph<'a, W, D, NETWORKS, WIDTH, DEPTH>;
pub type LearnedFixed<'a, W, const D: usize, const N: usize> = Fixed<'a, W, D, NETWORKS, WIDTH, DEPTH, N>;

/// A graph in D dimensions that owns its weights and lists.
#[derive(Clone, Debug)]
pub struct Model<const D: usize> {
    pub shape: GraphShape,
    pub nodes: Vec<u8>,
    pub edges: Vec<Edge>,
    pub weights: Vec<f64>,
}

pub const fn edge(kind: u8, a: u16, b: u16) -> Edge {
    Edge { kind, ends: [a, b] }
}

impl<const D: usize> Model<D> {
    pub fn new(shape: GraphShape, nodes: &[u8], edges: &[Edge], seed: u64) -> Self {
        let mut weights = Random(seed).vector(shape.parameters().unwrap(), 0.8);
        let start = weights.len() - shape.all_numbers();
        for numbers in weights[start..].chunks_exact_mut(shape.numbers()).take(shape.nodes.len()) {
            numbers[..2].iter_mut().for_each(|x| *x = 1.0 + 0.5 * *x);
        }
        // Fourth powers of distances would drown all other terms.
        let laws = weights.len() - EDGE_NUMBERS * shape.edges.len();
        weights[laws..].iter_mut().for_each(|x| *x *= 0.01);
        Self { shape, nodes: nodes.to_vec(), edges: edges.to_vec(), weights }
    }

    /// The types over a weight block of any scalar, of this shape.
    pub fn types<'w, W: WeightFormat>(&self, mut weights: &'w [W]) -> LearnedTypes<'w, W, D> {
        let types = Types::take(&mut weights, &self.shape).expect("weights of this shape");
        assert!(weights.is_empty(), "{} weights too many", weights.len());
        types
    }

    pub fn graph<'a, W: WeightFormat>(&'a self, weights: &'a [W]) -> LearnedGraph<'a, W, D> {
        Graph::new(self.types(weights), &self.nodes, &self.edges).expect("a graph")
    }

    pub fn in_f64(&self) -> LearnedGraph<'_, f64, D> {
        self.graph(&self.weights)
    }

    fn run(&self, network: u8, x: Vec<f64>) -> Vec<f64> {
        let before = self.shape.networks.iter().take(network.into()).map(|n| n.parameters().unwrap()).sum();
        let shape = self.shape.networks.get(network).unwrap();
        let widths = shape.widths.into_iter().filter(|w| *w > 0).map(usize::from);
        naive_network(&self.weights[before..], x, widths, shape.activation, shape.outputs.into())
    }

    /// Mass, drag, field, kinetic embedding and embedding of a type.
    fn numbers(&self, kind: u8) -> (f64, f64, &[f64], &[f64], &[f64]) {
        let stride = self.shape.numbers();
        let start = self.weights.len() - self.shape.all_numbers() + stride * usize::from(kind);
        let (field, rest) = self.weights[start + 2..start + stride].split_at(D);
        let (kinetic, embedding) = rest.split_at(self.shape.kinetic_embedding.into());
        (self.weights[start], self.weights[start + 1], field, kinetic, embedding)
    }

    pub fn naive_kinetic(&self, kind: u8, v: &[f64; D]) -> f64 {
        let (mass, _, _, embedding, _) = self.numbers(kind);
        let square = v.iter().map(|v| v * v).sum();
        match self.shape.nodes.get(usize::from(kind)).unwrap().kinetic {
            Kinetic::Mass => 0.5 * mass * square,
            Kinetic::Network(network) => self.run(network, [embedding, &[square]].concat())[0],
        }
    }

    pub fn naive_drag(&self, kind: u8, v: f64) -> f64 {
        let viscous = -self.numbers(kind).1 * v;
        match self.shape.nodes.get(usize::from(kind)).unwrap().drag {
            Drag::None => 0.0,
            Drag::Viscous => viscous,
            Drag::Network(network) => viscous - self.run(network, vec![v])[0].abs() * v,
        }
    }

    fn naive_node(&self, kind: u8, x: &[f64; D]) -> f64 {
        let (_, _, field, _, embedding) = self.numbers(kind);
        let uniform: f64 = field.iter().zip(x).map(|(g, x)| g * x).sum();
        match self.shape.nodes.get(usize::from(kind)).unwrap().potential {
            Potential::None => 0.0,
            Potential::Uniform => uniform,
            Potential::Network(network) => uniform + self.run(network, [embedding, x].concat())[0],
        }
    }

    pub fn naive_potential(&self, q: &[[f64; D]]) -> f64 {
        let nodes: f64 = self.nodes.iter().zip(q).map(|(kind, x)| self.naive_node(*kind, x)).sum();
        let pair = |edge: &Edge| {
            let shape = self.shape.edges.get(usize::from(edge.kind)).unwrap();
            let [a, b] = edge.ends.map(|end| q[usize::from(end)]);
            let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
            let seen = match shape.separation {
                Separation::Distance => square.sqrt(),
                Separation::Squared => square,
            };
            let start = self.weights.len() - 2 * (self.shape.edges.len() - usize::from(edge.kind));
            let law = self.weights[start] * seen + self.weights[start + 1] * seen * seen;
            law + shape.potential.map_or(0.0, |network| self.run(network, vec![seen])[0])
        };
        nodes + self.edges.iter().map(pair).sum::<f64>() + self.naive_messages(q)
    }

    /// Potential of the messages, with every edge in both directions as in LGNN's program.
    fn naive_messages(&self, q: &[[f64; D]]) -> f64 {
        let Some(messages) = self.shape.messages else { return 0.0 };
        let h: Vec<&[f64]> = self.nodes.iter().map(|kind| self.numbers(*kind).4).collect();
        let directed = || {
            self.edges.iter().flat_map(|edge| {
                [edge.ends, [edge.ends[1], edge.ends[0]]].map(|ends| (edge.kind, ends.map(usize::from)))
            })
        };
        let embed = |kind: u8, [a, b]: [usize; 2]| {
            let shape = self.shape.edges.get(usize::from(kind)).unwrap();
            let square: f64 = q[a].iter().zip(&q[b]).map(|(a, b)| (a - b).powi(2)).sum();
            let seen = if shape.separation == Separation::Distance { square.sqrt() } else { square };
            self.run(shape.embedding.unwrap(), vec![seen])
        };
        let mut n: Vec<Vec<f64>> = h.iter().map(|h| h.to_vec()).collect();
        for (kind, [from, to]) in directed() {
            let sent = self.run(messages.message, [h[from], &embed(kind, [from, to])].concat());
            n[to].iter_mut().zip(sent).for_each(|(n, sent)| *n += sent);
        }
        let edges = directed().map(|(kind, [a, b])| {
            let product = n[a].iter().zip(&n[b]).map(|(a, b)| a * b).collect();
            let change = self.run(messages.update, product);
            let updated = embed(kind, [a, b]).iter().zip(change).map(|(e, change)| e + change).collect();
            messages.edge_potential.map_or(0.0, |network| self.run(network, updated)[0])
        });
        let of_nodes = n.iter().map(|n| messages.node_potential.map_or(0.0, |p| self.run(p, n.clone())[0]));
        edges.sum::<f64>() + of_nodes.sum::<f64>()
    }
}

/// A graph of N coordinates in D dimensions.
#[derive(Clone, Debug)]
pub struct FixedModel<const D: usize, const N: usize>(pub Model<D>);

impl<const D: usize, const N: usize> FixedModel<D, N> {
    pub fn in_f64(&self) -> LearnedFixed<'_, f64, D, N> {
        self.energies_over::<f64>(&self.0.weights)
    }
}

impl<const D: usize, const N: usize> Learned<N> for FixedModel<D, N> {
    type Over<'w, S: Scalar>
        = LearnedFixed<'w, S::Weight, D, N>
    where
        S::Weight: 'w,
        Self: 'w;

    fn energies_over<'w, S: Scalar>(&'w self, weights: &'w [S::Weight]) -> Self::Over<'w, S> {
        Fixed::new(self.0.graph(weights)).expect("as many coordinates")
    }

    fn weights(&self) -> &[f64] {
        &self.0.weights
    }

    fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64) {
        let velocities = v.as_chunks().0;
        let kinetic =
            self.0.nodes.iter().zip(velocities).map(|(kind, v)| self.0.naive_kinetic(*kind, v)).sum();
        (kinetic, self.0.naive_potential(q.as_chunks().0))
    }
}

/// Node types with every kind of term, and two edge types.
pub fn every_term(dimension: u8) -> GraphShape {
    let networks = [
        network(4, &[7, 5], 1, Activation::Softplus),
        network(2 + dimension, &[9], 1, Activation::Tanh),
        network(1, &[4], 1, Activation::Isru),
        network(1, &[6, 3], 1, Activation::Squareplus),
        network(1, &[11], 1, Activation::Tanh),
    ];
    let nodes = [
        NodeShape { kinetic: Kinetic::Mass, potential: Potential::None, drag: Drag::Viscous },
        NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(1), drag: Drag::Network(2) },
        NodeShape { kinetic: Kinetic::Mass, potential: Potential::Uniform, drag: Drag::None },
    ];
    let edges = [(Separation::Distance, 3), (Separation::Squared, 4)]
        .map(|(separation, network)| EdgeShape { separation, potential: Some(network), embedding: None });
    let shape = GraphShape::new(dimension, &networks, &nodes, &edges).expect("few parts");
    GraphShape { kinetic_embedding: 3, embedding: 2, ..shape }
}

/// Node and edge types with every kind of term, and messages.
pub fn with_messages(dimension: u8) -> GraphShape {
    let shape = every_term(dimension);
    let messaging = [
        network(1, &[4], 3, Activation::Tanh),
        network(5, &[6], 2, Activation::Squareplus),
        network(2, &[5], 3, Activation::Isru),
        network(3, &[4], 1, Activation::Tanh),
        network(2, &[3], 1, Activation::Tanh),
    ];
    let networks: Vec<_> = shape.networks.iter().copied().chain(messaging).collect();
    let edges: Vec<_> = shape.edges.iter().map(|edge| EdgeShape { embedding: Some(5), ..*edge }).collect();
    let nodes: Vec<_> = shape.nodes.iter().copied().collect();
    let messages = MessageShape { message: 6, update: 7, edge_potential: Some(8), node_potential: Some(9) };
    GraphShape {
        kinetic_embedding: shape.kinetic_embedding,
        embedding: shape.embedding,
        messages: Some(messages),
        ..GraphShape::new(dimension, &networks, &nodes, &edges).expect("few parts")
    }
}

/// A planar graph with messages; two edges join the same nodes, and one node has no edge.
pub fn talking() -> Model<2> {
    let edges = [edge(0, 0, 1), edge(1, 3, 1), edge(1, 1, 0)];
    Model::new(with_messages(2), &[1, 0, 2, 1], &edges, 3)
}

/// A graph with messages and one node type, so an edge sends the same message to both ends.
pub fn alike() -> Model<2> {
    let shape = with_messages(2);
    let node = NodeShape { kinetic: Kinetic::Mass, potential: Potential::Network(1), drag: Drag::None };
    let nodes = List::new(&[node]).expect("one type");
    Model::new(GraphShape { nodes, ..shape }, &[0; 4], &talking().edges, 6)
}

/// A planar graph: every type twice, edges of both types.
pub fn flat() -> Model<2> {
    let edges = [edge(0, 0, 1), edge(1, 3, 1), edge(1, 2, 0), edge(0, 3, 2)];
    Model::new(every_term(2), &[1, 0, 2, 1], &edges, 1)
}

/// A graph in space.
pub fn spatial() -> Model<3> {
    Model::new(every_term(3), &[2, 1, 0], &[edge(1, 2, 1), edge(0, 0, 2)], 2)
}
