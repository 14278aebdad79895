//! Graph networks with one round of messages, as LGNN's authors compare with them, and their adjoints.

use leastaction::architecture::NamedGraph;
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Dense, Jet, Mlp, SecondOrderTape, Tape};
use leastaction_core::scalar::Scalar;
use std::iter::repeat_n;

/// Units of a hidden layer at most.
const MAX_WIDTH: usize = 16;
/// Hidden layers at most.
const DEPTH: usize = 2;

/// Sizes of a graph network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GraphSizes {
    /// Components D of a position, 1 or more.
    pub dimension: usize,
    /// Numbers that stand for a node, 1 or more.
    pub node: usize,
    /// Numbers that stand for an edge, 1 or more.
    pub edge: usize,
    /// Units of each of two hidden layers, 1 to 16.
    pub hidden: usize,
}

impl GraphSizes {
    /// Those of LGNN's program.
    pub const LGNN: Self = Self { dimension: 2, node: 8, edge: 8, hidden: 16 };

    /// Refuses wider hidden layers than are compiled.
    pub(super) fn checked(self) -> Result<Self, ModelError> {
        let what = "units in a hidden layer";
        let error = ModelError::Shape { what, found: self.hidden, compiled: MAX_WIDTH };
        if self.hidden <= MAX_WIDTH { Ok(self) } else { Err(error) }
    }

    /// Inputs, hidden layers and outputs of the networks, in the order of the weight block; the last reads nodes out.
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

    /// Inputs and outputs of every layer, in the order of the weight block.
    pub(super) fn layers(self, outputs: usize) -> impl Iterator<Item = (usize, usize)> {
        self.networks(outputs).into_iter().flat_map(move |[inputs, hidden, outputs]| {
            let mut sizes = vec![inputs];
            sizes.extend(repeat_n(self.hidden, hidden));
            sizes.push(outputs);
            sizes.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        })
    }

    /// Numbers in the weight block, whatever the graph.
    pub(super) fn parameters(self, outputs: usize) -> usize {
        self.layers(outputs).map(|(inputs, outputs)| (inputs + 1) * outputs).sum()
    }
}

/// Numbers with their derivatives.
pub(super) type Values<S, const T: usize> = Vec<Jet<S, T>>;

/// Who sends to whom.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wiring {
    dimension: usize,
    /// Type of every node.
    types: Vec<u8>,
    /// Sender and receiver.
    edges: Vec<[usize; 2]>,
}

impl Wiring {
    /// Both directions of these edges between the nodes of a graph.
    pub fn new(
        dimension: usize,
        graph: &NamedGraph,
        ends: impl Iterator<Item = [u16; 2]>,
    ) -> Result<Self, ModelError> {
        let both = |[a, b]: [usize; 2]| [[a, b], [b, a]];
        let edges: Vec<_> = ends.flat_map(|ends| both(ends.map(usize::from))).collect();
        let (nodes, last) = (graph.nodes.len(), edges.iter().flatten().copied().max());
        match last.filter(|last| *last >= nodes) {
            Some(last) => Err(ModelError::Shape { what: "nodes", found: last + 1, compiled: nodes }),
            None => Ok(Self { dimension, types: graph.nodes.clone(), edges }),
        }
    }

    pub fn dimension(&self) -> usize {
        self.dimension
    }

    pub fn nodes(&self) -> usize {
        self.types.len()
    }

    pub fn coordinates(&self) -> usize {
        self.dimension * self.nodes()
    }

    /// (x, v, type) of every node.
    fn of_nodes<S: Scalar<Weight = f64>, const T: usize>(
        &self,
        state: &[Jet<S, T>],
    ) -> impl Iterator<Item = Values<S, T>> {
        let (q, v) = state.split_at(self.coordinates());
        let nodes = q.chunks_exact(self.dimension).zip(v.chunks_exact(self.dimension)).zip(&self.types);
        nodes.map(|((x, v), kind)| {
            let kind = Jet::constant(S::weight(f64::from(*kind)));
            x.iter().chain(v).copied().chain([kind]).collect()
        })
    }

    /// From the receiver of an edge to its sender.
    fn along<S: Scalar, const T: usize>(&self, state: &[Jet<S, T>], ends: [usize; 2]) -> Values<S, T> {
        let [a, b] = ends.map(|end| &state[self.dimension * end..self.dimension * (end + 1)]);
        a.iter().zip(b).map(|(a, b)| a.plus(&b.scaled(-S::one()))).collect()
    }

    /// The distance between the ends of an edge.
    fn distance<S: Scalar, const T: usize>(&self, state: &[Jet<S, T>], ends: [usize; 2]) -> Jet<S, T> {
        let squares = self.along(state, ends).into_iter().map(|d| d.times(&d));
        let square = squares.fold(Jet::zero(), |sum, square| sum.plus(&square));
        let root = square.value.sqrt();
        square.chain(root, S::one().half() / root)
    }

