//! One round of messages over a whole graph: the four passes over its nodes and edges. Nodes at rest are
//! evaluated side by side, moving nodes one by one.

use super::messages::{Embedding, Messaging};
use super::shape::MAX_EMBEDDING;
use super::{Edge, Graph, across};
use crate::expected::{expected, present};
use crate::network::Jet;
use crate::scalar::{Packed, Scalar, WeightFormat};
use core::iter;

/// A quantity of a node that is as long as an embedding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodeQuantity {
    /// n, the sum of the node's embedding and the messages to it.
    Sum,
    /// n̄ = ∂V/∂n.
    Adjoint,
}

/// Number of node quantities.
pub(super) const NODE_QUANTITIES: usize = 2;

/// A batch of edges of one type, or of nodes: one in each lane of a scalar.
pub(super) trait Batch: Copy {
    /// Number of used lanes, at least 1.
    fn lanes(self) -> usize;
    /// The node at an end of the edge in a lane; in a batch of nodes, every end is the node itself. Unused lanes repeat the first.
    fn node(self, end: usize, lane: usize) -> usize;
}

impl Batch for &[Edge] {
    #[inline(always)]
    fn lanes(self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn node(self, end: usize, lane: usize) -> usize {
        let edge = self.get(if lane < self.len() { lane } else { 0 });
        usize::from(expected(edge.and_then(|edge| edge.ends.get(end)).copied(), 0))
    }
}

/// A batch of neighbouring nodes.
#[derive(Clone, Copy, Debug)]
struct Neighbours {
    first: usize,
    count: usize,
}

impl Batch for Neighbours {
    #[inline(always)]
    fn lanes(self) -> usize {
        self.count
    }

    #[inline(always)]
    fn node(self, _: usize, lane: usize) -> usize {
        self.first + if lane < self.count { lane } else { 0 }
    }
}

/// Positions of a graph's nodes, and the quantities of every node during a round of messages.
pub(super) trait NodeStates<S: Scalar, const T: usize, const D: usize> {
    /// Type of one lane of `S`.
    type Lane: Scalar<Weight = S::Weight>;
    /// Number of lanes of `S`.
    const WIDTH: usize;

