//! A machine of three bodies that takes up loads, and its model.
#![allow(dead_code, reason = "each test file uses its share")]

use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::arm::{ARM_PARAMETERS, ArmBodies, BodyTree};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, System, Viscous};
use leastaction_core::model::{ArmHeader, Family, Header, Laws, write};
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::Model;
use leastaction_models::file::decode;

pub const N: usize = 3;
pub const H: f64 = 4e-3;
/// A column that turns, and two links that swing on it.
pub const TREE: &[u8] = &[0, 0, 0, 1, 0, 2];
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
pub struct Machine {
    pub mass: f64,
    pub friction: f64,
}

pub const AS_LEARNED: Machine = Machine { mass: 0.0, friction: 1.0 };

impl Machine {
    pub fn weights(self) -> Vec<f64> {
        let (mut bodies, m, x) = (BODIES, self.mass, 0.5);
        let load = [m, m * x, 0.0, 0.0, 0.0, 0.0, m * x * x, 0.0, 0.0, m * x * x];
        bodies[N - 1][15..25].iter_mut().zip(load).for_each(|(own, more)| *own += more);
        [&GRAVITY, bodies.as_flattened()].concat()
    }

    pub fn forces(self) -> (Viscous<f64, N>, Coulomb<f64, N>) {
        let dry = |[constant, load, smoothing, width]: [f64; 4]| DryFriction {
            constant: self.friction * constant,
            load,
            smoothing,
            width,
        };
        let coefficients = VISCOUS.map(|b| self.friction * b);
        (Viscous { coefficients }, Coulomb { coordinates: DRY.map(dry) })
    }

    /// Forces in single precision.
    pub fn forces_f32(self) -> (Viscous<f32, N>, Coulomb<f32, N>) {
        let (Viscous { coefficients }, Coulomb { coordinates }) = self.forces();
        let single = |dry: DryFriction<f64>| DryFriction {
            constant: dry.constant as f32,
            load: dry.load as f32,
            smoothing: dry.smoothing as f32,
            width: dry.width as f32,
        };
        (
            Viscous { coefficients: coefficients.map(|b| b as f32) },
            Coulomb { coordinates: coordinates.map(single) },
        )
    }

    /// Readings of positions with encoders of 2¹⁴ steps a turn, and torques with noise.
    pub fn log(self, seconds: f64, seed: u64) -> Dataset {
        self.wearing(seconds, seed, 0.0)
    }

    /// Readings while all friction grows by `growth` times its own, linearly.
    pub fn wearing(self, seconds: f64, seed: u64, growth: f64) -> Dataset {
        self.under(seconds, seed, |t| {
            Machine { friction: self.friction * (1.0 + growth * t / seconds), ..self }.forces()
        })
    }

    /// Readings under forces that depend on the time.
    pub fn under<F: Forces<f64, N>>(self, seconds: f64, seed: u64, forces: impl Fn(f64) -> F) -> Dataset {
        let weights = self.weights();
        let mut block = weights.as_slice();
        let tree = BodyTree::new(ArmHeader { bodies: TREE }.bodies().flatten()).expect("a tree");
        let lagrangian = ArmBodies::take(&mut block, tree).expect("weights");
        let mut state = ContinuousState { q: [0.2, 0.4, 0.5], v: [0.0; N] };
        let (mut q, mut u, mut random) = (Vec::new(), Vec::new(), seed.wrapping_mul(2).wrapping_add(1));
        for k in 0..(seconds / H) as usize {
            let command = drive(&state, k as f64 * H, &mut random);
            q.push(state.q.map(|q| (q * GRID).round() / GRID));
            u.push(command);
            let system = System { lagrangian, forces: forces(k as f64 * H) };
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

pub fn model() -> Model {
    model_with(Laws::FRICTION, &[])
}

/// The model with laws beside friction, and their numbers.
pub fn model_with(laws: Laws, numbers: &[f64]) -> Model {
    let header = Header { laws, ..Header::new(Family::Arm(ArmHeader { bodies: TREE })) };
    let weights = [&AS_LEARNED.weights()[..], &VISCOUS, DRY.as_flattened(), numbers].concat();
    let bytes: Vec<u8> = weights.iter().flat_map(|w| (*w as f32).to_le_bytes()).collect();
    let mut memory = vec![0; 4096];
    let file = write(&header, &bytes, &mut memory).expect("a file");
    decode(file).expect("a model")
}