    /// The adjoint of a state from that of what nodes and edges see of it.
    pub fn adjoint<S: Scalar, const T: usize>(
        &self,
        state: &[Jet<S, T>],
        bar: &InputsBar<S, T>,
    ) -> Values<S, T> {
        let (n, d) = (self.coordinates(), self.dimension);
        let mut state_bar = vec![Jet::zero(); 2 * n];
        for (i, node) in bar.nodes.iter().enumerate() {
            state_bar[d * i..d * (i + 1)].copy_from_slice(&node[..d]);
            state_bar[n + d * i..n + d * (i + 1)].copy_from_slice(&node[d..2 * d]);
        }
        for ([a, b], bar) in self.edges.iter().zip(&bar.edges) {
            let distance = self.distance(state, [*a, *b]);
            let inverse = S::one() / distance.value;
            let pull = bar.times(&distance.chain(inverse, -inverse * inverse));
            for (i, along) in self.along(state, [*a, *b]).into_iter().enumerate() {
                let pull = pull.times(&along);
                state_bar[d * a + i] = state_bar[d * a + i].plus(&pull);
                state_bar[d * b + i] = state_bar[d * b + i].plus(&pull.scaled(-S::one()));
            }
        }
        state_bar
    }
}

/// The adjoint of (x, v, type) of every node and of the distance of every edge.
pub(super) struct InputsBar<S, const T: usize> {
    nodes: Vec<Values<S, T>>,
    edges: Values<S, T>,
}

/// A network with the end of its weights in the block.
pub(super) struct Placed<'w> {
    mlp: Mlp<'w, f64, MAX_WIDTH, DEPTH>,
    end: usize,
}

/// One use of a network: its inputs and outputs, with what the adjoint needs.
pub(super) struct Used<S, const T: usize> {
    x: Values<S, T>,
    tape: Tape<S, T, MAX_WIDTH, DEPTH>,
    /// Its outputs.
    pub y: Values<S, T>,
}

impl Placed<'_> {
    pub fn used<S: Scalar<Weight = f64>, const T: usize>(&self, x: Values<S, T>) -> Used<S, T> {
        let mut used = Used { x, tape: Tape::default(), y: vec![Jet::zero(); self.mlp.outputs()] };
        self.mlp.forward(&used.x, &mut used.tape, &mut used.y);
        used
    }

    /// x̄; visits every layer with its first weight's place in the block, its inputs and the adjoint of its outputs.
    pub fn adjoint<S: Scalar<Weight = f64>, const T: usize, const A: usize>(
        &self,
        used: &Used<S, T>,
        y_bar: &[Jet<S, A>],
        mut visit: impl FnMut(usize, &Dense<f64>, &[Jet<S, T>], &[Jet<S, A>]),
    ) -> Values<S, A> {
        let (mut start, mut x_bar) = (self.end, vec![Jet::zero(); used.x.len()]);
        self.mlp.adjoint_with_layers(&used.tape, (&used.x, &mut x_bar), y_bar, |layer, x, bar| {
            start -= layer.len();
            visit(start, layer, x, bar);
        });
        x_bar
    }

    /// x̄; adds the second derivatives of ȳ·y along every pair of directions, the inputs moving along straight lines.
    pub fn bend<S: Scalar<Weight = f64>, const T: usize>(
        &self,
        used: &Used<S, T>,
        y_bar: &[Jet<S, 0>],
        sum: &mut [[S; T]; T],
    ) -> Values<S, 0> {
        let (mut x_bar, mut y) = (vec![Jet::zero(); used.x.len()], used.y.clone());
        let mut bends = SecondOrderTape::<S, T, MAX_WIDTH, DEPTH>::default();
        self.mlp.forward_second_order(&used.x, &mut bends, &mut y);
        let bent = self.mlp.second_order(&bends, y_bar, &mut x_bar);
        sum.as_flattened_mut().iter_mut().zip(bent.as_flattened()).for_each(|(sum, bent)| *sum += *bent);
        x_bar
    }
}

/// All networks over one weight block.
pub(super) struct Networks<'w> {
    edge_embedding: Placed<'w>,
    node_embedding: Placed<'w>,
    edge: Placed<'w>,
    node: Placed<'w>,
    /// From what stands for nodes after the messages to what is asked for.
    pub read_out: Placed<'w>,
}

/// What a forward pass leaves for the adjoint: every use of every network, by edge or node.
pub(super) struct Trace<S, const T: usize> {
    embedded_edges: Vec<Used<S, T>>,
    embedded_nodes: Vec<Used<S, T>>,
    edges: Vec<Used<S, T>>,
    /// What stands for the nodes after the messages.
    pub nodes: Vec<Used<S, T>>,
}