    /// The scalar with `lane(l)` in lane l.
    fn pack(lane: impl FnMut(usize) -> Self::Lane) -> S;
    /// One lane of a scalar.
    fn lane(x: &S, lane: usize) -> Self::Lane;
    /// Initializes n_i = h(i) and n̄_i = 0 at every node; h gives one number of a node at a time.
    fn begin(&mut self, nodes: usize, width: usize, h: impl Fn(usize, usize) -> Self::Lane);
    /// x_a − x_b between the edges' ends.
    fn difference(&self, edges: &[Edge]) -> [Jet<S, T>; D];
    /// Number k of a quantity at one end.
    fn get(&self, quantity: NodeQuantity, batch: impl Batch, end: usize, k: usize) -> Jet<S, T>;
    /// Adds to a quantity at every end: edge by edge, first end first.
    fn add(&mut self, quantity: NodeQuantity, batch: impl Batch, x: &[Embedding<S, T>]);
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Graph<'a, W, D, K, H, L>
{
    /// Maximum workspace length of any graph of at most `nodes` nodes, usable as an array length;
    /// [`Particles::workspace`](crate::particles::Particles::workspace) is the length for one graph.
    pub const fn most_workspace(nodes: usize) -> usize {
        NODE_QUANTITIES * MAX_EMBEDDING * nodes
    }

    /// Networks of the messages, if the model has messages.
    pub(super) fn messaging(&self) -> Option<Messaging<'_, 'a, W, D, K, H, L>> {
        Messaging::new(&self.types, self.nodes)
    }

    /// Potential V of the messages. `gradient` receives ∂V/∂(x_a − x_b) of edges, in parts that add up.
    pub(super) fn round<S: Scalar<Weight = W::Wide>, const T: usize, M: NodeStates<S, T, D>>(
        &self,
        states: &mut M,
        mut gradient: impl FnMut(&[Edge], [Jet<S, T>; D]),
    ) -> M::Lane {
        let mut sum = M::Lane::zero();
        let Some(messaging) = self.messaging() else { return sum };
        states.begin(self.nodes.len(), messaging.width(), |i, k| self.types.embedding(self.kind(i), k));
        for (kind, edges) in self.edge_runs(M::WIDTH) {
            let [feature, _] = messaging.feature(kind, &states.difference(edges));
            messaging.send(kind, feature, edges, states);
        }
        for first in (0..self.nodes.len()).step_by(M::WIDTH) {
            let batch = Neighbours { first, count: M::WIDTH.min(self.nodes.len() - first) };
            let Some(v) = messaging.settle(batch, states) else { break };
            (0..batch.count).for_each(|l| sum += M::lane(&v.value, l));
        }
        for (kind, edges) in self.edge_runs(M::WIDTH) {
            let d = states.difference(edges);
            let [feature, rate] = messaging.feature(kind, &d);
            let Some([v, bar]) = messaging.update(kind, feature, edges, states) else { break };
            (0..edges.len()).for_each(|l| sum += M::lane(&v.value, l));
            gradient(edges, d.map(|d| bar.times(&rate).times(&d)));
        }
        for (kind, edges) in self.edge_runs(M::WIDTH) {
            let d = states.difference(edges);
            let [feature, rate] = messaging.feature(kind, &d);
            let Some(bar) = messaging.answer(kind, feature, edges, states) else { break };
            gradient(edges, d.map(|d| bar.times(&rate).times(&d)));
        }
        sum
    }

    /// Runs of neighbouring edges of one type, with the type; at most `width` edges each.
    #[inline(always)]
    pub(super) fn edge_runs(
        &self,
        width: usize,
    ) -> impl Iterator<Item = (u8, &'a [Edge])> + use<'a, W, D, K, H, L> {
        runs(self.edges, |edge| edge.kind, width)
    }
}

/// Splits a list into its longest runs of at most `width` items of one kind; each run comes with its kind.
#[inline(always)]
pub(super) fn runs<T>(
    mut rest: &[T],
    kind: impl Fn(&T) -> u8,
    width: usize,
) -> impl Iterator<Item = (u8, &[T])> {
    iter::from_fn(move || {
        let first = kind(rest.first()?);
        let length = rest.iter().take(width).take_while(|item| kind(item) == first).count();
        let (run, after) = rest.split_at_checked(length)?;
        rest = after;
        Some((first, run))
    })
}

/// Nodes at rest at positions `q`, in lanes.
pub(super) struct NodesAtRest<'x, R, const D: usize> {
    /// The position of every node.
    pub q: &'x [[R; D]],
    /// All quantities of a node, node by node.
    pub workspace: &'x mut [R],
    /// Length of a quantity.
    pub width: usize,
}

impl<R: Packed, const D: usize> NodesAtRest<'_, R, D> {
    /// Index of number k of a node's quantity.
    fn place(&self, quantity: NodeQuantity, node: usize, k: usize) -> usize {
        (NODE_QUANTITIES * node + quantity as usize) * self.width + k
    }
}

impl<R: Packed, const D: usize> NodeStates<R::Pack, 0, D> for NodesAtRest<'_, R, D> {
    type Lane = R;
    const WIDTH: usize = R::WIDTH;

    #[inline(always)]
    fn pack(lane: impl FnMut(usize) -> R) -> R::Pack {
        R::pack(lane)
    }

    #[inline(always)]
    fn lane(x: &R::Pack, lane: usize) -> R {
        R::lane(x, lane)
    }

    fn begin(&mut self, nodes: usize, width: usize, h: impl Fn(usize, usize) -> R) {
        let mut slots = self.workspace.iter_mut();
        for node in 0..nodes {
            for (k, slot) in slots.by_ref().take(NODE_QUANTITIES * width).enumerate() {
                *slot = if k < width { h(node, k) } else { R::zero() };
            }
        }
    }

    #[inline(always)]
    fn difference(&self, edges: &[Edge]) -> [Jet<R::Pack, 0>; D] {
        difference_in_lanes(self.q, edges).map(Jet::constant)
    }

