//! Graphs with a compiled number of coordinates.

use super::round::MovingNodes;
use super::{Edge, Graph, GraphError, across, exchange};
use crate::forces::Forces;
use crate::lagrangian::{Energies, Gradient, Hessian, Lagrangian, Linearization};
use crate::linear::Matrix;
use crate::network::Jet;
use crate::scalar::{Scalar, WeightFormat};

/// A graph in N coordinates, node by node: N is the number of nodes times `D`.
///
/// A `Fixed` is also its own [`Forces`]: the drag on its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Fixed<'a, W, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize> {
    graph: Graph<'a, W, D, K, H, L>,
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize, const N: usize>
    Fixed<'a, W, D, K, H, L, N>
{
    /// Wraps a graph, which must have N coordinates.
    ///
    /// # Errors
    /// [`GraphError::Coordinates`] if the graph has a different number.
    pub fn new(graph: Graph<'a, W, D, K, H, L>) -> Result<Self, GraphError> {
        let found = graph.nodes.len() * D;
        if found == N { Ok(Self { graph }) } else { Err(GraphError::Coordinates { found, compiled: N }) }
    }

    /// The graph.
    pub fn graph(&self) -> &Graph<'a, W, D, K, H, L> {
        &self.graph
    }

    /// The type of every node, with the node's part of x.
    #[inline(always)]
    fn nodes<'x, S>(&self, x: &'x [S; N]) -> impl Iterator<Item = (u8, &'x [S; D])> {
        self.graph.nodes.iter().copied().zip(vectors(x))
    }

    /// The edges, each with x_a − x_b of its ends.
    #[inline(always)]
    fn edges<S: Scalar>(&self, q: &[S; N]) -> impl Iterator<Item = (&'a Edge, [S; D])> {
        self.graph.edges.iter().filter_map(|edge| Some((edge, across(vectors(q), edge)?)))
    }

    /// Applies `of` to each node's type and its part of x, in the order of the nodes.
    fn each<S: Scalar<Weight = W::Wide>>(&self, x: &[S; N], of: impl Fn(u8, &[S; D]) -> [S; D]) -> [S; N] {
        let mut y = [S::zero(); N];
        for (slot, (kind, x)) in y.as_chunks_mut::<D>().0.iter_mut().zip(self.nodes(x)) {
            *slot = of(kind, x);
        }
        y
    }

    fn l_q<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [S; N] {
        let types = &self.graph.types;
        let mut l_q =
            self.each(q, |kind, x| types.pull::<S, 0>(kind, &x.map(Jet::constant)).map(|pull| -pull.value));
        for (edge, d) in self.edges(q) {
            let force = types.pair::<S, 1>(edge.kind, &d).gradient(&d).map(|force| -force);
            exchange(l_q.as_chunks_mut().0, edge, &force);
        }
        let add = |edges: &[Edge], gradient: [Jet<S, 0>; D]| {
            let force = gradient.map(|gradient| -gradient.value);
            edges.iter().for_each(|edge| exchange(l_q.as_chunks_mut().0, edge, &force));
        };
        self.messages::<S, 0>(&placed(q), add);
        l_q
    }

    fn l_v<S: Scalar<Weight = W::Wide>>(&self, v: &[S; N]) -> [S; N] {
        self.each(v, |kind, v| self.graph.types.kinetic::<S, 1>(kind, v).gradient(v))
    }

    fn l_vv<S: Scalar<Weight = W::Wide>>(&self, v: &[S; N]) -> [[S; N]; N] {
        let mut mass = [[S::zero(); N]; N];
        for (i, (kind, v)) in self.nodes(v).enumerate() {
            let block = self.graph.types.kinetic::<S, 2>(kind, v).hessian(v);
            add_block(&mut mass, [i, i], &block);
        }
        mass
    }

    fn l_qq<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [[S; N]; N] {
        let mut l_qq = [[S::zero(); N]; N];
        for (i, (kind, x)) in self.nodes(q).enumerate() {
            let pull = self.graph.types.pull::<S, D>(kind, &Jet::along_axes(x, 0));
            add_block(&mut l_qq, [i, i], &pull.map(|pull| pull.tangent.map(|x| -x)));
        }
        for (edge, d) in self.edges(q) {
            let block = self.graph.types.pair::<S, 2>(edge.kind, &d).hessian(&d);
            let [a, b] = edge.ends.map(usize::from);
            add_block(&mut l_qq, [a, b], &block);
            add_block(&mut l_qq, [b, a], &block);
            let block = block.map(|row| row.map(|x| -x));
            add_block(&mut l_qq, [a, a], &block);
            add_block(&mut l_qq, [b, b], &block);
        }
        self.add_messages(q, &mut l_qq);
        l_qq
    }

    /// Potential V of the messages. `gradient` receives ∂V/∂(x_a − x_b) of one edge at a time, in parts that
    /// add up.
    fn messages<S: Scalar<Weight = W::Wide>, const T: usize>(
        &self,
        x: &[[Jet<S, T>; D]; N],
        gradient: impl FnMut(&[Edge], [Jet<S, T>; D]),
    ) -> S {
        self.graph.round(&mut MovingNodes::new(x), gradient)
    }

    /// Adds the messages' part of L_qq, one column of blocks at a time: the derivatives of the gradients with
    /// respect to the position of node j.
    fn add_messages<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N], l_qq: &mut [[S; N]; N]) {
        for j in 0..self.graph.nodes.len() {
            let mut x = placed::<S, D, D, N>(q);
            if let Some(x) = x.get_mut(j) {
                *x = Jet::along_axes(&x.map(|x| x.value), 0);
            }
            let add = |edges: &[Edge], gradient: [Jet<S, D>; D]| {
                let block = gradient.map(|gradient| gradient.tangent);
                for [a, b] in edges.iter().map(|edge| edge.ends.map(usize::from)) {
                    add_block(l_qq, [b, j], &block);
                    add_block(l_qq, [a, j], &block.map(|row| row.map(|x| -x)));
                }
            };
            self.messages::<S, D>(&x, add);
        }
    }
}

