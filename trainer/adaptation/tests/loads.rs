//! Loads on simulated machines: how they are found, announced, and given to the model.

use leastaction_adaptation::{AdaptationError, Choice, Course, Request, along, deviations, on_chip};
use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::arm::{ARM_PARAMETERS, ArmBodies, BodyTree};
use leastaction_core::forces::{Coulomb, DryFriction, System, Viscous};
use leastaction_core::model::{ArmHeader, Family, Header, Laws, write};
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::Model;
use leastaction_models::file::decode;

const N: usize = 3;
const H: f64 = 4e-3;
/// A column that turns, and two links that swing on it.
const TREE: &[u8] = &[0, 0, 0, 1, 0, 2];
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.75];

/// Numbers of the bodies; the origins of the links are half a metre apart.
#[rustfmt::skip]
const BODIES: [[f64; ARM_PARAMETERS]; N] = [
    [
        1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.25, 0.0, 0.0, 1.0,
        2.0, 0.0, 0.0, 0.125, 0.125, 0.0, 0.125, 0.0, 0.0, 0.125, 0.125,
    ],
    [
        1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.25, 0.0, 1.0, 0.0,
        2.0, 0.5, 0.0, 0.0, 0.03125, 0.0, 0.25, 0.0, 0.0, 0.25, 0.125,
    ],
    [
        1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0,
        1.0, 0.25, 0.0, 0.0, 0.03125, 0.0, 0.125, 0.0, 0.0, 0.125, 0.0625,
    ],
];
const VISCOUS: [f64; N] = [0.5, 0.5, 0.25];
/// c, c_load, τ_s, ε.
const DRY: [[f64; 4]; N] = [[0.5, 0.0, 1.0, 0.0625], [0.5, 0.0, 1.0, 0.0625], [0.25, 0.0, 1.0, 0.0625]];

/// A load of `mass` at half a metre from the last joint, and friction times a factor.
#[derive(Clone, Copy)]
struct Machine {
    mass: f64,
    friction: f64,
}

const AS_LEARNED: Machine = Machine { mass: 0.0, friction: 1.0 };

impl Machine {
    fn weights(self) -> Vec<f64> {
        let (mut bodies, m, x) = (BODIES, self.mass, 0.5);
        let load = [m, m * x, 0.0, 0.0, 0.0, 0.0, m * x * x, 0.0, 0.0, m * x * x];
        bodies[N - 1][15..25].iter_mut().zip(load).for_each(|(own, more)| *own += more);
        [&GRAVITY, bodies.as_flattened()].concat()
    }

    fn forces(self) -> (Viscous<f64, N>, Coulomb<f64, N>) {
        let dry = |[constant, load, smoothing, width]: [f64; 4]| DryFriction {
            constant: self.friction * constant,
            load,
            smoothing,
            width,
        };
        let coefficients = VISCOUS.map(|b| self.friction * b);
        (Viscous { coefficients }, Coulomb { coordinates: DRY.map(dry) })
    }

    /// Readings of positions with encoders of 2¹⁴ steps a turn, and torques, after `still` seconds at rest against gravity and noise of the torques.
    fn log(self, seconds: f64, seed: u64) -> Dataset {
        let weights = self.weights();
        let mut block = weights.as_slice();
        let tree = BodyTree::new(ArmHeader { bodies: TREE }.bodies().flatten()).expect("a tree");
        let lagrangian = ArmBodies::take(&mut block, tree).expect("weights");
        let system = System { lagrangian, forces: self.forces() };
        let mut state = ContinuousState { q: [0.2, 0.4, 0.5], v: [0.0; N] };
        let (mut q, mut u, mut random) = (Vec::new(), Vec::new(), seed.wrapping_mul(2).wrapping_add(1));
        for k in 0..(seconds / H) as usize {
            let command = drive(&state, k as f64 * H, &mut random);
            q.push(state.q.map(|q| (q * GRID).round() / GRID));
            u.push(command);
            for _ in 0..4 {
                state = rk4_step(&system, &state, &command, H / 4.0).expect("a step");
            }
        }
        let rows = |of: &[[f64; N]]| Rows::from_arrays(of);
        let trajectory = Trajectory { id: 0, t0: 0.0, q: rows(&q), v: None, a: None, u: Some(rows(&u)) };
        Dataset { n: N, h: H, control: None, trajectories: vec![trajectory] }
    }
}

/// Steps of the encoders per radian.
const GRID: f64 = 16384.0 / std::f64::consts::TAU;

/// A feedback along waves, held over a tick, with some noise.
fn drive(state: &ContinuousState<f64, N>, t: f64, random: &mut u64) -> [f64; N] {
    core::array::from_fn(|i| {
        *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let noise = 0.1 * ((*random >> 40) as f64 / f64::from(1 << 24) - 0.5);
        let wave = |k: f64| (0.5 + 0.2 * i as f64) * (k * t + 1.3 * i as f64 * k).sin() / k;
        let target = wave(1.1) + wave(2.3) + wave(3.7);
        [30.0, 60.0, 30.0][i] * (target - state.q[i]) - [6.0, 8.0, 4.0][i] * state.v[i] + noise
    })
}

