//! Every code path that steps a model along commands gives the result of a plain stepper that knows the actuator.

#[path = "../../trainer/replica/tests/common/mod.rs"]
mod samples;

use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Newton, Order, Path, State};
use leastaction_core::energy::graph::{Fixed, Graph, MAX_NETWORKS};
use leastaction_core::energy::inertia_network::Inertia;
use leastaction_core::energy::modular::PairInput;
use leastaction_core::forces::{
    ControlKind, Coulomb, Dissipation, Forces, PotentialCorrection, System, Viscous,
};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::model::{ActuatorBytes, Family, Header, Laws, TrainedStep};
use leastaction_core::network::Activation;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::horizons::Predictor;
use leastaction_learning::windows::WindowLogs;
use leastaction_models::file::decode;
use leastaction_models::{Beginning, DEPTH, HostTypes, MAX_ELEMENT_UNITS, Model};
use samples::{BodiesSample, GraphSample, InertiaNetworkSample, NETWORK, TREES, TreeSample, bytes};

/// Step size, exact in single precision, like in the file.
const H: f64 = 1.0 / 128.0;
const STEPS: usize = 40;
const TOLERANCE: f64 = 1e-9;
const NEWTON: Newton<f64> = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-8 };

type Damped<const N: usize> = Viscous<f64, N>;
type Dry<const N: usize> = (Damped<N>, Coulomb<f64, N>);
type Networks<'w, const N: usize> = (Dissipation<'w, f64, N, 8, 2>, PotentialCorrection<'w, f64, N, 8, 2>);
type All<'w, const N: usize> = (Dry<N>, Networks<'w, N>);

/// Gains and offsets of coordinates (taken in turn), and delays of zero, a fraction of a step, and whole steps with a fraction.
const ACTUATORS: [(&[(f32, f32)], f32); 3] = [
    (&[(1.0, 0.25), (0.75, -0.5)], 0.0),
    (&[(1.5, 0.0), (-0.5, 0.125), (1.0, 0.5)], 0.003),
    (&[(0.75, 0.5), (2.0, -0.25)], 0.02),
];

fn actuator_bytes(index: usize, n: usize) -> Vec<u8> {
    let (pairs, delay) = ACTUATORS[index];
    let pairs = pairs.iter().cycle().take(n).flat_map(|(gain, offset)| [*gain, *offset]);
    std::iter::once(delay).chain(pairs).flat_map(f32::to_le_bytes).collect()
}

/// The file of a sample with this actuator and step, as a model on the host.
fn model(header: &Header, weights: &[f32], (index, n): (usize, usize), step: (Order, ControlKind)) -> Model {
    let actuator = actuator_bytes(index, n);
    let trained_step = Some(TrainedStep { order: step.0, h: H as f32, control: step.1 });
    let header = Header { actuator: Some(ActuatorBytes::new(&actuator).unwrap()), trained_step, ..*header };
    let block: Vec<u8> = weights.iter().flat_map(|w| w.to_le_bytes()).collect();
    decode(&bytes(&header, &block)).unwrap()
}

/// Smoothly changing commands, of sample k and coordinate i.
fn command(k: usize, i: usize) -> f64 {
    let t = H * k as f64;
    0.5 * (9.0 * t + i as f64).sin() + 0.25 * (23.0 * t - 2.0 * i as f64).cos()
}

/// Control τ at both ends of the step from sample k on, by the definition of the actuator: it has the impulse and the moment of g u(t − d)
/// + o, whose smooth parts are integrated by Gauss's rule.
fn naive_control<const N: usize>(index: usize, kind: ControlKind, k: usize) -> Control<f64, N> {
    let (pairs, delay) = ACTUATORS[index];
    let late = f64::from(delay) / H;
    let (whole, part) = (late.floor() as usize, late.fract());
    let at = |sample: usize, i: usize| command(sample.saturating_sub(whole + 1).min(STEPS), i);
    let mut control = Control { start: [0.0; N], end: [0.0; N] };
    for i in 0..N {
        let (gain, offset) = pairs[i % pairs.len()];
        // Samples k, k + 1, k + 2 of `at` are those before the first part, between the parts, and after the second.
        let force = |piece: usize, s: f64| {
            let u = match kind {
                ControlKind::Held => at(k + piece, i),
                ControlKind::Linear => {
                    let (from, to) = (at(k + piece, i), at(k + piece + 1, i));
                    let along = if piece == 0 { s + 1.0 - part } else { s - part };
                    from + along * (to - from)
                }
            };
            f64::from(gain) * u + f64::from(offset)
        };
        let (mut mean, mut moment) = (0.0, 0.0);
        for (piece, [from, to]) in [[0.0, part], [part, 1.0]].into_iter().enumerate() {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            for sign in [-1.0, 1.0] {
                let s = middle + sign * half / 3.0_f64.sqrt();
                mean += half * force(piece, s);
                moment += half * (s - 0.5) * force(piece, s);
            }
        }
        (control.start[i], control.end[i]) = (mean - 6.0 * moment, mean + 6.0 * moment);
    }
    control
}

