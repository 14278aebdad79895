//! The networks of a [`Gns`](super::Gns) on a graph, and their adjoint.

use super::GnsShape;
use crate::architecture::NamedGraph;
use leastaction_core::network::{Activation, Jet, Mlp, Tape};
use leastaction_core::scalar::Scalar;

/// Units of a hidden layer at most.
pub(super) const MAX_WIDTH: usize = 16;
/// Hidden layers at most.
const DEPTH: usize = 2;

type Values<S> = Vec<Jet<S, 0>>;

/// Who sends to whom.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wiring {
    dimension: usize,
    /// Type of every node.
    types: Vec<u8>,
    /// Sender and receiver: every edge of the graph in both directions.
    edges: Vec<[usize; 2]>,
}

impl Wiring {
    pub fn new(dimension: usize, graph: &NamedGraph) -> Self {
        let both = |[a, b]: [usize; 2]| [[a, b], [b, a]];
        let edges = graph.edges.iter().flat_map(|edge| both(edge.ends.map(usize::from))).collect();
        Self { dimension, types: graph.nodes.clone(), edges }
    }

    pub fn nodes(&self) -> usize {
        self.types.len()
    }

    pub fn coordinates(&self) -> usize {
        self.dimension * self.nodes()
    }

    /// The highest number of a node that an edge ends at.
    pub fn last_end(&self) -> Option<usize> {
        self.edges.iter().flatten().copied().max()
    }

    /// (x, v, type) of every node.
    fn of_nodes<S: Scalar<Weight = f64>>(&self, state: &[S]) -> impl Iterator<Item = Values<S>> {
        let (q, v) = state.split_at(self.coordinates());
        let nodes = q.chunks_exact(self.dimension).zip(v.chunks_exact(self.dimension)).zip(&self.types);
        nodes.map(|((x, v), kind)| {
            let kind = S::weight(f64::from(*kind));
            x.iter().chain(v).copied().chain([kind]).map(Jet::constant).collect()
        })
    }

    /// The distance between the ends of an edge.
    fn distance<S: Scalar>(&self, state: &[S], ends: [usize; 2]) -> Values<S> {
        let [a, b] = ends.map(|end| &state[self.dimension * end..self.dimension * (end + 1)]);
        let squares = a.iter().zip(b).map(|(a, b)| (*a - *b) * (*a - *b));
        vec![Jet::constant(squares.fold(S::zero(), |sum, square| sum + square).sqrt())]
    }
}

/// A network with the end of its weights in the block.
struct Placed<'w> {
    mlp: Mlp<'w, f64, DEPTH>,
    end: usize,
}

/// One use of a network: its inputs and outputs, with what the adjoint needs.
struct Used<S> {
    x: Values<S>,
    tape: Tape<S, 0, MAX_WIDTH, DEPTH>,
    y: Values<S>,
}

impl Placed<'_> {
    fn used<S: Scalar<Weight = f64>>(&self, x: Values<S>) -> Used<S> {
        let mut used = Used { x, tape: Tape::default(), y: vec![Jet::zero(); self.mlp.outputs()] };
        self.mlp.forward(&used.x, &mut used.tape, &mut used.y);
        used
    }

    /// x̄; adds ∂(ȳ·y)/∂θ to the row.
    fn adjoint<S: Scalar<Weight = f64>>(
        &self,
        used: &Used<S>,
        y_bar: &[Jet<S, 0>],
        row: &mut [S],
    ) -> Values<S> {
        let (mut start, mut x_bar) = (self.end, vec![Jet::zero(); used.x.len()]);
        self.mlp.adjoint_with_layers(&used.tape, (&used.x, &mut x_bar), y_bar, |layer, x, bar| {
            start -= layer.len();
            layer.series_gradient(x, bar, |position, g| row[start + position] += g);
        });
        x_bar
    }
}

/// All networks over one weight block.
pub(super) struct Networks<'w> {
    edge_embedding: Placed<'w>,
    node_embedding: Placed<'w>,
    edge: Placed<'w>,
    node: Placed<'w>,
    acceleration: Placed<'w>,
}

/// What a forward pass leaves for the adjoint: every use of every network, by edge or node.
pub struct Trace<S> {
    embedded_edges: Vec<Used<S>>,
    embedded_nodes: Vec<Used<S>>,
    edges: Vec<Used<S>>,
    nodes: Vec<Used<S>>,
    accelerations: Vec<Used<S>>,
}

impl<S: Scalar> Trace<S> {
    /// Writes v̇ of all nodes.
    pub fn accelerations(&self, out: &mut [S]) {
        let all = self.accelerations.iter().flat_map(|node| &node.y);
        out.iter_mut().zip(all).for_each(|(out, y)| *out = y.value);
    }
}