fn model() -> Model {
    let header = Header { laws: Laws::FRICTION, ..Header::new(Family::Arm(ArmHeader { bodies: TREE })) };
    let weights = [&AS_LEARNED.weights()[..], &VISCOUS, DRY.as_flattened()].concat();
    let bytes: Vec<u8> = weights.iter().flat_map(|w| (*w as f32).to_le_bytes()).collect();
    let mut memory = vec![0; 4096];
    let file = write(&header, &bytes, &mut memory).expect("a file");
    decode(file).expect("a model")
}

fn choice(request: &Request) -> Choice {
    let model = model();
    let mut choice = Choice::new(&model, H, request).expect("a choice");
    let log = AS_LEARNED.log(30.0, 1);
    let found = on_chip(&model, |chip| deviations((&model, chip), &choice, &log)).expect("deviations");
    choice.settings.deviation = found.into_iter().map(|deviation| deviation as f32).collect();
    choice
}

fn follow(choice: &Choice, log: &Dataset) -> Course {
    let model = model();
    on_chip(&model, |chip| along((&model, chip), choice, log)).expect("a course")
}

#[test]
fn a_load_is_found_and_announced() {
    let choice = choice(&Request::default());
    let course = follow(&choice, &Machine { mass: 1.0, ..AS_LEARNED }.log(20.0, 2));
    let mass = course.entries.last().expect("windows").estimates[0];
    assert!((mass.estimate - 1.0).abs() < 0.03, "{mass:?}");
    assert!(mass.error < 0.01 && (mass.estimate - 1.0).abs() < 4.0 * mass.error, "{mass:?}");
    let (_, announced) = course.announced.expect("an announcement");
    assert!(course.moving < 3.0, "after {} s: {announced:?}", course.moving);
    assert!(course.entries.iter().all(|entry| !entry.unlike));
}

#[test]
fn the_adapted_model_carries_the_load() {
    let (choice, model, loaded) = (choice(&Request::default()), model(), Machine { mass: 1.0, ..AS_LEARNED });
    let course = follow(&choice, &loaded.log(20.0, 2));
    let applied = &course.entries.last().expect("windows").applied;
    let adapted = choice.adapted(&model, applied).expect("a model");
    let log = loaded.log(10.0, 7);
    let unexplained =
        |model: &Model| on_chip(model, |chip| deviations((model, chip), &choice, &log)).expect("deviations");
    for (before, after) in unexplained(&model).into_iter().zip(unexplained(&adapted)) {
        assert!(after < 0.01 * before, "{after} N m of {before} N m");
    }
}

#[test]
fn nothing_is_announced_where_nothing_is_attached() {
    let choice = choice(&Request::default());
    for seed in 3..6 {
        let course = follow(&choice, &AS_LEARNED.log(30.0, seed));
        assert_eq!(course.announced, None);
        let mass = course.entries.last().expect("windows").estimates[0];
        assert!(mass.estimate.abs() < 4.0 * mass.error, "{mass:?}");
        assert!(course.entries.iter().all(|entry| !entry.changed));
    }
}

#[test]
fn friction_that_grew_is_followed() {
    let choice = choice(&Request::default());
    let course = follow(&choice, &Machine { mass: 0.0, friction: 1.5 }.log(30.0, 9));
    let last = course.entries.last().expect("windows");
    let friction = choice.settings.numbers.iter().zip(&last.estimates).skip(10 + N);
    for (number, found) in friction {
        let grown = f64::from(found.estimate / number.model);
        assert!((grown - 0.5).abs() < 0.15, "{:?}: {grown}", number.number);
    }
    assert_eq!(course.announced, None);
}

#[test]
fn wrong_requests_are_refused() {
    let (model, log) = (model(), AS_LEARNED.log(2.0, 1));
    let request = Request { body: Some(3), ..Request::default() };
    let expected = AdaptationError::NoSuchBody { found: 3, count: 3 };
    assert_eq!(Choice::new(&model, H, &request), Err(expected));
    let long = choice(&Request { window: Some(10.0), ..Request::default() });
    let short = on_chip(&model, |chip| deviations((&model, chip), &long, &log));
    assert!(matches!(short, Err(AdaptationError::TooShort { .. })), "{short:?}");
    let mut bare = log.clone();
    bare.trajectories[0].u = None;
    let bare = on_chip(&model, |chip| along((&model, chip), &long, &bare)).map(|_| ());
    assert_eq!(bare, Err(AdaptationError::NoCommands { id: 0 }));
}
