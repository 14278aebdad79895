//! Derivatives in the weights, for training.

use super::fixed::{Fixed, vectors};
use super::radial::square;
use super::round::{Batch, MovingNodes};
use super::shape::{Drag, Kinetic, MAX_EMBEDDING, MAX_NODE_TYPES, Potential};
use super::types::{Types, inputs, sign};
use super::{Edge, across};
use crate::energy::placed_network::{PlacedNetwork, WeightTangents};
use crate::energy::{Learnable, LearnableForces};
use crate::expected::present;
use crate::linear::dot;
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};

impl<S: Scalar, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize>
    Learnable<S, N> for Fixed<'_, S::Weight, D, K, H, L, N>
{
    /// L_v·δv = Σ 2T′ v·δv.
    fn directional_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        (dq, dv): (&[S; N], &[S; N]),
        mut row: impl FnMut(usize, S),
    ) {
        self.potential_part(q, dq, &mut row);
        for ((kind, v), dv) in self.nodes(v).zip(vectors(dv)) {
            let along = dot(v, dv);
            self.graph.types.kinetic_gradient(kind, v, [along + along, S::zero()], &mut row);
        }
    }

    /// L_vq = 0 and y·L_vv a = Σ 2T′ y·a + 4T″ (v·y)(v·a).
    fn residual_gradient(
        &self,
        (q, v): (&[S; N], &[S; N]),
        a: &[S; N],
        y: &[S; N],
        mut row: impl FnMut(usize, S),
    ) {
        self.potential_part(q, y, &mut row);
        for (((kind, v), a), y) in self.nodes(v).zip(vectors(a)).zip(vectors(y)) {
            let second = S::constant(-4.0) * dot(v, y) * dot(v, a);
            self.graph.types.kinetic_gradient(kind, v, [S::constant(-2.0) * dot(y, a), second], &mut row);
        }
    }
}

impl<S: Scalar, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize>
    LearnableForces<S, N> for Fixed<'_, S::Weight, D, K, H, L, N>
{
    fn force_gradient(&self, (_, v): (&[S; N], &[S; N]), y: &[S; N], mut row: impl FnMut(usize, S)) {
        for ((kind, v), y) in self.nodes(v).zip(vectors::<_, D, N>(y)) {
            for (v, y) in v.iter().zip(y) {
                self.graph.types.drag_gradient(kind, *v, *y, &mut row);
            }
        }
    }
}

impl<W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize>
    Fixed<'_, W, D, K, H, L, N>
{
    /// −∂/∂θ of V_q·δq.
    fn potential_part<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        dq: &[S; N],
        row: &mut impl FnMut(usize, S),
    ) {
        for ((kind, x), dx) in self.nodes(q).zip(vectors(dq)) {
            self.graph.types.potential_gradient(kind, x, dx, row);
        }
        for (edge, d) in self.edges(q) {
            let Some(dd) = present(across(vectors(dq), edge)) else { continue };
            self.graph.types.pair_gradient(edge.kind, &d, S::constant(-2.0) * dot(&d, &dd), row);
        }
        self.message_part(q, dq, row);
    }

    fn message_part<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        dq: &[S; N],
        row: &mut impl FnMut(usize, S),
    ) {
        if self.graph.messaging().is_none() {
            return;
        }
        let mut x = [[Jet::zero(); D]; N];
        for ((slot, x), dx) in x.iter_mut().zip(vectors(q)).zip(vectors(dq)) {
            *slot = Jet::moving(x, dx);
        }
        // The sums of what nodes of one type have.
        let mut rates = [[S::zero(); MAX_EMBEDDING]; MAX_NODE_TYPES];
        let mut embedding = |node: usize, k: usize, bar: &Jet<S, 1>| {
            let kind = usize::from(self.graph.kind(node));
            if let Some(slot) = rates.get_mut(kind).and_then(|rates| rates.get_mut(k)) {
                *slot += bar.rate();
            }
        };
        let mut states = MovingNodes::new(&x);
        let sender =
            |edges: &[Edge], end: usize, k: usize, bar: &Jet<S, 1>| embedding(edges.node(end, 0), k, bar);
        self.graph.round(&mut states, &mut WeightTangents(|i, rate: S| row(i, -rate)), |_, _| {}, sender);
        for (i, bar) in states.adjoints().enumerate().take(self.graph.nodes.len()) {
            bar.iter().enumerate().for_each(|(k, bar)| embedding(i, k, bar));
        }
        for (kind, rates) in (0..).zip(rates.iter().take(self.graph.types.shape().nodes.len())) {
            let Some(numbers) = self.graph.types.numbers(kind) else { return };
            for (k, (rate, _)) in rates.iter().zip(numbers.embedding.1).enumerate() {
                row(numbers.embedding.0 + k, -*rate);
            }
        }
    }
}