impl<'w> Networks<'w> {
    /// From the front of a block; `None` where it is too short.
    pub fn take(shape: GnsShape, weights: &'w [f64]) -> Option<Self> {
        let (mut rest, widths) = (weights, [shape.hidden; DEPTH]);
        let mut place = |[inputs, hidden, outputs]: [usize; 3]| {
            let mlp = Mlp::take(&mut rest, inputs, widths.get(..hidden)?, outputs, Activation::Squareplus)?;
            Some(Placed { mlp, end: weights.len() - rest.len() })
        };
        let [edge_embedding, node_embedding, edge, node, acceleration] = shape.networks();
        Some(Self {
            edge_embedding: place(edge_embedding)?,
            node_embedding: place(node_embedding)?,
            edge: place(edge)?,
            node: place(node)?,
            acceleration: place(acceleration)?,
        })
    }

    /// Accelerations at a state (q, v).
    pub fn forward<S: Scalar<Weight = f64>>(&self, wiring: &Wiring, state: &[S]) -> Trace<S> {
        let embedded_nodes: Vec<_> = wiring.of_nodes(state).map(|x| self.node_embedding.used(x)).collect();
        let embed = |ends: &[usize; 2]| self.edge_embedding.used(wiring.distance(state, *ends));
        let embedded_edges: Vec<_> = wiring.edges.iter().map(embed).collect();
        let message = |(e, [from, to]): (&Used<S>, &[usize; 2])| {
            self.edge.used([&*e.y, &embedded_nodes[*from].y, &embedded_nodes[*to].y].concat())
        };
        let edges: Vec<_> = embedded_edges.iter().zip(&wiring.edges).map(message).collect();
        let sums = self.sums(wiring, &edges).into_iter().zip(&embedded_nodes);
        let nodes: Vec<_> = sums.map(|(sums, h)| self.node.used([&*h.y, &sums].concat())).collect();
        let accelerations = nodes.iter().map(|node| self.acceleration.used(node.y.clone())).collect();
        Trace { embedded_edges, embedded_nodes, edges, nodes, accelerations }
    }

    /// Of every node what it has sent and what it has received, added up.
    fn sums<S: Scalar<Weight = f64>>(&self, wiring: &Wiring, edges: &[Used<S>]) -> Vec<Values<S>> {
        let size = self.edge.mlp.outputs();
        let mut sums = vec![vec![Jet::zero(); 2 * size]; wiring.nodes()];
        for (edge, [from, to]) in edges.iter().zip(&wiring.edges) {
            add(&mut sums[*from][..size], &edge.y);
            add(&mut sums[*to][size..], &edge.y);
        }
        sums
    }

    /// Adds ∂(v̄̇·v̇)/∂θ to the row.
    pub fn adjoint<S: Scalar<Weight = f64>>(
        &self,
        wiring: &Wiring,
        trace: &Trace<S>,
        a_bar: &[S],
        row: &mut [S],
    ) {
        let a_bar: Values<S> = a_bar.iter().copied().map(Jet::constant).collect();
        let (size, width) = (self.node_embedding.mlp.outputs(), self.edge.mlp.outputs());
        let all = trace.accelerations.iter().zip(&trace.nodes).zip(a_bar.chunks_exact(wiring.dimension));
        let mut nodes_bar: Vec<Values<S>> = all
            .map(|((read, node), a_bar)| {
                let node_bar = self.acceleration.adjoint(read, a_bar, row);
                self.node.adjoint(node, &node_bar, row)
            })
            .collect();
        let edges = trace.edges.iter().zip(&trace.embedded_edges).zip(&wiring.edges);
        for ((edge, embedded), [from, to]) in edges {
            let mut edge_bar = nodes_bar[*from][size..size + width].to_vec();
            add(&mut edge_bar, &nodes_bar[*to][size + width..]);
            let bar = self.edge.adjoint(edge, &edge_bar, row);
            add(&mut nodes_bar[*from][..size], &bar[width..width + size]);
            add(&mut nodes_bar[*to][..size], &bar[width + size..]);
            self.edge_embedding.adjoint(embedded, &bar[..width], row);
        }
        for (embedded, bar) in trace.embedded_nodes.iter().zip(&nodes_bar) {
            self.node_embedding.adjoint(embedded, &bar[..size], row);
        }
    }
}

fn add<S: Scalar>(sum: &mut [Jet<S, 0>], terms: &[Jet<S, 0>]) {
    sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum = sum.plus(term));
}
