//! The slice interface gives the same results as core's types, bit for bit.

mod common;

use common::{
    BodiesSample, GRAPHS, GraphSample, InertiaNetworkSample, NETWORK, Random, TREES, TreeSample, bytes, step,
};
use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::continuous::{
    Baumgarte, Drive, acceleration, constrained_acceleration, constrained_inverse_dynamics,
    constrained_workspace, inverse_dynamics,
};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Control as CoreControl, Del, Galerkin, Midpoint, Order, Path, State};
use leastaction_core::energy::graph::Edge;
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::forces::{
    Directional, Dissipation, Forces, PotentialCorrection, Servo, Sticking, System, Viscous,
};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{
    BodiesModel, GraphModel, InertiaNetworkModel, Law, Laws, LoadForces, ModularModel,
};
use leastaction_core::network::Activation;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::f16;
use leastaction_replica::{Control, Friction, ModelFile, Motion, Replica, Step};
use proptest::prelude::*;

/// Number of steps of a motion.
const STEPS: usize = 4;

fn bits(x: &[f32]) -> Vec<u32> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Bytes with the alignment of flash.
fn aligned(bytes: &[u8]) -> Vec<u32> {
    let mut words = vec![0_u32; bytes.len().div_ceil(4)];
    bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
    words
}

fn flash<'w>(words: &'w [u32], bytes: &[u8]) -> &'w [u8] {
    &bytemuck::cast_slice(words)[..bytes.len()]
}

/// Bytes that live as long as the program, like those in flash.
fn in_flash(bytes: &[u8]) -> &'static [u8] {
    flash(aligned(bytes).leak(), bytes)
}

fn sized<const N: usize>(x: &[f32]) -> [f32; N] {
    x.try_into().unwrap()
}

/// Position q, momentum p and the Newton report of every step, as bits.
fn stepped(motion: &mut dyn Motion, controls: &[[Vec<f32>; 2]]) -> Vec<u32> {
    let mut all = bits(&[motion.q(), motion.p()].concat());
    for [start, end] in controls {
        let report = motion.step(Control { start, end }).unwrap();
        all.extend([u32::from(report.iterations), report.residual.to_bits()]);
        all.extend(bits(&[motion.q(), motion.p()].concat()));
    }
    all
}

/// Steps a motion by core's types.
fn stepped_by_core<P: Path, L, F, const N: usize>(
    del: &Del<f32, P>,
    system: &System<L, F>,
    mut state: State<f32, N>,
    controls: &[[Vec<f32>; 2]],
) -> Vec<u32>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let mut all = bits(&[state.q(), state.p()].concat());
    for [start, end] in controls {
        let control = CoreControl { start: sized(start), end: sized(end) };
        let report = del.step(system, &mut state, &control).unwrap();
        all.extend([u32::from(report.iterations), report.residual.to_bits()]);
        all.extend(bits(&[state.q(), state.p()].concat()));
    }
    all
}

/// Compares all that a system in N coordinates can do.
fn same<L, F, const N: usize>(chip: &Replica, system: &System<L, F>, seed: u64)
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let mut random = Random(seed);
    let [q, v, u, a] = [1.5, 1.0, 2.0, 3.0].map(|size| random.vector(N, size));
    let (mut evaluator, mut found) = (chip.evaluator().unwrap(), vec![0.0; N]);
    assert_eq!(chip.n(), N);
    let (ours, theirs) =
        (evaluator.energies(&q, &v).unwrap(), system.energies::<f32, N>(&sized(&q), &sized(&v)));
    assert_eq!(bits(&[ours.kinetic, ours.potential]), bits(&[theirs.kinetic, theirs.potential]));

    evaluator.acceleration(&q, &v, &u, &mut found).unwrap();
    let theirs = acceleration(system, &sized(&q), &sized(&v), &sized::<N>(&u)).unwrap();
    assert_eq!(bits(&found), bits(&theirs));
    evaluator.inverse_dynamics(&q, &v, &a, &mut found).unwrap();
    let theirs = inverse_dynamics(system, &sized(&q), &sized(&v), &sized::<N>(&a)).unwrap();
    assert_eq!(bits(&found), bits(&theirs));
    let mut masses = vec![0.0; N * N];
    evaluator.mass_matrix(&q, &mut masses).unwrap();
    let theirs = system.lagrangian.dynamics(&sized(&q), &[0.0; N]).mass;
    assert_eq!(bits(&masses), bits(theirs.as_flattened()));
    assert!(evaluator.mass_matrix(&q, &mut found[1..]).is_err());

    let controls: Vec<_> = (0..STEPS).map(|_| [random.vector(N, 1.0), random.vector(N, 1.0)]).collect();
    same_motion::<Midpoint, _, _, N>(chip, Order::Two, system, [&q, &v], &controls);
    same_motion::<Galerkin, _, _, N>(chip, Order::Four, system, [&q, &v], &controls);
}

