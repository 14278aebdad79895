//! The slice interface of systems in generalised coordinates gives the same results as core's types, bit for bit.

mod common;

use common::{
    BodiesSample, InertiaNetworkSample, NETWORK, Random, STEPS, TREES, TreeSample, aligned, bits, bytes,
    file, flash, step,
};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::discrete::{
    Control as CoreControl, Del, Galerkin, Midpoint, Order, Path, State, StepError,
};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::forces::{
    Directional, Dissipation, Forces, PotentialCorrection, Servo, Sticking, Stops, System, Viscous,
};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{BodiesModel, InertiaNetworkModel, Law, Laws, LoadForces, ModularModel};
use leastaction_core::network::Activation;
use leastaction_core::scalar::f16;
use leastaction_replica::{Control, Friction, ModelFile, Motion, Replica, ReplicaError, Step};
use proptest::prelude::*;

/// Bytes that live as long as the program, like those in flash.
fn in_flash(bytes: &[u8]) -> &'static [u8] {
    flash(aligned(bytes).leak(), bytes)
}

fn sized<const N: usize>(x: &[f32]) -> [f32; N] {
    x.try_into().unwrap()
}

/// Position q and momentum p, as bits, and the report of the step that led there or the reason why it was refused.
///
/// Random numbers of laws now and then give equations without a solution: both sides must refuse them alike.
type Stepped = (Vec<u32>, String);

fn stepped(motion: &mut dyn Motion, controls: &[[Vec<f32>; 2]]) -> Vec<Stepped> {
    let mut all = vec![(bits(&[motion.q(), motion.p()].concat()), String::new())];
    for [start, end] in controls {
        let outcome = reason(motion.step(Control { start, end }));
        all.push((bits(&[motion.q(), motion.p()].concat()), format!("{outcome:?}")));
    }
    all
}

/// The result of a step of the replica with the error of core's step.
fn reason<T>(result: Result<T, ReplicaError>) -> Result<T, StepError<f32>> {
    result.map_err(|error| match error {
        ReplicaError::Step(error) => error,
        other => panic!("{other}"),
    })
}

/// Steps a motion by core's types.
fn stepped_by_core<P: Path, L, F, const N: usize>(
    del: &Del<f32, P>,
    system: &System<L, F>,
    mut state: State<f32, N>,
    controls: &[[Vec<f32>; 2]],
) -> Vec<Stepped>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    let mut all = vec![(bits(&[state.q(), state.p()].concat()), String::new())];
    for [start, end] in controls {
        let control = CoreControl { start: sized(start), end: sized(end) };
        let outcome = del.step(system, &mut state, &control);
        all.push((bits(&[state.q(), state.p()].concat()), format!("{outcome:?}")));
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
    let ours = reason(evaluator.inverse_dynamics(&q, &v, &a, &mut found)).map(|()| bits(&found));
    let theirs = inverse_dynamics(system, &sized(&q), &sized(&v), &sized::<N>(&a)).map(|tau| bits(&tau));
    assert_eq!(format!("{ours:?}"), format!("{theirs:?}"));
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
    let theirs = del.start(system, &sized(q), &sized(&q1), &between);
    let ours = reason(chip.motion_between(step, [q, &q1], Control { start, end }));
    let ours = ours.map(|mut motion| stepped(&mut *motion, controls));
    let theirs = theirs.map(|state| stepped_by_core(&del, system, state, controls));
    assert_eq!(format!("{ours:?}"), format!("{theirs:?}"));
}

/// Laws compiled for the sizes of the sample's networks rather than for the maximum sizes of this crate.
type All<const N: usize> =
    (Friction<N>, (Dissipation<'static, f32, N, 6, 2>, PotentialCorrection<'static, f32, N, 6, 2>));

/// Laws of axes with end stops.
type Stopped<const N: usize> = (Friction<N>, (Directional<f32, N>, (Sticking<f32, N>, Stops<f32, N>)));

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
    if laws.contains(Law::Stops) {
        same_bodies_with::<Stopped<N>, N>(&sample);
    } else if laws.contains(Law::Sticking) {
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
    fn bodies_have_the_bits_of_core(laws in laws(), more in 0..4_usize, seed: u64) {
        let laws = match more {
            1 if !has_networks(laws) => laws.with(Law::Servo),
            2 if !has_networks(laws) => laws.with(Law::Directional).with(Law::Sticking),
            3 if !has_networks(laws) => laws.with(Law::Sticking).with(Law::Stops),
            _ => laws,
        };
        same_bodies::<1>(laws, seed);
        same_bodies::<3>(laws, seed);
        same_bodies::<7>(laws, seed);
    }
}

/// Friction of two laws that together grows faster than the load: no force gives the acceleration.
#[test]
fn loads_without_a_solution_are_refused_alike() {
    let laws = Laws::COULOMB.with(Law::Directional).with(Law::Sticking);
    same_bodies::<1>(laws, 964_326_188_346_000_122);
    same_bodies::<3>(laws, 964_326_188_346_000_122);
    same_bodies::<7>(laws, 964_326_188_346_000_122);
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

/// Axes that run against their stops, and rest on them, step with the bits of core.
#[test]
fn stops_have_the_bits_of_core() {
    const N: usize = 3;
    let mut ended = 0;
    for seed in 0..8 {
        let laws = Laws::FRICTION.with(Law::Sticking).with(Law::Stops);
        let sample = BodiesSample::chain(N, laws, seed);
        let mut weights = sample.weights();
        let stops = [[0.25, 0.015625, 0.5], [-0.5, 0.03125, 0.0], [0.0, f32::MAX, 1.0]];
        let first = weights.len() - stops.as_flattened().len();
        weights[first..].copy_from_slice(stops.as_flattened());
        let bytes = file(&sample.header(Order::Four), &weights);
        let core = BodiesModel::<N, f32, Stopped<N>>::load(in_flash(&bytes)).unwrap();
        let model = ModelFile::new(&bytes).unwrap();
        let chip = model.replica(None).unwrap();
        let mut random = Random(seed);
        let controls: Vec<_> = (0..40).map(|_| [random.vector(N, 9.0), random.vector(N, 9.0)]).collect();
        let start = [&[0.25, -0.5, 0.0][..], &[1.0, -0.75, 0.5]];
        same_motion::<Midpoint, _, _, N>(&chip, Order::Two, &core.system, start, &controls);
        same_motion::<Galerkin, _, _, N>(&chip, Order::Four, &core.system, start, &controls);
        ended += on_stops(&chip, start, &controls);
    }
    assert!(ended > 40, "only {ended} steps ended on a stop");
}

/// Number of steps that end with a coordinate exactly on its stop.
fn on_stops(chip: &Replica, [q, v]: [&[f32]; 2], controls: &[[Vec<f32>; 2]]) -> usize {
    let mut motion = chip.motion_at(Step::from(step(Order::Two)), q, v).unwrap();
    let ends = controls.iter().filter(|[start, end]| {
        motion.step(Control { start, end }).unwrap();
        let q = motion.q();
        [0.234375, 0.265625].contains(&q[0]) || [-0.53125, -0.46875].contains(&q[1])
    });
    ends.count()
}
