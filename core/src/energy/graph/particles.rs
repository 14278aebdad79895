//! Graphs of any size, their nodes and edges in packs.

use super::messages::{Embedding, Ends, Kept, Messaging};
use super::{Edge, Graph, across, exchange};
use crate::energy::placed_network::Ignore;
use crate::lagrangian::Energies;
use crate::linear::Matrix;
use crate::network::Jet;
use crate::particles::Particles;
use crate::scalar::{Packed, Scalar, Stored};
use core::iter;

impl<W: Stored, R: Packed<Weight = W::Wide>, const D: usize, const K: usize, const H: usize, const L: usize>
    Particles<R, D> for Graph<'_, W, D, K, H, L>
{
    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn workspace(&self) -> usize {
        self.types.messaging().map_or(0, |messaging| KEPT * messaging.width() * self.nodes.len())
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], workspace: &mut [R]) -> Energies<R> {
        let kinetic = self.sum_nodes(v, |kind, v| self.types.kinetic::<R::Pack, 0>(kind, v).value);
        Energies { kinetic, potential: self.potential(q, workspace) }
    }

    fn l_q(&self, q: &[[R; D]], workspace: &mut [R], l_q: &mut [[R; D]]) {
        let pull = |kind, x: &[R::Pack; D]| {
            let pull = self.types.pull::<R::Pack, 0>(kind, &x.map(Jet::constant), &mut Ignore, |_, _| {});
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

impl<'a, W: Stored, const D: usize, const K: usize, const H: usize, const L: usize> Graph<'a, W, D, K, H, L> {
    /// Visits neighbouring nodes of one type, from `first` on, with their type and what `x` says of them.
    #[inline(always)]
    fn for_nodes<R: Packed<Weight = W::Wide>>(
        &self,
        first: usize,
        mut x: &[[R; D]],
        mut visit: impl FnMut(&[u8], u8, [R::Pack; D]),
    ) {
        let nodes = self.nodes.get(first..).unwrap_or_default();
        let nodes = nodes.get(..x.len()).unwrap_or(nodes);
        for run in runs(nodes, |kind| *kind, R::WIDTH) {
            let Some((own, rest)) = x.split_at_checked(run.len()) else { return };
            x = rest;
            let (Some(kind), Some(first)) = (run.first(), own.first()) else { return };
            visit(run, *kind, packs(|l| *own.get(l).unwrap_or(first)));
        }
    }

    /// Writes `of` every node's type and what `x` says of it, from node `first` on; `lane` takes what is written from a pack.
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

    /// Visits neighbouring edges of one type with their type and what lies between their ends.
    #[inline(always)]
    fn for_edges<R: Packed<Weight = W::Wide>>(
        &self,
        q: &[[R; D]],
        mut visit: impl FnMut(&[Edge], u8, [R::Pack; D]),
    ) {
        for run in runs(self.edges, |edge| edge.kind, R::WIDTH) {
            let Some(first) = run.first() else { return };
            let d = packs(|l| across(q, run.get(l).unwrap_or(first)).unwrap_or([R::zero(); D]));
            visit(run, first.kind, d);
        }
    }

    /// V(q).
    pub(super) fn potential<R: Packed<Weight = W::Wide>>(&self, q: &[[R; D]], workspace: &mut [R]) -> R {
        let mut potential = self.sum_nodes(q, |kind, q| self.types.potential(kind, q));
        self.for_edges(q, |run, kind, d| {
            let pairs = self.types.pair::<R::Pack, 0>(kind, &d).value;
            (0..run.len()).for_each(|l| potential += R::lane(&pairs, l));
        });
        potential += self.messages(q, workspace, |_, _| {});
        potential
    }

    /// n = h and n̄ = 0 at every node.
    fn begin<R: Packed<Weight = W::Wide>>(&self, workspace: &mut [R]) {
        let width = usize::from(self.types.shape().embedding);
        let mut slots = workspace.iter_mut();
        for kind in self.nodes {
            for (k, slot) in slots.by_ref().take(KEPT * width).enumerate() {
                *slot = if k < width { self.types.embedding(*kind, k) } else { R::zero() };
            }
        }
    }

    /// The ends of a pack of edges.
    #[allow(clippy::type_complexity, reason = "a pack and how it finds its nodes")]
    fn ends<'t, R: Packed<Weight = W::Wide>>(
        &'t self,
        workspace: &'t mut [R],
        run: &'t [Edge],
    ) -> PackEnds<'t, 'a, W, R, impl Fn(usize, usize) -> usize, D, K, H, L> {
        let node = move |end: usize, lane: usize| run.get(lane).and_then(|edge| edge.ends.get(end)).copied();
        let node = move |end, lane| usize::from(node(end, lane).unwrap_or(0));
        PackEnds { graph: self, workspace, lanes: run.len(), node }
    }

    /// V of the messages; `add` gets its gradient in the differences of a pack of edges.
    fn messages<R: Packed<Weight = W::Wide>>(
        &self,
        q: &[[R; D]],
        workspace: &mut [R],
        mut add: impl FnMut(&[Edge], [R::Pack; D]),
    ) -> R {
        let (mut sum, constant) = (R::zero(), |d: [R::Pack; D]| d.map(Jet::constant));
        let Some(messaging) = self.types.messaging() else { return sum };
        self.begin(workspace);
        self.for_edges(q, |run, kind, d| {
            let [feature, _] = messaging.feature::<_, 0>(kind, &constant(d));
            messaging.send(kind, feature, &mut self.ends(workspace, run));
        });
        sum += self.settle(&messaging, workspace);
        self.for_edges(q, |run, kind, d| {
            let [feature, rate] = messaging.feature(kind, &constant(d));
            let Some([v, bar]) = messaging.update(kind, feature, &mut self.ends(workspace, run), &mut Ignore)
            else {
                return;
            };
            (0..run.len()).for_each(|l| sum += R::lane(&v.value, l));
            add(run, d.map(|d| bar.times(&rate).value * d));
        });
        self.for_edges(q, |run, kind, d| {
            let [feature, rate] = messaging.feature(kind, &constant(d));
            let bar = messaging.answer(kind, feature, &self.ends(workspace, run), &mut Ignore, |_, _, _| {});
            let Some(bar) = bar else { return };
            add(run, d.map(|d| bar.times(&rate).value * d));
        });
        sum
    }

    /// The nodes' part of V of the messages, and n̄ of it.
    fn settle<R: Packed<Weight = W::Wide>>(
        &self,
        messaging: &Messaging<W, D, K, H, L>,
        workspace: &mut [R],
    ) -> R {
        let mut sum = R::zero();
        for first in (0..self.nodes.len()).step_by(R::WIDTH) {
            let lanes = R::WIDTH.min(self.nodes.len() - first);
            let mut ends =
                PackEnds { graph: self, workspace: &mut *workspace, lanes, node: |_, l| first + l };
            if let Some(v) = messaging.settle(&mut ends, &mut Ignore) {
                (0..lanes).for_each(|l| sum += R::lane(&v.value, l));
            }
        }
        sum
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

/// What the messages keep at every node: n, then n̄.
const KEPT: usize = 2;

/// A pack of edges or of nodes among what is kept, node after node: lane l ends at `node(end, l)`.
struct PackEnds<'t, 'a, W, R, F, const D: usize, const K: usize, const H: usize, const L: usize> {
    graph: &'t Graph<'a, W, D, K, H, L>,
    workspace: &'t mut [R],
    lanes: usize,
    node: F,
}

impl<
    W: Stored,
    R: Packed<Weight = W::Wide>,
    F: Fn(usize, usize) -> usize,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
> PackEnds<'_, '_, W, R, F, D, K, H, L>
{
    /// The place of number k of what is kept at a node; lanes that are not there stand for the first.
    fn place(&self, kept: Kept, end: usize, lane: usize, k: usize) -> usize {
        let lane = if lane < self.lanes { lane } else { 0 };
        let width = usize::from(self.graph.types.shape().embedding);
        let start = KEPT * (self.node)(end, lane) + usize::from(kept == Kept::Bar);
        start * width + k
    }
}

impl<
    W: Stored,
    R: Packed<Weight = W::Wide>,
    F: Fn(usize, usize) -> usize,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
> Ends<R::Pack, 0> for PackEnds<'_, '_, W, R, F, D, K, H, L>
{
    fn embedding(&self, end: usize, k: usize) -> R::Pack {
        R::pack(|l| {
            let kind = self.graph.kind((self.node)(end, if l < self.lanes { l } else { 0 }));
            self.graph.types.embedding(kind, k)
        })
    }

    fn get(&self, kept: Kept, end: usize, k: usize) -> Jet<R::Pack, 0> {
        let at = |l| self.workspace.get(self.place(kept, end, l, k)).copied();
        Jet::constant(R::pack(|l| at(l).unwrap_or(R::zero())))
    }

    fn add(&mut self, kept: Kept, x: &[Embedding<R::Pack, 0>]) {
        for lane in 0..self.lanes {
            for (end, x) in x.iter().enumerate() {
                for (k, x) in x.iter().enumerate() {
                    let place = self.place(kept, end, lane, k);
                    if let Some(slot) = self.workspace.get_mut(place) {
                        *slot += R::lane(&x.value, lane);
                    }
                }
            }
        }
    }
}

/// Takes the gradients in the differences of a pack of edges from l_q of their first ends and adds them to that of the others.
#[inline(always)]
fn add_forces<R: Packed, const D: usize>(l_q: &mut [[R; D]], run: &[Edge], gradient: &[R::Pack; D]) {
    for (l, edge) in run.iter().enumerate() {
        exchange(l_q, edge, &lane(gradient, l).map(|gradient: R| -gradient));
    }
}

/// The vectors of every lane, component by component.
#[inline(always)]
fn packs<R: Packed, const D: usize>(lane: impl Fn(usize) -> [R; D]) -> [R::Pack; D] {
    let mut packs = [R::Pack::zero(); D];
    packs.iter_mut().enumerate().for_each(|(i, pack)| *pack = R::pack(|l| lane(l)[i]));
    packs
}

/// Parts of a list whose items are of one kind, each as long as it may be and at most `width`.
#[inline(always)]
fn runs<T>(mut rest: &[T], kind: impl Fn(&T) -> u8, width: usize) -> impl Iterator<Item = &[T]> {
    iter::from_fn(move || {
        let first = kind(rest.first()?);
        let length = rest.iter().take(width).take_while(|item| kind(item) == first).count();
        let (run, after) = rest.split_at_checked(length)?;
        rest = after;
        Some(run)
    })
}