/// Compares motions from both kinds of beginning.
fn same_motion<P: Path, L, F, const N: usize>(
    chip: &Replica,
    order: Order,
    system: &System<L, F>,
    [q, v]: [&[f32]; 2],
    controls: &[[Vec<f32>; 2]],
) where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let step = Step::from(step(order));
    let del = Del::<f32, P>::new(step.h);
    let theirs = State::new(&system.lagrangian, sized(q), sized(v)).unwrap();
    let mut ours = chip.motion_at(step, q, v).unwrap();
    assert_eq!(stepped(&mut *ours, controls), stepped_by_core(&del, system, theirs, controls));

    let q1: Vec<f32> = q.iter().zip(v).map(|(q, v)| q + step.h * v).collect();
    let [start, end] = &controls[0];
    let between = CoreControl { start: sized(start), end: sized(end) };
    let theirs = del.start(system, &sized(q), &sized(&q1), &between).unwrap();
    let mut ours = chip.motion_between(step, [q, &q1], Control { start, end }).unwrap();
    assert_eq!(stepped(&mut *ours, controls), stepped_by_core(&del, system, theirs, controls));
}

/// Laws compiled for the sizes of the sample's networks rather than for the maximum sizes of this crate.
type All<const N: usize> =
    (Friction<N>, (Dissipation<'static, f32, N, 6, 2>, PotentialCorrection<'static, f32, N, 6, 2>));

fn has_networks(laws: Laws) -> bool {
    laws.network(Law::Dissipation).or(laws.network(Law::Potential)).is_some()
}

/// Loads an inertia network both ways; core is compiled for the laws of the file.
fn same_inertia_network<const N: usize>(sample: &InertiaNetworkSample) {
    if has_networks(sample.laws) {
        same_inertia_network_with::<All<N>, N>(sample);
    } else if sample.laws.contains(Law::Coulomb) {
        same_inertia_network_with::<Friction<N>, N>(sample);
    } else {
        same_inertia_network_with::<Viscous<f32, N>, N>(sample);
    }
}

fn same_inertia_network_with<F: LoadForces<'static, f32, f32, N>, const N: usize>(
    sample: &InertiaNetworkSample,
) {
    let bytes = sample.file(Order::Four);
    let core = InertiaNetworkModel::<N, 40, 4, f32, F>::load(in_flash(&bytes)).unwrap();
    let file = ModelFile::new(&bytes).unwrap();
    same(&file.replica(None).unwrap(), &core.system, sample.seed ^ 77);
}

/// Loads a chain both ways; core is compiled for the laws of the file.
fn same_tree<const N: usize>(sample: &TreeSample) {
    if has_networks(sample.laws) {
        same_tree_with::<All<N>, N>(sample);
    } else if sample.laws.contains(Law::Coulomb) {
        same_tree_with::<Friction<N>, N>(sample);
    } else {
        same_tree_with::<Viscous<f32, N>, N>(sample);
    }
}

