//! The models that the images carry in flash, and the functions that run them.

use crate::instructions::Counts;
use crate::{print, report, stack};
use core::hint::black_box;
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::continuous::{Drive, acceleration, constrained_acceleration};
use leastaction_core::discrete::{Del, Newton, Path};
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::ModelError;
use leastaction_core::particles::Particles;
use leastaction_firmware_sim::trajectory::reference::{
    Arm, BOBS, Bobs, Cartpole, Double, DryBodies, GRAPH, HalfCartpole, Links, STEP, StickingBodies, TREE,
    aslant, chain, dry, newton,
};
use leastaction_firmware_sim::trajectory::{ParticleMotion, SystemMotion};

/// Loads a model, and prints the stack that loading takes.
pub fn load<T>(load: impl FnOnce() -> Result<T, ModelError>) -> Result<T, &'static [u8]> {
    let (depth, model) = stack::deepest(load);
    print::number(b"load_stack", depth as u32);
    model.map_err(|_| b"the model is refused".as_slice())
}

/// Measures a system in generalised coordinates, with steps along a path.
pub fn free<L, F, P: Path, const N: usize>(
    system: &System<L, F>,
    newton: Newton<f32>,
) -> Result<(), &'static [u8]>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let at = [[0.1; N], [0.2; N], [0.0; N]];
    report::evaluation(b"acceleration_instructions", b"acceleration_stack", || {
        let [q, v, u] = black_box(&at);
        let _ = black_box(acceleration(system, q, v, u));
    });
    let del = Del::<f32, P>::with_newton(STEP, newton);
    let mut motion = SystemMotion::new(system, del).map_err(|_| b"the start is refused".as_slice())?;
    report::motion(&mut motion, &mut Counts::default())
}

/// Measures the cart-pole, with steps along a path.
pub fn cartpole<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| Cartpole::load(black_box(file)))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures the cart-pole with damping and dry friction.
pub fn dry_cartpole<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| Cartpole::load(black_box(file)))?;
    free::<_, _, P, 2>(black_box(&dry(&model)), newton())
}

/// Measures the cart-pole with weights in half precision.
pub fn half_cartpole<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| HalfCartpole::load(black_box(file)))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures the double pendulum, with steps along a path.
pub fn double_pendulum<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| Double::load(black_box(file), TREE))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures two links as rigid bodies, with steps along a path.
pub fn links<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| Links::load(black_box(file)))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures a cart-pole as rigid bodies, with the dry friction that was learned with them.
pub fn dry_bodies<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| DryBodies::load(black_box(file)))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures the cart that sticks and runs against stops.
pub fn sticking_bodies<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| StickingBodies::load(black_box(file)))?;
    free::<_, _, P, 2>(&model.system, newton())
}

/// Measures seven joints in space, with steps along a path, and their inverse dynamics.
pub fn arm<P: Path>(file: &'static [u8]) -> Result<(), &'static [u8]> {
    let model = load(|| Arm::load(black_box(file)))?;
    let at = [[0.1_f32; 7], [0.2; 7], [0.3; 7]];
    report::evaluation(b"inverse_dynamics_instructions", b"inverse_dynamics_stack", || {
        let [q, v, a] = black_box(&at);
        black_box(model.system.lagrangian.inverse_dynamics(q, v, a));
    });
    free::<_, _, P, 7>(&model.system, newton())
}

/// Measures the chain of bobs, straight and aslant, with steps of the given order. Its rods are constants of the program, which takes a
/// third less code than stepping with the rods of the file.
pub fn bobs(file: &'static [u8], order: Order) -> Result<(), &'static [u8]> {
    let mut rods = chain();
    let bobs = load(|| Bobs::load(black_box(file), GRAPH, &mut [], &mut rods))?;
    let mut workspace = [0.0; Rattle::<f32>::workspace_of::<2>(BOBS, BOBS, 1, 0)];
    let mut numbers = [0.0; ParticleState::<f32, 2>::workspace(BOBS, BOBS)];
    hanging(&bobs.system.graph, (&chain(), &aslant()), (order, newton()), (&mut numbers, &mut workspace))
}

/// Measures particles on rods, with steps of the given order.
pub fn hanging<S: Particles<f32, 2>, const NODES: usize>(
    graph: &S,
    (rods, q): (&[Holonomic<f32, 2>], &[[f32; 2]; NODES]),
    (order, newton): (Order, Newton<f32>),
    (numbers, workspace): (&mut [f32], &mut [f32]),
) -> Result<(), &'static [u8]> {
    let refused = b"the particles are refused".as_slice();
    let mechanism = Constrained::new(graph, rods).map_err(|_| refused)?;
    accelerate(&mechanism, q, workspace);
    let v = [[0.0; 2]; NODES];
    let state = ParticleState::new(&mechanism, q, &v, numbers, workspace).map_err(|_| refused)?;
    let rattle = Rattle::with_newton(STEP, order, newton);
    let mut force = [[0.0; 2]; NODES];
    let mut motion = ParticleMotion::new(&mechanism, rattle, state, &mut force, workspace);
    report::motion(&mut motion, &mut Counts::default())
}

fn accelerate<S: Particles<f32, 2>, const NODES: usize>(
    mechanism: &Constrained<f32, S, [Holonomic<f32, 2>], 2>,
    q: &[[f32; 2]; NODES],
    workspace: &mut [f32],
) {
    report::evaluation(b"acceleration_instructions", b"acceleration_stack", || {
        let (mut a, mut lambda) = ([[0.0; 2]; NODES], [0.0; NODES]);
        let lambda_of_rods = lambda.get_mut(..mechanism.equations()).unwrap_or_default();
        let _ = black_box(constrained_acceleration(
            mechanism,
            (black_box(q), q),
            &Drive::none(),
            workspace,
            (&mut a, lambda_of_rods),
        ));
        black_box((a, lambda));
    });
}
