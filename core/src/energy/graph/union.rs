//! Several trained graphs on one set of nodes.

use super::{Graph, GraphError};
use crate::expected::{expected, first_mut, present};
use crate::lagrangian::Energies;
use crate::particles::Particles;
use crate::scalar::{Packed, WeightFormat};

/// A model's graph on some of the nodes of a union.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a, W, const D: usize, const K: usize, const H: usize, const L: usize> {
    /// The graph, with its own numbering of nodes.
    pub graph: Graph<'a, W, D, K, H, L>,
    /// Each graph node's number in the union, in ascending order.
    pub nodes: &'a [u16],
}

/// Graphs of different models on one set of nodes (LGNN's hybrid systems). Potentials and drags of all members add up; the kinetic energy
/// of a node is taken once, from the first member that has the node.
///
/// The models of a union must have been trained with the same scale of energy, which accelerations alone do not determine.
#[derive(Clone, Copy, Debug)]
pub struct Union<'a, W, const D: usize, const K: usize, const H: usize, const L: usize> {
    members: &'a [Member<'a, W, D, K, H, L>],
    nodes: usize,
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Union<'a, W, D, K, H, L>
{
    /// Creates a union of `nodes` nodes.
    ///
    /// # Errors
    /// [`GraphError::MemberNodes`] and [`GraphError::MemberOrder`] if a member does not name its nodes in
    /// ascending order, [`GraphError::Ownerless`] if a node belongs to no member, [`GraphError::Empty`] if
    /// there are no nodes.
    pub fn new(members: &'a [Member<'a, W, D, K, H, L>], nodes: usize) -> Result<Self, GraphError> {
        let union = Self { members, nodes };
        if nodes == 0 {
            return Err(GraphError::Empty);
        }
        members.iter().enumerate().try_for_each(|(i, member)| member.check(i, nodes))?;
        match (0..nodes).find(|node| union.holders(*node).next().is_none()) {
            Some(node) => Err(GraphError::Ownerless { node }),
            None => Ok(union),
        }
    }

    /// The members that have a node, each with the type that the node has there.
    #[inline(always)]
    fn holders(&self, node: usize) -> impl Iterator<Item = (&'a Member<'a, W, D, K, H, L>, u8)> {
        self.members.iter().filter_map(move |member| Some((member, member.kind(node)?)))
    }
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Member<'a, W, D, K, H, L>
{
    fn check(&self, member: usize, nodes: usize) -> Result<(), GraphError> {
        let (found, needed) = (self.nodes.len(), self.graph.nodes.len());
        if found != needed {
            return Err(GraphError::MemberNodes { member, found, needed });
        }
        let mut least = 0;
        for node in self.nodes.iter().map(|node| usize::from(*node)) {
            if !(least..nodes).contains(&node) {
                return Err(GraphError::MemberOrder { member, node });
            }
            least = node + 1;
        }
        Ok(())
    }

    /// The member's type for a node of the union.
    fn kind(&self, node: usize) -> Option<u8> {
        let own = self.nodes.binary_search(&u16::try_from(node).ok()?).ok()?;
        self.graph.nodes.get(own).copied()
    }

    /// Copies the vectors of the member's nodes to the front of `own` and returns that part.
    fn gather<'o, R: Packed>(&self, x: &[[R; D]], own: &'o mut [[R; D]]) -> &'o mut [[R; D]] {
        for (slot, node) in own.iter_mut().zip(self.nodes) {
            *slot = expected(x.get(usize::from(*node)).copied(), [R::zero(); D]);
        }
        first_mut(own, self.nodes.len())
    }
}

impl<
    W: WeightFormat,
    R: Packed<Weight = W::Wide>,
    const D: usize,
    const K: usize,
    const H: usize,
    const L: usize,
> Particles<R, D> for Union<'_, W, D, K, H, L>
{
    fn nodes(&self) -> usize {
        self.nodes
    }

    fn workspace(&self) -> usize {
        let workspace = |member: &Member<_, D, K, H, L>| {
            2 * D * member.nodes.len() + Particles::<R, D>::workspace(&member.graph)
        };
        self.members.iter().map(workspace).max().unwrap_or(0)
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], workspace: &mut [R]) -> Energies<R> {
        let (mut kinetic, mut potential) = (R::zero(), R::zero());
        for (node, v) in v.iter().enumerate().take(self.nodes) {
            let owner = present(self.holders(node).next());
            kinetic +=
                owner.map_or(R::zero(), |(owner, kind)| owner.graph.types.kinetic::<R, 0>(kind, v).value);
        }
        for member in self.members {
            let (own, workspace) = split::<R, D>(workspace, member.nodes.len());
            potential += member.graph.potential(member.gather(q, own), workspace);
        }
        Energies { kinetic, potential }
    }

    fn l_q(&self, q: &[[R; D]], workspace: &mut [R], l_q: &mut [[R; D]]) {
        l_q.fill([R::zero(); D]);
        for member in self.members {
            let (own, workspace) = split::<R, D>(workspace, member.nodes.len());
            let (forces, workspace) = split::<R, D>(workspace, member.nodes.len());
            member.graph.l_q(member.gather(q, own), workspace, forces);
            for (node, force) in member.nodes.iter().zip(forces) {
                let Some(sum) = present(l_q.get_mut(usize::from(*node))) else { continue };
                sum.iter_mut().zip(force).for_each(|(sum, force)| *sum += *force);
            }
        }
    }

    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D] {
        let owner = present(self.holders(node).next());
        owner.map_or([R::zero(); D], |(owner, kind)| owner.graph.types.kinetic::<R, 1>(kind, v).gradient(v))
    }

    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D] {
        let owner = present(self.holders(node).next());
        owner.map_or([[R::zero(); D]; D], |(owner, kind)| {
            owner.graph.types.kinetic::<R, 2>(kind, v).hessian(v)
        })
    }

    fn drag(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.sum(node, v, |[drag, _]| drag)
    }

    fn drag_slope(&self, node: usize, v: &[R; D]) -> [R; D] {
        self.sum(node, v, |[_, slope]| slope)
    }
}

impl<W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Union<'_, W, D, K, H, L>
{
    /// Sums over all members the number that `part` picks from a member's drag and slope, axis by axis.
    fn sum<R: Packed<Weight = W::Wide>>(
        &self,
        node: usize,
        v: &[R; D],
        part: impl Fn([R; 2]) -> R,
    ) -> [R; D] {
        let mut sum = [R::zero(); D];
        for (member, kind) in self.holders(node) {
            for (sum, v) in sum.iter_mut().zip(v) {
                *sum += part(member.graph.types.drag(kind, *v));
            }
        }
        sum
    }
}

/// Splits off the workspace for `vectors` vectors.
fn split<R: Packed, const D: usize>(workspace: &mut [R], vectors: usize) -> (&mut [[R; D]], &mut [R]) {
    let (own, rest) = expected(workspace.split_at_mut_checked(vectors * D), (&mut [], &mut []));
    (own.as_chunks_mut().0, rest)
}
