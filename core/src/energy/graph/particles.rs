//! Graphs of any size; several nodes or edges are evaluated at a time in the lanes of a scalar.

use super::round::{NodesAtRest, difference_in_lanes, packs, runs};
use super::{Edge, Graph, exchange};
use crate::expected::{expected, present};
use crate::lagrangian::Energies;
use crate::linear::Matrix;
use crate::network::Jet;
use crate::particles::Particles;
use crate::scalar::{Packed, WeightFormat};

impl<
    W: WeightFormat,
    R: Packed<Weight = W::Wide>,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
> Particles<R, D> for Graph<'_, W, D, K, H, L>
{
    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn workspace(&self) -> usize {
        self.types.shape().workspace(self.nodes.len())
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], workspace: &mut [R]) -> Energies<R> {
        let kinetic = self.sum_nodes(v, |kind, v| self.types.kinetic::<R::Pack, 0>(kind, v).value);
        Energies { kinetic, potential: self.potential(q, workspace) }
    }

    fn l_q(&self, q: &[[R; D]], workspace: &mut [R], l_q: &mut [[R; D]]) {
        let pull = |kind, x: &[R::Pack; D]| {
            let pull = self.types.pull::<R::Pack, 0>(kind, &x.map(Jet::constant));
            pull.map(|pull| -pull.value)
        };
        self.write_nodes(0, (q, &mut *l_q), pull, lane);
        self.for_edges(q, |run, kind, d| {
            add_forces::<R, D>(l_q, run, &self.types.pair::<R::Pack, 1>(kind, &d).gradient(&d));
        });
        self.messages(q, workspace, |run, gradient| add_forces::<R, D>(l_q, run, &gradient));
    }

    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.types.kinetic::<R, 1>(self.kind(node), v).gradient(v)
    }

    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D] {
        self.types.kinetic::<R, 2>(self.kind(node), v).hessian(v)
    }

    fn drag(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.types.drags(self.kind(node), v)[0]
    }

    fn drag_slope(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.types.drags(self.kind(node), v)[1]
    }

    fn momenta(&self, first: usize, v: &[[R; D]], l_v: &mut [[R; D]]) {
        let momentum = |kind, v: &[R::Pack; D]| self.types.kinetic::<R::Pack, 1>(kind, v).gradient(v);
        self.write_nodes(first, (v, l_v), momentum, lane);
    }

    fn masses(&self, first: usize, v: &[[R; D]], masses: &mut [Matrix<R, D>]) {
        let mass = |kind, v: &[R::Pack; D]| self.types.kinetic::<R::Pack, 2>(kind, v).hessian(v);
        self.write_nodes(first, (v, masses), mass, matrix);
    }

    fn drags(&self, first: usize, v: &[[R; D]], drags: &mut [[R; D]]) {
        self.write_nodes(first, (v, drags), |kind, v| self.types.drags(kind, v)[0], lane);
    }

    fn drag_slopes(&self, first: usize, v: &[[R; D]], slopes: &mut [[R; D]]) {
        self.write_nodes(first, (v, slopes), |kind, v| self.types.drags(kind, v)[1], lane);
    }
}

/// One lane of a pack of matrices.
#[inline(always)]
fn matrix<R: Packed, const D: usize>(x: &Matrix<R::Pack, D>, at: usize) -> Matrix<R, D> {
    let mut one = [[R::zero(); D]; D];
    one.iter_mut().zip(x).for_each(|(one, row)| *one = lane(row, at));
    one
}

