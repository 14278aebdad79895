//! Messages (LGNN): every node sums the messages of its edges, every edge is updated by both of its nodes, and nodes and edges then have a
//! potential.
//!
//! A round takes four passes: (1) [`Messaging::send`] sums n at every node; (2) [`Messaging::settle`] and (3) [`Messaging::update`] give
//! the energies of nodes and edges and sum n̄ = ∂V/∂n; (4) [`Messaging::answer`] carries n̄ back to the distances. This file has the work
//! of each pass on one batch of edges or nodes; [`round`](super::round) has the passes.

use super::Edge;
use super::round::{Batch, NodeQuantity, NodeStates};
use super::shape::{MAX_EMBEDDING, MessageShape};
use super::types::{Inputs, Types};
use crate::energy::distance::DistanceFeature;
use crate::expected::expected;
use crate::network::{Jet, Mlp};
use crate::scalar::{Scalar, WeightFormat};
use heapless::Vec;

/// The embedding of a node or edge.
pub(super) type Embedding<S, const T: usize> = Vec<Jet<S, T>, MAX_EMBEDDING>;

/// The networks of the messages, and the type of every node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Messaging<'t, 'a, W, const D: usize, const K: usize, const H: usize, const L: usize> {
    types: &'t Types<'a, W, D, K, H, L>,
    shape: MessageShape,
    nodes: &'a [u8],
}

impl<'t, 'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Messaging<'t, 'a, W, D, K, H, L>
{
    /// Messages between nodes of the given types, if the model has messages.
    pub fn new(types: &'t Types<'a, W, D, K, H, L>, nodes: &'a [u8]) -> Option<Self> {
        Some(Self { types, shape: types.shape().messages?, nodes })
    }

    /// Length of a node's embedding.
    pub fn width(&self) -> usize {
        self.types.shape().embedding.into()
    }

    /// Whether there is only one node type, so an edge sends the same message to both of its ends.
    fn alike(&self) -> bool {
        self.types.shape().nodes.len() == 1
    }

    fn part(&self, network: u8) -> Option<&'t Mlp<'a, W, H, L>> {
        self.types.network(network)
    }

    /// Network f_b of an edge type, and its number of outputs.
    fn embed(&self, kind: u8) -> Option<(&'t Mlp<'a, W, H, L>, usize)> {
        let network = self.part(self.types.edge_type(kind)?.embedding?)?;
        Some((network, network.outputs()))
    }

    /// Feature z of d that the networks of an edge type see, and (∂z/∂r)/r.
    pub fn feature<S: Scalar, const T: usize>(&self, kind: u8, d: &[Jet<S, T>; D]) -> [Jet<S, T>; 2] {
        let feature = expected(
            self.types.edge_type(kind).map(|edge| edge.separation.feature()),
            DistanceFeature::Squared,
        );
        feature.of_difference(d)
    }

    /// Adds messages at both ends: n_i += f_v(h_j ‖ e).
    pub fn send<S: Scalar<Weight = W::Wide>, const T: usize, M: NodeStates<S, T, D>>(
        &self,
        kind: u8,
        feature: Jet<S, T>,
        edges: &[Edge],
        states: &mut M,
    ) -> Option<()> {
        let ((embed, width), message) = (self.embed(kind)?, self.part(self.shape.message)?);
        let mut e = zeros(width);
        embed.evaluate::<S, T>(&[feature], &mut e);
        let from = |from| {
            let mut sent = zeros(self.width());
            message.evaluate::<S, T>(&self.message_inputs::<S, T, M>(edges, from, &e), &mut sent);
            sent
        };
        let of_first = from(0);
        let sent = [if self.alike() { of_first.clone() } else { from(1) }, of_first];
        states.add(NodeQuantity::Sum, edges, &sent);
        Some(())
    }

