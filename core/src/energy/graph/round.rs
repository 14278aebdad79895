//! The round of messages in a graph of a number of coordinates that is compiled in, with tangents.

use super::fixed::Fixed;
use super::messages::{Embedding, Ends, Kept};
use super::shape::MAX_EMBEDDING;
use super::{Edge, Graph};
use crate::energy::placed_network::Visit;
use crate::network::Jet;
use crate::scalar::{Scalar, Stored};

/// n and n̄ of every node; there are at most N of them.
type Table<S, const T: usize, const N: usize> = [[[Jet<S, T>; MAX_EMBEDDING]; 2]; N];

/// An edge, or a node alone, among what is kept.
struct Lone<'t, 'a, W, S, const T: usize, const D: usize, const K: usize, const H: usize, const L: usize> {
    graph: &'t Graph<'a, W, D, K, H, L>,
    table: &'t mut [[[Jet<S, T>; MAX_EMBEDDING]; 2]],
    nodes: [usize; 2],
}

impl<
    W: Stored,
    S: Scalar<Weight = W::Wide>,
    const T: usize,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
> Ends<S, T> for Lone<'_, '_, W, S, T, D, K, H, L>
{
    fn embedding(&self, end: usize, k: usize) -> S {
        self.nodes.get(end).map_or(S::zero(), |node| self.graph.types.embedding(self.graph.kind(*node), k))
    }

    fn get(&self, kept: Kept, end: usize, k: usize) -> Jet<S, T> {
        let node = self.nodes.get(end).and_then(|node| self.table.get(*node));
        node.and_then(|node| node[kept as usize].get(k)).copied().unwrap_or(Jet::zero())
    }

    fn add(&mut self, kept: Kept, x: &[Embedding<S, T>]) {
        for (node, x) in self.nodes.iter().zip(x) {
            let Some(node) = self.table.get_mut(*node) else { continue };
            for (slot, x) in node[kept as usize].iter_mut().zip(x) {
                *slot = slot.plus(x);
            }
        }
    }
}

impl<W: Stored, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize>
    Fixed<'_, W, D, K, H, L, N>
{
    /// V of the messages where every node moves; `add` gets its gradient in the differences of edges, and `embedding(i, k, ·)`
    /// that in number k of the embedding of node i's type, in parts.
    pub(super) fn messages<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[[Jet<S, T>; D]; N],
        visit: &mut impl Visit<W, S, T>,
        mut add: impl FnMut(&Edge, [Jet<S, T>; D]),
        mut embedding: impl FnMut(usize, usize, &Jet<S, T>),
    ) -> Jet<S, T> {
        let (mut sum, graph) = (Jet::zero(), &self.graph);
        let Some(messaging) = graph.types.messaging() else { return sum };
        let mut table = self.begin::<S, T>();
        for (edge, d) in self.moving(x) {
            let [feature, _] = messaging.feature(edge.kind, &d);
            messaging.send(edge.kind, feature, &mut lone(graph, &mut table, edge));
        }
        for i in 0..graph.nodes.len() {
            let mut node = Lone { graph, table: &mut table, nodes: [i; 2] };
            sum = messaging.settle(&mut node, visit).map_or(sum, |v| sum.plus(&v));
        }
        for (edge, d) in self.moving(x) {
            let ([feature, rate], ends) =
                (messaging.feature(edge.kind, &d), &mut lone(graph, &mut table, edge));
            let Some([v, bar]) = messaging.update(edge.kind, feature, ends, visit) else { continue };
            sum = sum.plus(&v);
            add(edge, d.map(|d| bar.times(&rate).times(&d)));
        }
        for (edge, d) in self.moving(x) {
            let ([feature, rate], ends) = (messaging.feature(edge.kind, &d), lone(graph, &mut table, edge));
            let sender = |end: usize, k: usize, bar: &Jet<S, T>| {
                embedding(ends.nodes.get(end).copied().unwrap_or(0), k, bar);
            };
            let Some(bar) = messaging.answer(edge.kind, feature, &ends, visit, sender) else { continue };
            add(edge, d.map(|d| bar.times(&rate).times(&d)));
        }
        for (i, [_, bar]) in table.iter().take(graph.nodes.len()).enumerate() {
            bar.iter().take(messaging.width()).enumerate().for_each(|(k, bar)| embedding(i, k, bar));
        }
        sum
    }

    /// n = h and n̄ = 0 at every node.
    fn begin<S: Scalar<Weight = W::Wide>, const T: usize>(&self) -> Table<S, T, N> {
        let mut table = [[[Jet::zero(); MAX_EMBEDDING]; 2]; N];
        for ([n, _], kind) in table.iter_mut().zip(self.graph.nodes) {
            for (k, n) in n.iter_mut().enumerate() {
                *n = Jet::constant(self.graph.types.embedding(*kind, k));
            }
        }
        table
    }

    /// The edges with what lies between their ends.
    fn moving<S: Scalar, const T: usize>(
        &self,
        x: &[[Jet<S, T>; D]; N],
    ) -> impl Iterator<Item = (&Edge, [Jet<S, T>; D])> {
        let minus = -S::one();
        self.graph.edges.iter().filter_map(move |edge| {
            let [a, b] = edge.ends.map(usize::from);
            let (a, b) = (x.get(a)?, x.get(b)?);
            Some((edge, core::array::from_fn(|i| a[i].plus(&b[i].scaled(minus)))))
        })
    }
}

fn lone<'t, 'a, W, S, const T: usize, const D: usize, const K: usize, const H: usize, const L: usize>(
    graph: &'t Graph<'a, W, D, K, H, L>,
    table: &'t mut [[[Jet<S, T>; MAX_EMBEDDING]; 2]],
    edge: &Edge,
) -> Lone<'t, 'a, W, S, T, D, K, H, L> {
    Lone { graph, table, nodes: edge.ends.map(usize::from) }
}