    fn get(&self, quantity: NodeQuantity, batch: impl Batch, end: usize, k: usize) -> Jet<R::Pack, 0> {
        let at = |lane| self.workspace.get(self.place(quantity, batch.node(end, lane), k)).copied();
        Jet::constant(R::pack(|lane| expected(at(lane), R::zero())))
    }

    fn add(&mut self, quantity: NodeQuantity, batch: impl Batch, x: &[Embedding<R::Pack, 0>]) {
        for lane in 0..batch.lanes() {
            for (end, x) in x.iter().enumerate() {
                let start = self.place(quantity, batch.node(end, lane), 0);
                for (k, x) in x.iter().enumerate() {
                    if let Some(slot) = present(self.workspace.get_mut(start + k)) {
                        *slot += R::lane(&x.value, lane);
                    }
                }
            }
        }
    }
}

/// x_a − x_b of edges, one edge per lane; unused lanes repeat the first.
#[inline(always)]
pub(super) fn difference_in_lanes<R: Packed, const D: usize>(q: &[[R; D]], edges: &[Edge]) -> [R::Pack; D] {
    let zero = [R::zero(); D];
    let edge = |lane: usize| edges.get(if lane < edges.len() { lane } else { 0 });
    packs(|lane| expected(edge(lane).and_then(|edge| across(q, edge)), zero))
}

/// Packs the vectors of all lanes, component by component.
#[inline(always)]
pub(super) fn packs<R: Packed, const D: usize>(lane: impl Fn(usize) -> [R; D]) -> [R::Pack; D] {
    let mut packs = [R::Pack::zero(); D];
    packs
        .iter_mut()
        .enumerate()
        .for_each(|(i, pack)| *pack = R::pack(|l| expected(lane(l).get(i).copied(), R::zero())));
    packs
}

/// At most N nodes that move along T directions, evaluated one by one.
pub(super) struct MovingNodes<'x, S, const T: usize, const D: usize, const N: usize> {
    x: &'x [[Jet<S, T>; D]; N],
    quantities: [[[Jet<S, T>; MAX_EMBEDDING]; NODE_QUANTITIES]; N],
}

impl<'x, S: Scalar, const T: usize, const D: usize, const N: usize> MovingNodes<'x, S, T, D, N> {
    /// Creates the nodes at x.
    pub fn new(x: &'x [[Jet<S, T>; D]; N]) -> Self {
        Self { x, quantities: [[[Jet::zero(); MAX_EMBEDDING]; NODE_QUANTITIES]; N] }
    }
}

impl<S: Scalar, const T: usize, const D: usize, const N: usize> NodeStates<S, T, D>
    for MovingNodes<'_, S, T, D, N>
{
    type Lane = S;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn pack(mut lane: impl FnMut(usize) -> S) -> S {
        lane(0)
    }

    #[inline(always)]
    fn lane(x: &S, _: usize) -> S {
        *x
    }

    fn begin(&mut self, nodes: usize, width: usize, h: impl Fn(usize, usize) -> S) {
        for (node, [sum, _]) in self.quantities.iter_mut().enumerate().take(nodes) {
            for (k, sum) in sum.iter_mut().enumerate().take(width) {
                *sum = Jet::constant(h(node, k));
            }
        }
    }

    fn difference(&self, edges: &[Edge]) -> [Jet<S, T>; D] {
        let [a, b] = [0, 1].map(|end| edges.node(end, 0));
        let [a, b] = [a, b].map(|node| expected(self.x.get(node).copied(), [Jet::zero(); D]));
        core::array::from_fn(|i| a[i].plus(&b[i].scaled(-S::one())))
    }

    fn get(&self, quantity: NodeQuantity, batch: impl Batch, end: usize, k: usize) -> Jet<S, T> {
        let node = self.quantities.get(batch.node(end, 0));
        expected(node.and_then(|node| node[quantity as usize].get(k)).copied(), Jet::zero())
    }

    fn add(&mut self, quantity: NodeQuantity, batch: impl Batch, x: &[Embedding<S, T>]) {
        for (end, x) in x.iter().enumerate() {
            let Some(node) = present(self.quantities.get_mut(batch.node(end, 0))) else { continue };
            for (slot, x) in node[quantity as usize].iter_mut().zip(x) {
                *slot = slot.plus(x);
            }
        }
    }
}