impl<W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Types<'_, W, D, K, H, L>
{
    /// Visits c₁ ∂T′/∂θ + c₂ ∂T″/∂θ, derivatives of T in |v|².
    fn kinetic_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        kind: u8,
        v: &[S; D],
        c: [S; 2],
        row: &mut impl FnMut(usize, S),
    ) {
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return };
        match node.kinetic {
            Kinetic::Mass => row(numbers.mass.0, c[0].half()),
            Kinetic::Network(network) => {
                let Some(network) = self.network(network) else { return };
                let (start, embedding) = numbers.kinetic_embedding;
                let x = inputs(embedding, &[Jet::parameter(square(v))]);
                let mut x_bar = x.clone();
                let y_bar = [Jet { value: S::zero(), tangent: c }];
                network.series_gradient::<S>((&x, &mut x_bar), &y_bar, row);
                for (k, (bar, _)) in x_bar.iter().zip(embedding).enumerate() {
                    row(start + k, bar.value);
                }
            }
        }
    }

    /// Visits −∂/∂θ of V_x·δx.
    fn potential_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        kind: u8,
        x: &[S; D],
        dx: &[S; D],
        row: &mut impl FnMut(usize, S),
    ) {
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return };
        if node.potential != Potential::None {
            dx.iter().enumerate().for_each(|(k, dx)| row(numbers.field.0 + k, -*dx));
        }
        let mut embedding = [S::zero(); MAX_EMBEDDING];
        self.pull(kind, &Jet::moving(x, dx), &mut WeightTangents(|i, rate: S| row(i, -rate)), |k, bar| {
            if let Some(slot) = embedding.get_mut(k) {
                *slot = bar.rate();
            }
        });
        for (k, (rate, _)) in embedding.iter().zip(numbers.embedding.1).enumerate() {
            row(numbers.embedding.0 + k, -*rate);
        }
    }

    /// Visits c ∂U′/∂θ, the derivative of U in |d|².
    fn pair_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        kind: u8,
        d: &[S; D],
        c: S,
        row: &mut impl FnMut(usize, S),
    ) {
        let (Some(edge), Some((start, _))) = (self.edge_type(kind), self.law(kind)) else { return };
        let z: Jet<S, 2> = edge.separation.feature().of_square(square(d));
        let linear = c * z.tangent[0];
        row(start, linear);
        row(start + 1, (linear + linear) * z.value);
        let Some(network) = edge.potential.and_then(|network| self.network(network)) else { return };
        let y_bar = [Jet { value: S::zero(), tangent: [c, S::zero()] }];
        network.series_gradient::<S>((&[z], &mut []), &y_bar, row);
    }

    /// Visits y ∂Q/∂θ of a node along one axis.
    fn drag_gradient<S: Scalar<Weight = W::Wide>>(
        &self,
        kind: u8,
        v: S,
        y: S,
        row: &mut impl FnMut(usize, S),
    ) {
        let (Some(node), Some(numbers)) = (self.node_type(kind), self.numbers(kind)) else { return };
        if node.drag != Drag::None {
            row(numbers.drag.0, -(y * v));
        }
        if let Drag::Network(network) = node.drag
            && let Some(network) = self.network(network)
        {
            network.size_gradient::<S>(v, -(y * v), row);
        }
    }
}

impl<W: WeightFormat, const H: usize, const L: usize> PlacedNetwork<'_, W, H, L> {
    /// Visits c ∂|net(x)|/∂θ.
    fn size_gradient<S: Scalar<Weight = W::Wide>>(&self, x: S, c: S, row: &mut impl FnMut(usize, S)) {
        let side = sign(self.energy::<S>(&[Jet::constant(x)]));
        self.series_gradient::<S>((&[Jet::constant(x)], &mut []), &[Jet::constant(side * c)], row);
    }
}