fn same_tree_with<F: LoadForces<'static, f32, f32, N>, const N: usize>(sample: &TreeSample) {
    let bytes = sample.file(Order::Four);
    let core = ModularModel::<N, 3, 24, 2, f32, F>::load(in_flash(&bytes), TREES[1]).unwrap();
    let file = ModelFile::new(&bytes).unwrap();
    same(&file.replica(Some(TREES[1])).unwrap(), &core.system, sample.seed ^ 77);
}

/// Loads bodies both ways; core is compiled for the laws of the file.
fn same_bodies<const N: usize>(laws: Laws<'static>, seed: u64) {
    let sample = BodiesSample::chain(N, laws, seed);
    if laws.contains(Law::Sticking) {
        same_bodies_with::<(Friction<N>, (Directional<f32, N>, Sticking<f32, N>)), N>(&sample);
    } else if laws.contains(Law::Servo) {
        same_bodies_with::<(Friction<N>, Servo<f32, N>), N>(&sample);
    } else if has_networks(laws) {
        same_bodies_with::<All<N>, N>(&sample);
    } else if laws.contains(Law::Coulomb) {
        same_bodies_with::<Friction<N>, N>(&sample);
    } else {
        same_bodies_with::<Viscous<f32, N>, N>(&sample);
    }
}

fn same_bodies_with<F: LoadForces<'static, f32, f32, N>, const N: usize>(sample: &BodiesSample) {
    let bytes = sample.file(Order::Four);
    let core = BodiesModel::<N, f32, F>::load(in_flash(&bytes)).unwrap();
    same(&ModelFile::new(&bytes).unwrap().replica(None).unwrap(), &core.system, sample.seed ^ 77);
}

/// Loads a graph both ways.
fn same_graph<const D: usize>(sample: &GraphSample, part: usize) {
    let bytes = sample.file(Order::Four);
    let words = aligned(&bytes);
    let unused = Holonomic::Anchor { node: 0, to: [0.0; D], length: 1.0 };
    let (mut edges, mut rods) = ([Edge::default(); 16], [unused; 16]);
    let name = GRAPHS[part];
    let core = GraphModel::<D, 2, 16, 2>::load(flash(&words, &bytes), name, &mut edges, &mut rods).unwrap();
    let system = core.system.constrained().unwrap();
    let file = ModelFile::new(&bytes).unwrap();
    let chip = file.replica(Some(name)).unwrap();
    let mut random = Random(sample.seed ^ 77);
    let n = chip.n();
    let [v, u, a] = [0.5, 1.0, 3.0].map(|size| random.vector(n, size));
    let q = sample.positions();
    same_evaluations(&chip, &system, [&q, &v, &u, &a]);
    same_rattle(&chip, &system, Order::Two, [&q, &v, &u]);
    same_rattle(&chip, &system, Order::Four, [&q, &v, &u]);
}

type OnRods<'a, S, const D: usize> = Constrained<'a, f32, S, [Holonomic<f32, D>], D>;

fn vectors<const D: usize>(x: &[f32]) -> Vec<[f32; D]> {
    x.as_chunks().0.to_vec()
}