/// Positions at the samples from a state on, computed by core's own step.
fn naive<P: Path, L, F, const N: usize>(
    system: &System<L, F>,
    mut state: State<f64, N>,
    (index, kind, first): (usize, ControlKind, usize),
) -> Vec<[f64; N]>
where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    let del = Del::<f64, P>::with_newton(H, NEWTON);
    let mut positions = vec![state.q()];
    for k in first..STEPS {
        del.step(system, &mut state, &naive_control(index, kind, k)).expect("a step");
        positions.push(state.q());
    }
    positions
}

fn assert_close<const N: usize>(what: &str, found: &[f64], expected: &[[f64; N]]) {
    assert_eq!(found.len(), N * expected.len(), "{what}");
    for (k, (found, expected)) in found.iter().zip(expected.as_flattened()).enumerate() {
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < TOLERANCE, "{what}, number {k}: {found} instead of {expected}");
    }
}

/// Compares every result of a model for a motion with the plain stepper.
fn compare<P: Path, L, F, const N: usize>(
    name: &str,
    model: &Model,
    system: &System<L, F>,
    (index, kind): (usize, ControlKind),
    q: [f64; N],
) where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    let order = model.facts.trained_step.unwrap().order.number();
    let v: [f64; N] = std::array::from_fn(|i| 0.5 - 0.25 * i as f64);
    let start = State::new(&system.lagrangian, q, v).unwrap();
    let expected = naive::<P, _, _, N>(system, start, (index, kind, 0));
    let rows = |of: &dyn Fn(usize, usize) -> f64| {
        let all = (0..=STEPS).flat_map(|k| (0..N).map(move |i| (k, i)));
        Rows::from_flat(N, all.map(|(k, i)| of(k, i)).collect()).unwrap()
    };
    let (q, u) = (rows(&|k, i| expected[k][i]), rows(&command));
    let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: Some(u) };
    let data = Dataset { n: N, h: H, control: Some(kind), trajectories: vec![trajectory] };

    let run = model.rollout(order, (&data, Beginning::Positions)).unwrap();
    assert_close(&format!("{name}: rollout from positions"), &run[0], &expected);
    let errors = model.one_steps(order, &data).unwrap();
    let unlike = errors.iter().position(|error| error.is_none_or(|error| error > TOLERANCE * TOLERANCE));
    assert_eq!((errors.len(), unlike), (STEPS - 1, None), "{name}: one step");

    let logs = WindowLogs::new(&data);
    let predictions = Predictor { model, zeros: &[], logs: &logs }.predict().unwrap();
    let page = &predictions.logs[0];
    let [q, v] = [0, 1].map(|part| std::array::from_fn(|i| page.start()[i][part]));
    let start = State::new(&system.lagrangian, q, v).unwrap();
    let expected = naive::<P, _, _, N>(system, start, (index, kind, page.first));
    assert_close(&format!("{name}: the page's prediction"), &page.path, &expected);

    let mut moving = data.clone();
    moving.trajectories[0].v = Some(rows(&|_, i| v[i]));
    let run = model.rollout(order, (&moving, Beginning::Velocity)).unwrap();
    let second: [f64; N] = data.trajectories[0].q[1].try_into().unwrap();
    let start = State::new(&system.lagrangian, second, v).unwrap();
    let expected = naive::<P, _, _, N>(system, start, (index, kind, 1));
    assert_close(&format!("{name}: rollout from a velocity"), &run[0][N..], &expected);
}

/// Both orders, kinds of control and all actuators.
fn over_all<L, F, const N: usize>(
    name: &str,
    (header, weights): (&dyn Fn(Order) -> Header<'static>, &[f32]),
    part: Option<&str>,
    system: &System<L, F>,
    q: [f64; N],
) where
    L: Lagrangian<f64, N>,
    F: Forces<f64, N>,
{
    for kind in [ControlKind::Held, ControlKind::Linear] {
        for index in 0..ACTUATORS.len() {
            for order in [Order::Two, Order::Four] {
                let mut own = model(&header(order), weights, (index, N), (order, kind));
                if let Some(part) = part {
                    own.architecture = own.architecture.with_part_named(part).unwrap();
                }
                let name = format!("{name}, {kind:?}, actuator {index}, order {order}");
                match order {
                    Order::Two => compare::<Midpoint, _, _, N>(&name, &own, system, (index, kind), q),
                    Order::Four => compare::<Galerkin, _, _, N>(&name, &own, system, (index, kind), q),
                }
            }
        }
    }
}

/// Calls a check for every set of laws that coordinates allow, with the type of the forces of that set.
macro_rules! with_laws {
    ($check:ident) => {{
        let networks = Laws::FRICTION.with_dissipation(NETWORK).with_potential(NETWORK);
        $check::<Damped<_>>("damped", Laws::VISCOUS);
        $check::<Dry<_>>("dry", Laws::FRICTION);
        $check::<All<_>>("networks", networks);
    }};
}

fn doubles(weights: &[f32]) -> &'static [f64] {
    weights.iter().map(|w| f64::from(*w)).collect::<Vec<_>>().leak()
}

