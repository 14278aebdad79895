//! Operations of an evaluation, counted by running it.

use crate::counted::{Counted, Operations, count};
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::continuous::{Drive, acceleration, constrained_acceleration, constrained_workspace};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Path, State};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::arm::ArmBodies;
use leastaction_core::energy::bodies::PlanarBodies;
use leastaction_core::energy::graph::Graph;
use leastaction_core::energy::inertia_network::InertiaNetwork;
use leastaction_core::energy::modular::{MAX_TYPES, Modular};
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{Laws, Rod};
use leastaction_core::scalar::Packed;
use leastaction_models::{AnyFamily, Architecture, DEPTH, GraphArchitecture, MAX_ELEMENT_UNITS, MAX_WIDTH};

type Real = Counted<f64>;

/// Operation counts of an acceleration and of steps of both orders, with two Newton updates per Jacobian.
pub struct Evaluations {
    /// An acceleration.
    pub acceleration: Operations,
    /// A step of order 2.
    pub step_order_2: Operations,
    /// A step of order 4.
    pub step_order_4: Operations,
}

/// Counts operations at an arbitrary state, without dry friction. `None` if the shape is beyond those measured on
/// chips, or if its networks are wider or deeper than those compiled here. Except for graphs, the limit is 4
/// coordinates, since code and stack grow unevenly.
pub fn operations(architecture: &Architecture, weights: &[f64]) -> Option<Evaluations> {
    match (&architecture.family, architecture.n()) {
        (AnyFamily::Graph(graph), _) if graph.dimension() == 3 => particles::<3>(graph, weights),
        (AnyFamily::Graph(graph), _) => particles::<2>(graph, weights),
        (family, 1) => of_coordinates::<1>(family, weights),
        (family, 2) => of_coordinates::<2>(family, weights),
        (family, 3) => of_coordinates::<3>(family, weights),
        (family, 4) => of_coordinates::<4>(family, weights),
        _ => None,
    }
}

/// The step, s.
const H: f64 = 0.01;

fn newton() -> Newton<Real> {
    Newton { max_iterations: 2, stop: Counted(0.0), accept: Counted(f64::INFINITY) }
}

impl Packed for Real {
    type Pack = Self;
    const WIDTH: usize = 1;

    fn pack(mut lane: impl FnMut(usize) -> Self) -> Self {
        lane(0)
    }
    fn lane(pack: &Self, _: usize) -> Self {
        *pack
    }
}

fn of_coordinates<const N: usize>(family: &AnyFamily, weights: &[f64]) -> Option<Evaluations> {
    let laws = Laws::NONE;
    match family {
        AnyFamily::InertiaNetwork(inertia_network) => {
            let system = inertia_network.header().system(laws, weights).ok()?;
            steps::<InertiaNetwork<f64, N, MAX_WIDTH, DEPTH>, Viscous<Real, N>, N>(&system)
        }
        AnyFamily::Modular(modular) => {
            let system = modular.header().system(&modular.tree_header(), laws, weights).ok()?;
            steps::<Modular<f64, N, MAX_TYPES, MAX_ELEMENT_UNITS, DEPTH>, Viscous<Real, N>, N>(&system)
        }
        AnyFamily::Bodies(bodies) => {
            let system = bodies.header().system(laws, weights).ok()?;
            steps::<PlanarBodies<f64, N>, Viscous<Real, N>, N>(&system)
        }
        AnyFamily::Arm(arm) => {
            let system = arm.header().system(laws, weights).ok()?;
            steps::<ArmBodies<f64, N>, Viscous<Real, N>, N>(&system)
        }
        _ => None,
    }
}

fn steps<L: Lagrangian<Real, N>, F: Forces<Real, N>, const N: usize>(
    system: &System<L, F>,
) -> Option<Evaluations> {
    let (q, v) = ([Counted(0.1); N], [Counted(0.2); N]);
    let (_, of_acceleration) = count(|| acceleration(system, &q, &v, &[Counted(0.0); N]));
    Some(Evaluations {
        acceleration: of_acceleration,
        step_order_2: step::<_, _, Midpoint, N>(system, q, v)?,
        step_order_4: step::<_, _, Galerkin, N>(system, q, v)?,
    })
}

fn step<L, F, P: Path, const N: usize>(
    system: &System<L, F>,
    q: [Real; N],
    v: [Real; N],
) -> Option<Operations>
where
    L: Lagrangian<Real, N>,
    F: Forces<Real, N>,
{
    let mut state = State::new(&system.lagrangian, q, v).ok()?;
    let del = Del::<Real, P>::with_newton(Counted(H), newton());
    let (outcome, done) = count(|| del.step(system, &mut state, &Control::none()));
    outcome.ok().map(|_| done)
}

/// Counts for nodes in a slanted row, 1 m apart, whatever the lengths of the rods.
fn particles<const D: usize>(architecture: &GraphArchitecture, weights: &[f64]) -> Option<Evaluations> {
    let layout = architecture.graph().ok()?;
    let types = architecture.host_types::<f64, D>(weights).ok()?;
    let graph = Graph::new(types, &layout.nodes, &layout.edges).ok()?;
    let rods: Vec<Holonomic<Real, D>> = layout.rods.iter().map(Rod::constraint).collect();
    let mechanism = Constrained::new(&graph, &rods[..]).ok()?;
    let slope = [0.6, -0.8, 0.0];
    let place = |i: usize| std::array::from_fn(|k| Counted(slope[k.min(2)] * (i + 1) as f64));
    let q: Vec<[Real; D]> = (0..layout.nodes.len()).map(place).collect();
    let v = vec![[Counted(0.0); D]; q.len()];
    let mut workspace =
        vec![Counted(0.0); Rattle::workspace(&mechanism).max(constrained_workspace(&mechanism))];
    let (mut a, mut lambda) = (v.clone(), vec![Counted(0.0); rods.len()]);
    let (outcome, acceleration) = count(|| {
        constrained_acceleration(&mechanism, (&q, &v), &Drive::none(), &mut workspace, (&mut a, &mut lambda))
    });
    outcome.ok()?;
    let mut step = |order| {
        let mut numbers = vec![Counted(0.0); ParticleState::<Real, D>::workspace(q.len(), rods.len())];
        let mut state = ParticleState::new(&mechanism, &q, &v, &mut numbers, &mut workspace).ok()?;
        let rattle = Rattle::with_newton(Counted(H), order, newton());
        let (outcome, done) = count(|| rattle.step(&mechanism, &mut state, None, &mut workspace));
        outcome.ok().map(|_| done)
    };
    Some(Evaluations { acceleration, step_order_2: step(Order::Two)?, step_order_4: step(Order::Four)? })
}