/// One lane of a pack of vectors.
#[inline(always)]
fn lane<R: Packed, const D: usize>(x: &[R::Pack; D], lane: usize) -> [R; D] {
    let mut one = [R::zero(); D];
    one.iter_mut().zip(x).for_each(|(one, x)| *one = R::lane(x, lane));
    one
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Graph<'a, W, D, K, H, L>
{
    /// Visits runs of neighbouring nodes of one type, starting at node `first`, with their type and vectors of `x`.
    #[inline(always)]
    fn for_nodes<R: Packed<Weight = W::Wide>>(
        &self,
        first: usize,
        mut x: &[[R; D]],
        mut visit: impl FnMut(&[u8], u8, [R::Pack; D]),
    ) {
        let nodes = expected(self.nodes.get(first..), &[]);
        let nodes = expected(nodes.get(..x.len()), nodes);
        for (kind, run) in runs(nodes, |kind| *kind, R::WIDTH) {
            let Some((own, rest)) = present(x.split_at_checked(run.len())) else { return };
            x = rest;
            let Some(first) = own.first() else { return };
            visit(run, kind, packs(|l| *own.get(l).unwrap_or(first)));
        }
    }

    /// Applies `of` to types and vectors of neighbouring nodes, starting at node `first`, and writes one `lane` of the result per node.
    #[inline(always)]
    fn write_nodes<R: Packed<Weight = W::Wide>, P, T>(
        &self,
        first: usize,
        (x, to): (&[[R; D]], &mut [T]),
        of: impl Fn(u8, &[R::Pack; D]) -> P,
        lane: impl Fn(&P, usize) -> T,
    ) {
        let mut slots = to.iter_mut();
        self.for_nodes(first, x, |run, kind, x| {
            let packed = of(kind, &x);
            (0..run.len()).zip(slots.by_ref()).for_each(|(l, slot)| *slot = lane(&packed, l));
        });
    }

    /// Visits runs of neighbouring edges of one type, with their type and x_a − x_b between their ends.
    #[inline(always)]
    fn for_edges<R: Packed<Weight = W::Wide>>(
        &self,
        q: &[[R; D]],
        mut visit: impl FnMut(&[Edge], u8, [R::Pack; D]),
    ) {
        for (kind, run) in self.edge_runs(R::WIDTH) {
            visit(run, kind, difference_in_lanes(q, run));
        }
    }

    /// Potential V(q).
    pub(super) fn potential<R: Packed<Weight = W::Wide>>(&self, q: &[[R; D]], workspace: &mut [R]) -> R {
        let mut potential = self.sum_nodes(q, |kind, q| self.types.potential(kind, q));
        self.for_edges(q, |run, kind, d| {
            let pairs = self.types.pair::<R::Pack, 0>(kind, &d).value;
            (0..run.len()).for_each(|l| potential += R::lane(&pairs, l));
        });
        potential += self.messages(q, workspace, |_, _| {});
        potential
    }

    /// Potential V of the messages. `gradient` receives ∂V/∂(x_a − x_b) of edges in lanes, in parts that add
    /// up.
    fn messages<R: Packed<Weight = W::Wide>>(
        &self,
        q: &[[R; D]],
        workspace: &mut [R],
        mut gradient: impl FnMut(&[Edge], [R::Pack; D]),
    ) -> R {
        let mut states = NodesAtRest { q, workspace, width: self.types.shape().embedding.into() };
        let gradient = |edges: &[Edge], of: [Jet<R::Pack, 0>; D]| gradient(edges, of.map(|of| of.value));
        self.round(&mut states, gradient)
    }

    #[inline(always)]
    fn sum_nodes<R: Packed<Weight = W::Wide>>(
        &self,
        x: &[[R; D]],
        of: impl Fn(u8, &[R::Pack; D]) -> R::Pack,
    ) -> R {
        let mut sum = R::zero();
        self.for_nodes(0, x, |run, kind, x| {
            let terms = of(kind, &x);
            (0..run.len()).for_each(|l| sum += R::lane(&terms, l));
        });
        sum
    }
}

/// Subtracts ∂V/∂(x_a − x_b) of edges from l_q of their first ends, and adds it to l_q of their second ends.
#[inline(always)]
fn add_forces<R: Packed, const D: usize>(l_q: &mut [[R; D]], run: &[Edge], gradient: &[R::Pack; D]) {
    for (l, edge) in run.iter().enumerate() {
        exchange(l_q, edge, &lane(gradient, l).map(|gradient: R| -gradient));
    }
}