fn inertia_network<F: leastaction_core::model::LoadForces<'static, f64, f64, 2> + Forces<f64, 2>>(
    laws_name: &str,
    laws: Laws<'static>,
) {
    let sample: &'static InertiaNetworkSample = Box::leak(Box::new(InertiaNetworkSample {
        coordinates: "aa".to_owned(),
        widths: [5, 4, 0, 0],
        activation: Activation::Tanh,
        inertia: Inertia::Cholesky { epsilon: 0.5 },
        laws,
        seed: 3,
    }));
    let (weights, header) = (sample.weights(), |order| sample.header(order));
    let Family::InertiaNetwork(inertia_network) = header(Order::Two).family else { unreachable!() };
    let system = inertia_network.system::<f64, f64, F, 2, 8, 2>(laws, doubles(&weights)).unwrap();
    over_all(&format!("inertia network, {laws_name}"), (&header, &weights), None, &system, [0.25, -0.5]);
}

fn modular<F: leastaction_core::model::LoadForces<'static, f64, f64, 3> + Forces<f64, 3>>(
    laws_name: &str,
    laws: Laws<'static>,
) {
    let sample: &'static TreeSample =
        Box::leak(Box::new(TreeSample::chain(3, 6, PairInput::Distance, laws, 4)));
    let (weights, header) = (sample.weights(), |order| sample.header(order));
    let Family::Modular(modular) = header(Order::Two).family else { unreachable!() };
    let tree = modular.trees().find(|tree| tree.name == TREES[1]).unwrap();
    let system = modular.system::<f64, f64, F, 3, 3, 8, 2>(tree, laws, doubles(&weights)).unwrap();
    let name = format!("modular, {laws_name}");
    over_all(&name, (&header, &weights), Some(TREES[1]), &system, [0.25, -0.5, 0.75]);
}

fn bodies<F: leastaction_core::model::LoadForces<'static, f64, f64, 4> + Forces<f64, 4>>(
    laws_name: &str,
    laws: Laws<'static>,
) {
    let sample: &'static BodiesSample = Box::leak(Box::new(BodiesSample::chain(4, laws, 5)));
    let (weights, header) = (sample.weights(), |order| sample.header(order));
    let Family::Bodies(bodies) = header(Order::Two).family else { unreachable!() };
    let system = bodies.system::<f64, f64, F, 4>(laws, doubles(&weights)).unwrap();
    over_all(&format!("bodies, {laws_name}"), (&header, &weights), None, &system, [0.25, -0.5, 0.75, 0.0]);
}

#[test]
fn an_inertia_network_is_stepped_with_its_actuator() {
    with_laws!(inertia_network);
}

#[test]
fn a_tree_is_stepped_with_its_actuator() {
    with_laws!(modular);
}

#[test]
fn bodies_are_stepped_with_their_actuator() {
    with_laws!(bodies);
}

#[test]
fn an_arm_is_stepped_with_its_actuator() {
    let file: &'static [u8] = leastaction_tests::arm::model_file().unwrap().leak();
    let words: &'static mut [u32] = vec![0; file.len().div_ceil(4)].leak();
    bytemuck::cast_slice_mut(words)[..file.len()].copy_from_slice(file);
    let parsed = leastaction_core::model::parse(&bytemuck::cast_slice(words)[..file.len()]).unwrap();
    let weights: Vec<f32> = parsed.weights.iter().collect();
    let Family::Arm(arm) = parsed.header.family else { unreachable!() };
    let system = arm.system::<f64, f64, Damped<7>, 7>(parsed.header.laws, doubles(&weights)).unwrap();
    let header = parsed.header;
    let q = [0.25, -0.5, 0.75, -1.0, 0.5, 0.25, -0.25];
    over_all("arm, damped", (&|_| header, &weights), None, &system, q);
}

#[test]
fn a_graph_with_drag_is_stepped_with_its_actuator() {
    let sample: &'static GraphSample = Box::leak(Box::new(GraphSample::row(2, 3, 6, 7)));
    let (weights, header) = (sample.weights(), |order| sample.header(order));
    let own = model(&header(Order::Two), &weights, (0, 6), (Order::Two, ControlKind::Held));
    let graph = own.architecture.family.graph().unwrap();
    let (numbers, layout) = (doubles(&weights), graph.graph().unwrap());
    let fixed = || {
        let types: HostTypes<'_, f64, 2> = graph.host_types(numbers).unwrap();
        let particles = Graph::new(types, &layout.nodes, &layout.edges).unwrap();
        Fixed::<f64, 2, MAX_NETWORKS, MAX_ELEMENT_UNITS, DEPTH, 6>::new(particles).unwrap()
    };
    let system = System { lagrangian: fixed(), forces: fixed() };
    let q: Vec<f64> = sample.positions().iter().map(|x| f64::from(*x)).collect();
    over_all("graph, drag", (&header, &weights), None, &system, q.try_into().unwrap());
}
