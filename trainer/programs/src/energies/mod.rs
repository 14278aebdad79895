//! The families of [`leastaction_core::energy`], their Lagrangians written down for any size.

mod arm;
mod bodies;
mod friction;
mod graph;
mod inertia_network;
mod law_networks;
mod modular;
mod network;
mod offsets;

pub use arm::{ArmEnergies, ArmJoint};
pub use bodies::BodiesEnergies;
pub use friction::{DryLaw, FrictionLaws, WithFriction};
pub use graph::GraphEnergies;
pub use inertia_network::InertiaNetworkEnergies;
pub use law_networks::{LawNetwork, WithNetworks};
pub use modular::ModularEnergies;
pub use network::Network;
pub use offsets::WithOffsets;

use crate::builder::{Builder, Node};
use crate::function::Function;
use leastaction_core::energy::bodies::{TreeBody, TreeError};
use leastaction_core::energy::inertia_network::Coordinate;

/// s(q) of coordinates of these kinds: translations, then the cosines of all angles, then their sines.
fn features(builder: &mut Builder, kinds: &[Coordinate], q: Node) -> Node {
    let of = |kind| (0..kinds.len()).filter(|i| kinds[*i] == kind).collect::<Vec<_>>();
    let (translations, angles) = (of(Coordinate::Translation), of(Coordinate::Angle));
    let (translations, angles) = (builder.gather(q, &translations), builder.gather(q, &angles));
    let (cosines, sines) = (builder.cosine(angles), builder.map(Function::Sine, angles));
    builder.joined(&[translations, cosines, sines])
}

/// Whether bodies form a tree, parents first.
fn check_tree<'b>(bodies: impl ExactSizeIterator<Item = &'b TreeBody>) -> Result<(), TreeError> {
    if bodies.len() == 0 {
        return Err(TreeError::Empty);
    }
    for (element, body) in bodies.enumerate() {
        if let Some(parent) = body.parent.map(usize::from).filter(|parent| *parent >= element) {
            return Err(TreeError::Parent { element, parent });
        }
    }
    Ok(())
}

/// A family's model of some shape: its energies over a weight block, and the forces beside them.
pub trait Energies {
    /// Number of coordinates n.
    fn n(&self) -> usize;
    /// Numbers in the weight block.
    fn parameters(&self) -> usize;
    /// T(q, v) and V(q), J, vectors of one number each; q in m or rad, v in m/s or rad/s.
    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2];
    /// Q(q, v, τ), N or N m, beside the control force τ; 0 where it is not written down.
    fn force(&self, builder: &mut Builder, _: Node, v: Node, _: Node) -> Node {
        let n = builder.length(v);
        builder.zeros(n)
    }
    /// How far from rest a force like friction bends, of each coordinate, m/s or rad/s: Newton's method looks again where a velocity
    /// changes its sign from further away ([`leastaction_core::forces::Forces::trusted_part`]). `None` where no force does.
    fn bends(&self, _: &mut Builder) -> Option<Node> {
        None
    }
}

impl<E: Energies + ?Sized> Energies for Box<E> {
    fn n(&self) -> usize {
        (**self).n()
    }

    fn parameters(&self) -> usize {
        (**self).parameters()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        (**self).energies(builder, q, v)
    }

    fn force(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        (**self).force(builder, q, v, tau)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        (**self).bends(builder)
    }
}
