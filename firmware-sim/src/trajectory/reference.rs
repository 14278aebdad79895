//! The models of `firmware-sim/chip/models`, one of each family, and the way every target runs them.

use leastaction_core::constraints::Holonomic;
use leastaction_core::discrete::Newton;
use leastaction_core::energy::inertia_network::InertiaNetwork;
use leastaction_core::forces::{Coulomb, DryFriction, Sticking, Stops, System, Viscous};
use leastaction_core::model::{ArmModel, BodiesModel, GraphModel, InertiaNetworkModel, ModularModel};
use leastaction_core::scalar::f16;

/// Step size, s.
pub const STEP: f32 = 0.01;

/// A cart-pole: layers 2 → 32 → 32 → 4.
pub type Cartpole<'a> = InertiaNetworkModel<'a, 2, 32, 2>;

/// A cart-pole of a smaller network: layers 2 → 16 → 16 → 4.
pub type SmallCartpole<'a> = InertiaNetworkModel<'a, 2, 16, 2>;

/// Damping, and dry friction that grows with the load.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);

/// The cart-pole with friction.
pub type DryCartpole<'a> = System<InertiaNetwork<'a, f32, 2, 32, 2>, Friction<2>>;

/// The cart-pole with weights in half precision.
pub type HalfCartpole<'a> = InertiaNetworkModel<'a, 2, 32, 2, f16>;

/// Two pendulums of one learned type: layers 2 → 8 → 2 and 2 → 8 → 1.
pub type Double<'a> = ModularModel<'a, 2, 1, 8, 1>;

/// The tree of [`Double`].
pub const TREE: &str = "double";

/// Two links as rigid bodies, hanging at 0.
pub type Links<'a> = BodiesModel<'a, 2>;

/// A cart and its pole as rigid bodies, with the friction of its file.
pub type DryBodies<'a> = BodiesModel<'a, 2, f32, Friction<2>>;

/// A cart that sticks to its rail and runs against stops, and its pole, as rigid bodies.
pub type StickingBodies<'a> = BodiesModel<'a, 2, f32, (Viscous<f32, 2>, (Sticking<f32, 2>, Stops<f32, 2>))>;

/// Seven joints in space, damped.
pub type Arm<'a> = ArmModel<'a, 7>;

/// Bobs on rods: layers 2 → 8 → 1.
pub type Bobs<'a> = GraphModel<'a, 2, 1, 8, 1>;

/// The graph of [`Bobs`], with one bob more than the graph whose motion it was learned from.
pub const GRAPH: &str = "three";

/// Number of bobs of the graph.
pub const BOBS: usize = 3;

/// The cart-pole with friction of 0.1 N and 0.005 N m; the numbers of friction are part of the program, all others come from the file.
pub fn dry<'a>(Cartpole { system, .. }: &Cartpole<'a>) -> DryCartpole<'a> {
    let friction = |constant| DryFriction { constant, load: 0.2, smoothing: 0.05, width: 0.1 };
    let friction = Coulomb { coordinates: [friction(0.1), friction(0.005)] };
    System { lagrangian: system.lagrangian, forces: (Viscous { coefficients: [0.05, 0.002] }, friction) }
}

/// Newton's method with two updates in every step, for a short and constant running time.
pub fn newton() -> Newton<f32> {
    Newton { max_iterations: 2, stop: 0.0, ..Newton::default() }
}

/// Rods of 1 m from the origin to the first bob and from each to the next.
pub fn chain() -> [Holonomic<f32, 2>; BOBS] {
    core::array::from_fn(|node| match node.checked_sub(1) {
        None => Holonomic::Anchor { node, to: [0.0; 2], length: 1.0 },
        Some(above) => Holonomic::Rod { nodes: [node, above], length: 1.0 },
    })
}

/// Positions of the chain straight and aslant, m.
pub fn aslant() -> [[f32; 2]; BOBS] {
    core::array::from_fn(|bob| [0.6 * (bob + 1) as f32, -0.8 * (bob + 1) as f32])
}
