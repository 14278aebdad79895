//! The families of [`leastaction_core::energy`], with their Lagrangians written down for any size.

mod arm;
mod bodies;
mod graph;
mod group_law;
mod inertia_network;
mod law_networks;
mod modular;
mod network;
mod offsets;

pub use arm::{ArmEnergies, ArmJoint};
pub use bodies::BodiesEnergies;
pub use graph::GraphEnergies;
pub use group_law::{GroupForce, WithGroupLaw, with_group_laws};
pub use inertia_network::InertiaNetworkEnergies;
pub use law_networks::{LawNetwork, WithNetworks};
pub use modular::ModularEnergies;
pub use network::Network;
pub use offsets::WithOffsets;

use crate::builder::Builder;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::bodies::{TreeBody, TreeError};
use leastaction_core::energy::inertia_network::Coordinate;

/// Features s(q) of coordinates of these kinds: translations, then the cosines of all angles, then their sines.
fn features(builder: &mut Builder, kinds: &[Coordinate], q: Node) -> Node {
    let of = |kind| (0..kinds.len()).filter(|i| kinds[*i] == kind).collect::<Vec<_>>();
    let (translations, angles) = (of(Coordinate::Translation), of(Coordinate::Angle));
    let (translations, angles) = (builder.gather(q, &translations), builder.gather(q, &angles));
    let (cosines, sines) = (builder.cosine(angles), builder.map(Function::Sine, angles));
    builder.joined(&[translations, cosines, sines])
}

/// Checks that bodies form a tree, parents first.
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

/// Model of a given shape: its energies over a weight block, and its forces besides the control.
pub trait Energies {
    /// Number of coordinates n.
    fn n(&self) -> usize;
    /// Length of the weight block, in numbers.
    fn parameters(&self) -> usize;
    /// Energies T(q, v) and V(q), J, as vectors of one number each; q in m or rad, v in m/s or rad/s.
    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2];
    /// Force Q(q, v, τ) in addition to the control force τ, N or N m; 0 by default.
    fn force(&self, builder: &mut Builder, _: Node, v: Node, _: Node) -> Node {
        let n = builder.length(v);
        builder.zeros(n)
    }
    /// The force without laws of contacts, which have many values ([`Energies::grips`], [`Energies::stops`]).
    fn single_valued(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        self.force(builder, q, v, tau)
    }
    /// Levels, N or N m, of the dry friction of each coordinate that sticks: against motion forwards and backwards, and the ratio of friction
    /// at rest ([`leastaction_core::forces::Grip`]). `None` if none sticks.
    fn grips(&self, _: &mut Builder, _: Node) -> Option<[Node; 3]> {
        None
    }
    /// Lower and upper end stop of each coordinate, m or rad, and its restitution ([`leastaction_core::forces::Stop`]). `None` without stops.
    fn stops(&self, _: &mut Builder) -> Option<[Node; 3]> {
        None
    }
    /// Speed of each coordinate up to which a force such as friction bends, m/s or rad/s. If an update of Newton's
    /// method reverses a velocity from beyond this speed, the method evaluates again
    /// ([`leastaction_core::forces::Forces::trusted_part`]). `None` if no force bends.
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

    fn single_valued(&self, builder: &mut Builder, q: Node, v: Node, tau: Node) -> Node {
        (**self).single_valued(builder, q, v, tau)
    }

    fn grips(&self, builder: &mut Builder, tau: Node) -> Option<[Node; 3]> {
        (**self).grips(builder, tau)
    }

    fn stops(&self, builder: &mut Builder) -> Option<[Node; 3]> {
        (**self).stops(builder)
    }

    fn bends(&self, builder: &mut Builder) -> Option<Node> {
        (**self).bends(builder)
    }
}
