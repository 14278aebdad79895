//! Graphs of any size, their nodes and edges in packs.

use super::{Edge, Graph, across, exchange};
use crate::energy::part::Ignore;
use crate::lagrangian::Energies;
use crate::network::Jet;
use crate::particles::Particles;
use crate::scalar::Packed;
use core::array;
use core::iter;

impl<R: Packed, const D: usize, const K: usize, const H: usize, const L: usize> Particles<R, D>
    for Graph<'_, R::Weight, D, K, H, L>
{
    fn nodes(&self) -> usize {
        self.nodes.len()
    }

    fn room(&self) -> usize {
        0
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], _room: &mut [R]) -> Energies<R> {
        let kinetic = self.sum_nodes(v, |kind, v| self.types.kinetic::<R::Pack, 0>(kind, v).value);
        let mut potential = self.sum_nodes(q, |kind, q| self.types.potential(kind, q));
        self.for_edges(q, |run, kind, d| {
            let pairs = self.types.pair::<R::Pack, 0>(kind, &d).value;
            (0..run.len()).for_each(|l| potential += R::lane(&pairs, l));
        });
        Energies { kinetic, potential }
    }

    fn l_q(&self, q: &[[R; D]], _room: &mut [R], l_q: &mut [[R; D]]) {
        let mut slots = l_q.iter_mut();
        self.for_nodes(q, |run, kind, x| {
            let pull = self.types.pull::<R::Pack, 0>(kind, &x.map(Jet::constant), &mut Ignore, |_, _| {});
            for (l, slot) in slots.by_ref().take(run.len()).enumerate() {
                *slot = pull.each_ref().map(|pull| -R::lane(&pull.value, l));
            }
        });
        self.for_edges(q, |run, kind, d| {
            let force = self.types.pair::<R::Pack, 1>(kind, &d).gradient(&d).map(|force| -force);
            for (l, edge) in run.iter().enumerate() {
                exchange(l_q, edge, &force.each_ref().map(|force| R::lane(force, l)));
            }
        });
    }

    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.types.kinetic::<R, 1>(self.kind(node), v).gradient(v)
    }

    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D] {
        self.types.kinetic::<R, 2>(self.kind(node), v).hessian(v)
    }

    fn drag(&self, node: usize, v: &[R; D]) -> [R; D] {
        v.map(|v| self.types.drag(self.kind(node), v)[0])
    }

    fn drag_slope(&self, node: usize, v: &[R; D]) -> [R; D] {
        v.map(|v| self.types.drag(self.kind(node), v)[1])
    }
}

impl<W: Copy, const D: usize, const K: usize, const H: usize, const L: usize> Graph<'_, W, D, K, H, L> {
    /// Visits neighbouring nodes of one type with their type and what `x` says of them.
    #[inline(always)]
    fn for_nodes<R: Packed<Weight = W>>(
        &self,
        mut x: &[[R; D]],
        mut visit: impl FnMut(&[u8], u8, [R::Pack; D]),
    ) {
        for run in runs(self.nodes, |kind| *kind, R::WIDTH) {
            let Some((own, rest)) = x.split_at_checked(run.len()) else { return };
            x = rest;
            let (Some(kind), Some(first)) = (run.first(), own.first()) else { return };
            visit(run, *kind, packs(|l| *own.get(l).unwrap_or(first)));
        }
    }

    /// Visits neighbouring edges of one type with their type and what lies between their ends.
    #[inline(always)]
    fn for_edges<R: Packed<Weight = W>>(
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

    #[inline(always)]
    fn sum_nodes<R: Packed<Weight = W>>(&self, x: &[[R; D]], of: impl Fn(u8, &[R::Pack; D]) -> R::Pack) -> R {
        let mut sum = R::zero();
        self.for_nodes(x, |run, kind, x| {
            let terms = of(kind, &x);
            (0..run.len()).for_each(|l| sum += R::lane(&terms, l));
        });
        sum
    }
}

/// The vectors of every lane, component by component.
#[inline(always)]
fn packs<R: Packed, const D: usize>(lane: impl Fn(usize) -> [R; D]) -> [R::Pack; D] {
    array::from_fn(|i| R::pack(|l| lane(l)[i]))
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