impl<
    W: WeightFormat,
    S: Scalar<Weight = W::Wide>,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
    const N: usize,
> Lagrangian<S, N> for Fixed<'_, W, D, K, H, L, N>
{
    fn energies(&self, q: &[S; N], v: &[S; N]) -> Energies<S> {
        let types = &self.graph.types;
        let (mut kinetic, mut potential) = (S::zero(), S::zero());
        self.nodes(v).for_each(|(kind, v)| kinetic += types.kinetic::<S, 0>(kind, v).value);
        self.nodes(q).for_each(|(kind, x)| potential += types.potential(kind, x));
        self.edges(q).for_each(|(edge, d)| potential += types.pair::<S, 0>(edge.kind, &d).value);
        potential += self.messages::<S, 0>(&placed(q), |_, _| {});
        Energies { kinetic, potential }
    }

    fn gradient(&self, q: &[S; N], v: &[S; N]) -> Gradient<S, N> {
        Gradient { l_q: self.l_q(q), l_v: self.l_v(v) }
    }

    fn linearization(&self, q: &[S; N], v: &[S; N]) -> Linearization<S, N> {
        Linearization { l_q: self.l_q(q), l_v: self.l_v(v), l_vq: [[S::zero(); N]; N], l_vv: self.l_vv(v) }
    }

    fn hessian(&self, q: &[S; N], v: &[S; N]) -> Hessian<S, N> {
        Hessian {
            l_q: self.l_q(q),
            l_v: self.l_v(v),
            l_qq: self.l_qq(q),
            l_vq: [[S::zero(); N]; N],
            l_vv: self.l_vv(v),
        }
    }
}

impl<
    W: WeightFormat,
    S: Scalar<Weight = W::Wide>,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
    const N: usize,
> Forces<S, N> for Fixed<'_, W, D, K, H, L, N>
{
    fn force(&self, _: &[S; N], v: &[S; N], _: &[S; N]) -> [S; N] {
        self.each(v, |kind, v| self.graph.types.drags(kind, v)[0])
    }

    fn derivatives(&self, _: &[S; N], v: &[S; N], _: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let slopes = self.each(v, |kind, v| self.graph.types.drags(kind, v)[1]);
        let mut q_v = [[S::zero(); N]; N];
        for (i, (row, slope)) in q_v.iter_mut().zip(slopes).enumerate() {
            row[i] = slope;
        }
        ([[S::zero(); N]; N], q_v)
    }

    fn load_derivative(&self, _: &[S; N], _: &[S; N], _: &[S; N]) -> Matrix<S, N> {
        [[S::zero(); N]; N]
    }
}

/// Splits x into one vector per node.
#[inline(always)]
fn vectors<S, const D: usize, const N: usize>(x: &[S; N]) -> &[[S; D]] {
    x.as_chunks().0
}

/// Nodes at q, constant along all T directions; entries after the last node are unused.
fn placed<S: Scalar, const T: usize, const D: usize, const N: usize>(q: &[S; N]) -> [[Jet<S, T>; D]; N] {
    let mut placed = [[Jet::zero(); D]; N];
    for (slot, x) in placed.iter_mut().zip(vectors::<S, D, N>(q)) {
        *slot = x.map(Jet::constant);
    }
    placed
}

/// Adds a block to the rows of node i and the columns of node j.
#[inline(always)]
fn add_block<S: Scalar, const D: usize, const N: usize>(
    matrix: &mut [[S; N]; N],
    [i, j]: [usize; 2],
    block: &[[S; D]; D],
) {
    for (row, add) in matrix.iter_mut().skip(i * D).zip(block) {
        for (entry, add) in row.iter_mut().skip(j * D).zip(add) {
            *entry += *add;
        }
    }
}