/// Compares energies, accelerations and inverse dynamics of particles.
fn same_evaluations<S: Particles<f32, D>, const D: usize>(
    chip: &Replica,
    system: &OnRods<S, D>,
    [q, v, u, a]: [&[f32]; 4],
) {
    let mut workspace = vec![0.0; constrained_workspace(system)];
    let (mut evaluator, mut found) = (chip.evaluator().unwrap(), vec![0.0; q.len()]);
    let (mut expected, mut lambda) = (vectors::<D>(q), vec![0.0; system.equations()]);
    let ours = evaluator.energies(q, v).unwrap();
    let theirs = system.system().energies(&vectors(q), &vectors(v), &mut workspace);
    assert_eq!(bits(&[ours.kinetic, ours.potential]), bits(&[theirs.kinetic, theirs.potential]));

    let force = vectors(u);
    let drive = Drive { force: Some(&force), baumgarte: Baumgarte::none() };
    let to = (expected.as_mut_slice(), lambda.as_mut_slice());
    evaluator.acceleration(q, v, u, &mut found).unwrap();
    constrained_acceleration(system, (&vectors(q), &vectors(v)), &drive, &mut workspace, to).unwrap();
    assert_eq!(bits(&found), bits(expected.as_flattened()));

    let state = [q, v, a].map(vectors);
    evaluator.inverse_dynamics(q, v, a, &mut found).unwrap();
    let state = state.each_ref().map(Vec::as_slice);
    constrained_inverse_dynamics(system, state, &mut workspace, &mut expected).unwrap();
    assert_eq!(bits(&found), bits(expected.as_flattened()));

    let n = q.len();
    let mut masses = vec![f32::NAN; n * n];
    evaluator.mass_matrix(q, &mut masses).unwrap();
    for (k, mass) in masses.iter().enumerate() {
        let (row, column) = (k / n, k % n);
        let block = system.system().mass(row / D, &[0.0; D]);
        let theirs = if row / D == column / D { block[row % D][column % D] } else { 0.0 };
        assert_eq!(mass.to_bits(), theirs.to_bits());
    }
}

/// Compares motions of particles from both kinds of beginning.
fn same_rattle<S: Particles<f32, D>, const D: usize>(
    chip: &Replica,
    system: &OnRods<S, D>,
    order: Order,
    [q, v, u]: [&[f32]; 3],
) {
    let (step, force, nodes) = (Step::from(step(order)), vectors(u), q.len() / D);
    let rattle = Rattle::new(step.h, order);
    let mut workspace = vec![0.0; Rattle::workspace(system)];
    let mut memory = vec![0.0; ParticleState::<f32, D>::workspace(nodes, system.equations())];
    let mut theirs =
        ParticleState::new(system, &vectors(q), &vectors(v), &mut memory, &mut workspace).unwrap();
    let (mut ours, mut found) = (chip.motion_at(step, q, v).unwrap(), vec![0.0; q.len()]);
    let mut before = Vec::new();
    for _ in 0..STEPS {
        before = ours.q().to_vec();
        let report = ours.step(Control::held(u)).unwrap();
        assert_eq!(report, rattle.step(system, &mut theirs, Some(&force), &mut workspace).unwrap());
        assert_eq!(bits(ours.q()), bits(theirs.q().as_flattened()));
        assert_eq!(bits(ours.p()), bits(theirs.p().as_flattened()));
        ours.velocity(&mut found).unwrap();
        assert_eq!(bits(&found), bits(theirs.v().as_flattened()));
    }
    let ends = [vectors(&before), vectors(ours.q())];
    let theirs = rattle
        .start(system, ends.each_ref().map(Vec::as_slice), Some(&force), &mut memory, &mut workspace)
        .unwrap();
    let ours = chip.motion_between(step, [&before, ours.q()], Control::held(u)).unwrap();
    assert_eq!(bits(ours.p()), bits(theirs.p().as_flattened()));
}

fn activations() -> impl Strategy<Value = Activation> {
    prop_oneof![Just(Activation::Tanh), Just(Activation::Softplus), Just(Activation::Isru)]
}

fn laws() -> impl Strategy<Value = Laws<'static>> {
    let friction =
        prop_oneof![Just(Laws::NONE), Just(Laws::VISCOUS), Just(Laws::COULOMB), Just(Laws::FRICTION)];
    (friction, 0..4_u8).prop_map(|(laws, networks)| {
        let laws = if networks & 1 == 1 { laws.with_dissipation(NETWORK) } else { laws };
        if networks & 2 == 2 { laws.with_potential(NETWORK) } else { laws }
    })
}

fn widths() -> impl Strategy<Value = [u16; 4]> {
    (1..40_u16, 0..20_u16, 0..20_u16).prop_map(|(a, b, c)| match (b, c) {
        (0, c) => [a, c, 0, 0],
        (b, c) => [a, b, c, 0],
    })
}