impl<'w> Networks<'w> {
    /// From the front of a block, read out to so many numbers; `None` where it is too short.
    pub fn take(sizes: GraphSizes, outputs: usize, weights: &'w [f64]) -> Option<Self> {
        let (mut rest, widths) = (weights, [sizes.hidden; DEPTH]);
        let mut place = |[inputs, hidden, outputs]: [usize; 3]| {
            let mlp = Mlp::take(&mut rest, inputs, widths.get(..hidden)?, outputs, Activation::Squareplus)?;
            Some(Placed { mlp, end: weights.len() - rest.len() })
        };
        let [edge_embedding, node_embedding, edge, node, read_out] = sizes.networks(outputs);
        Some(Self {
            edge_embedding: place(edge_embedding)?,
            node_embedding: place(node_embedding)?,
            edge: place(edge)?,
            node: place(node)?,
            read_out: place(read_out)?,
        })
    }

    /// The messages at a state (q, v).
    pub fn messages<S: Scalar<Weight = f64>, const T: usize>(
        &self,
        wiring: &Wiring,
        state: &[Jet<S, T>],
    ) -> Trace<S, T> {
        let embedded_nodes: Vec<_> = wiring.of_nodes(state).map(|x| self.node_embedding.used(x)).collect();
        let embed = |ends: &[usize; 2]| self.edge_embedding.used(vec![wiring.distance(state, *ends)]);
        let embedded_edges: Vec<_> = wiring.edges.iter().map(embed).collect();
        let message = |(e, [from, to]): (&Used<S, T>, &[usize; 2])| {
            self.edge.used([&*e.y, &embedded_nodes[*from].y, &embedded_nodes[*to].y].concat())
        };
        let edges: Vec<_> = embedded_edges.iter().zip(&wiring.edges).map(message).collect();
        let sums = self.sums(wiring, &edges).into_iter().zip(&embedded_nodes);
        let nodes = sums.map(|(sums, h)| self.node.used([&*h.y, &sums].concat())).collect();
        Trace { embedded_edges, embedded_nodes, edges, nodes }
    }

    /// Of every node what it has sent and what it has received, added up.
    fn sums<S: Scalar<Weight = f64>, const T: usize>(
        &self,
        wiring: &Wiring,
        edges: &[Used<S, T>],
    ) -> Vec<Values<S, T>> {
        let size = self.edge.mlp.outputs();
        let mut sums = vec![vec![Jet::zero(); 2 * size]; wiring.nodes()];
        for (edge, [from, to]) in edges.iter().zip(&wiring.edges) {
            add(&mut sums[*from][..size], &edge.y);
            add(&mut sums[*to][size..], &edge.y);
        }
        sums
    }

    /// Carries the adjoint of the nodes down to that of the inputs; `back` takes it through one use of a network.
    pub fn messages_adjoint<S: Scalar<Weight = f64>, const T: usize, const A: usize>(
        &self,
        wiring: &Wiring,
        trace: &Trace<S, T>,
        nodes_bar: impl Iterator<Item = Values<S, A>>,
        mut back: impl FnMut(&Placed<'w>, &Used<S, T>, &[Jet<S, A>]) -> Values<S, A>,
    ) -> InputsBar<S, A> {
        let (size, width) = (self.node_embedding.mlp.outputs(), self.edge.mlp.outputs());
        let mut nodes_bar: Vec<_> =
            trace.nodes.iter().zip(nodes_bar).map(|(node, bar)| back(&self.node, node, &bar)).collect();
        let mut edges_bar = Vec::with_capacity(wiring.edges.len());
        for ((edge, embedded), [from, to]) in trace.edges.iter().zip(&trace.embedded_edges).zip(&wiring.edges)
        {
            let mut edge_bar = nodes_bar[*from][size..size + width].to_vec();
            add(&mut edge_bar, &nodes_bar[*to][size + width..]);
            let bar = back(&self.edge, edge, &edge_bar);
            add(&mut nodes_bar[*from][..size], &bar[width..width + size]);
            add(&mut nodes_bar[*to][..size], &bar[width + size..]);
            edges_bar.extend(back(&self.edge_embedding, embedded, &bar[..width]));
        }
        let embedded = trace.embedded_nodes.iter().zip(&nodes_bar);
        let nodes = embedded.map(|(embedded, bar)| back(&self.node_embedding, embedded, &bar[..size]));
        InputsBar { nodes: nodes.collect(), edges: edges_bar }
    }
}

/// Adds numbers one by one.
pub(super) fn add<S: Scalar, const T: usize>(sum: &mut [Jet<S, T>], terms: &[Jet<S, T>]) {
    sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum = sum.plus(term));
}