    /// Computes f₂(n) of a node, and adds its gradient to n̄.
    pub fn settle<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        nodes: impl Batch,
        states: &mut impl NodeStates<S, T, D>,
    ) -> Option<Jet<S, T>> {
        let potential = self.part(self.shape.node_potential?)?;
        let n = self.read(NodeQuantity::Sum, nodes, 0, states);
        let (mut bar, mut v) = (n.clone(), [Jet::zero(); 1]);
        potential.pull_back_apart(&n, &mut bar, &mut v, |_| [Jet::constant(S::one())]);
        states.add(NodeQuantity::Adjoint, nodes, &[bar]);
        let [v] = v;
        Some(v)
    }

    /// Computes 2f₁(e′) of an edge, and its derivative in the feature at constant n; adds its gradient in n to n̄.
    pub fn update<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        kind: u8,
        feature: Jet<S, T>,
        edges: &[Edge],
        states: &mut impl NodeStates<S, T, D>,
    ) -> Option<[Jet<S, T>; 2]> {
        let potential = self.part(self.shape.edge_potential?)?;
        let ((embed, width), update) = (self.embed(kind)?, self.part(self.shape.update)?);
        let [a, b] = [0, 1].map(|end| self.read(NodeQuantity::Sum, edges, end, states));
        let product = times(&a, &b);
        let (mut product_bar, mut v, mut feature_bar) = (product.clone(), [Jet::zero(); 1], [Jet::zero(); 1]);
        let (e, change) = (&mut zeros(width), &mut zeros(width));
        embed.pull_back_apart(&[feature], &mut feature_bar, e, |e| {
            let mut bar = zeros(width);
            update.pull_back_apart(&product, &mut product_bar, change, |change| {
                let updated = plus(e, change);
                potential.pull_back_apart(&updated, &mut bar, &mut v, |_| [Jet::constant(S::constant(2.0))]);
                bar.clone()
            });
            bar
        });
        states.add(NodeQuantity::Adjoint, edges, &[times(&product_bar, &b), times(&product_bar, &a)]);
        let ([v], [feature_bar]) = (v, feature_bar);
        Some([v.plus(&v), feature_bar])
    }

    /// Computes the derivative in the feature through the messages that an edge sends.
    pub fn answer<S: Scalar<Weight = W::Wide>, const T: usize, M: NodeStates<S, T, D>>(
        &self,
        kind: u8,
        feature: Jet<S, T>,
        edges: &[Edge],
        states: &M,
    ) -> Option<Jet<S, T>> {
        let ((embed, width), message) = (self.embed(kind)?, self.part(self.shape.message)?);
        let mut feature_bar = [Jet::zero(); 1];
        let e = &mut zeros(width);
        embed.pull_back_apart(&[feature], &mut feature_bar, e, |e| {
            let mut e_bar = zeros(width);
            let [a, b] = [0, 1].map(|end| self.read(NodeQuantity::Adjoint, edges, end, states));
            let received =
                if self.alike() { [Some((0, plus(&a, &b))), None] } else { [Some((1, a)), Some((0, b))] };
            for (from, bar) in received.into_iter().flatten() {
                let x = self.message_inputs::<S, T, M>(edges, from, e);
                let (mut x_bar, mut sent) = (x.clone(), zeros::<S, T>(self.width()));
                message.pull_back_apart(&x, &mut x_bar, &mut sent, |_| bar);
                e_bar = plus(&e_bar, expected(x_bar.get(self.width()..), &[]));
            }
            e_bar
        });
        let [feature_bar] = feature_bar;
        Some(feature_bar)
    }

    /// Inputs h ‖ e of the message network, with h the embedding of the type of the node at end `from`.
    fn message_inputs<S: Scalar<Weight = W::Wide>, const T: usize, M: NodeStates<S, T, D>>(
        &self,
        edges: &[Edge],
        from: usize,
        e: &[Jet<S, T>],
    ) -> Inputs<S, T> {
        let kind = |lane| expected(self.nodes.get(edges.node(from, lane)).copied(), 0);
        let h = |k| Jet::constant(M::pack(|lane| self.types.embedding(kind(lane), k)));
        collected((0..self.width()).map(h).chain(e.iter().copied()))
    }

    /// Reads all numbers of a quantity at one end.
    fn read<S: Scalar, const T: usize>(
        &self,
        quantity: NodeQuantity,
        batch: impl Batch,
        end: usize,
        states: &impl NodeStates<S, T, D>,
    ) -> Embedding<S, T> {
        collected((0..self.width()).map(|k| states.get(quantity, batch, end, k)))
    }
}

fn zeros<S: Scalar, const T: usize>(width: usize) -> Embedding<S, T> {
    collected((0..width).map(|_| Jet::zero()))
}

fn plus<S: Scalar, const T: usize>(a: &[Jet<S, T>], b: &[Jet<S, T>]) -> Embedding<S, T> {
    collected(a.iter().zip(b).map(|(a, b)| a.plus(b)))
}

fn times<S: Scalar, const T: usize>(a: &[Jet<S, T>], b: &[Jet<S, T>]) -> Embedding<S, T> {
    collected(a.iter().zip(b).map(|(a, b)| a.times(b)))
}

/// Collects at most N jets; no embedding and no input is longer.
pub(super) fn collected<S: Scalar, const T: usize, const N: usize>(
    from: impl Iterator<Item = Jet<S, T>>,
) -> Vec<Jet<S, T>, N> {
    let mut to = Vec::new();
    for x in from {
        let pushed = to.push(x);
        debug_assert!(pushed.is_ok(), "more than {N} numbers");
    }
    to
}