fn inertia_network(n: usize) -> impl Strategy<Value = InertiaNetworkSample> {
    let letters = prop::collection::vec(prop_oneof!["t", "a", "c"], n).prop_map(|letters| letters.concat());
    (letters, widths(), activations(), 0..3_u8, laws(), any::<u64>()).prop_map(
        move |(coordinates, widths, activation, inertia, laws, seed)| {
            let inertia = match inertia {
                0 => Inertia::Diagonal,
                1 => Inertia::Cholesky { epsilon: 0.1 },
                _ => Inertia::Factor { rows: (n as u64 + seed % n as u64) as u8, epsilon: 0.1 },
            };
            InertiaNetworkSample { coordinates, widths, activation, inertia, laws, seed }
        },
    )
}

fn chain(n: usize) -> impl Strategy<Value = TreeSample> {
    let pair = prop_oneof![Just(PairInput::Distance), Just(PairInput::Difference), Just(PairInput::Concat)];
    (1..24_u16, pair, laws(), any::<u64>())
        .prop_map(move |(width, pair, laws, seed)| TreeSample::chain(n, width, pair, laws, seed))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn inertia_network_models_have_the_bits_of_core(one in inertia_network(1), three in inertia_network(3), seven in inertia_network(7)) {
        same_inertia_network::<1>(&one);
        same_inertia_network::<3>(&three);
        same_inertia_network::<7>(&seven);
    }

    #[test]
    fn trees_have_the_bits_of_core(one in chain(1), three in chain(3), seven in chain(7)) {
        same_tree::<1>(&one);
        same_tree::<3>(&three);
        same_tree::<7>(&seven);
    }

    #[test]
    fn bodies_have_the_bits_of_core(laws in laws(), more in 0..3_usize, seed: u64) {
        let laws = match more {
            1 if !has_networks(laws) => laws.with(Law::Servo),
            2 if !has_networks(laws) => laws.with(Law::Directional).with(Law::Sticking),
            _ => laws,
        };
        same_bodies::<1>(laws, seed);
        same_bodies::<3>(laws, seed);
        same_bodies::<7>(laws, seed);
    }

    #[test]
    fn graphs_have_the_bits_of_core(nodes in 2..9_u16, width in 1..16_u16, part in 0..2_usize, seed: u64) {
        same_graph::<2>(&GraphSample::row(2, nodes, width, seed), part);
        same_graph::<3>(&GraphSample::row(3, nodes, width, seed), part);
    }
}

#[test]
fn twelve_coordinates_have_the_bits_of_core() {
    let inertia = Inertia::Factor { rows: 20, epsilon: 0.1 };
    let (coordinates, widths) = ("ataaataacaaa".to_owned(), [17, 9, 0, 0]);
    let activation = Activation::Tanh;
    same_inertia_network::<12>(&InertiaNetworkSample {
        coordinates,
        widths,
        activation,
        inertia,
        laws: Laws::FRICTION,
        seed: 5,
    });
    same_tree::<12>(&TreeSample::chain(12, 11, PairInput::Distance, Laws::FRICTION, 5));
}

#[test]
fn weights_in_half_precision_have_the_bits_of_core() {
    let inertia = Inertia::Cholesky { epsilon: 0.1 };
    let (coordinates, widths, activation) = ("ata".to_owned(), [13, 6, 0, 0], Activation::Softplus);
    let sample =
        InertiaNetworkSample { coordinates, widths, activation, inertia, laws: Laws::FRICTION, seed: 9 };
    let block: Vec<u8> = sample.weights().iter().flat_map(|w| f16::from_f32(*w).to_le_bytes()).collect();
    let bytes = bytes(&sample.header(Order::Four), &block);
    let words = aligned(&bytes);
    let core = InertiaNetworkModel::<3, 13, 2, f16, Friction<3>>::load(flash(&words, &bytes)).unwrap();
    let file = ModelFile::new(&bytes).unwrap();
    same(&file.replica(None).unwrap(), &core.system, 9);
}
