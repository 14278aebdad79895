//! A simulated Franka Panda: frames and limits of the real arm, bodies and friction of its size, noisy sensors.

use leastaction_data::Rows;
use leastaction_learning::torque::excitation::{Search, excite};
use leastaction_learning::torque::fit::{Arm, JointNumbers};
use leastaction_learning::torque::series::Series;
use leastaction_learning::torque::{Preparation, Samples};
use leastaction_models::tree::{Body, Inertia, Joint, Limits, Pose, Tree};
use leastaction_tests::panda::{BODIES, LIMITS};
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{FRAC_PI_2, TAU};

const N: usize = 7;
/// Modified Denavit–Hartenberg numbers α, a and d.
const FRAMES: [[f64; 3]; N] = [
    [0.0, 0.0, 0.333],
    [-FRAC_PI_2, 0.0, 0.0],
    [FRAC_PI_2, 0.0, 0.316],
    [FRAC_PI_2, 0.0825, 0.0],
    [-FRAC_PI_2, -0.0825, 0.384],
    [FRAC_PI_2, 0.0, 0.0],
    [FRAC_PI_2, 0.088, 0.0],
];
/// Rotor, viscous friction, Coulomb friction, its growth with the load, its width, offset; of the size that fits to the real arm's log
/// give.
const JOINTS: [[f64; 6]; N] = [
    [0.2, 0.25, 0.45, 0.0, 0.05, 0.1],
    [0.2, 0.30, 0.50, 0.02, 0.06, -0.2],
    [0.15, 0.20, 0.40, 0.0, 0.05, 0.1],
    [0.15, 0.25, 0.45, 0.02, 0.06, 0.15],
    [0.05, 0.10, 0.30, 0.01, 0.08, 0.05],
    [0.05, 0.10, 0.25, 0.0, 0.07, -0.05],
    [0.05, 0.08, 0.20, 0.0, 0.08, 0.0],
];
/// Step of the log, s.
pub const STEP: f64 = 1e-3;

/// Sensor noise: of positions (rad), of torques independently at every sample, and of torques with a correlation time `MEMORY` (N m for the
/// first four joints, a quarter of it for the rest).
#[derive(Clone, Copy)]
pub struct Noise {
    pub encoder: f64,
    pub torque: f64,
    pub drift: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self { encoder: 5e-5, torque: 0.2, drift: 0.1 }
    }
}

/// Correlation time of the drifts, s.
const MEMORY: f64 = 0.1;

/// The arm's frames, without bodies or with those of Gaz et al.
fn tree(with_bodies: bool) -> Tree {
    let body = |k: usize| {
        let [alpha, a, d] = FRAMES[k];
        let [from, to, velocity, effort] = LIMITS[k];
        let [m, x, y, z, xx, xy, xz, yy, yz, zz] = BODIES[k];
        let about = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let inertia = if with_bodies {
            Inertia::of_centre(m, Vector3::new(x, y, z), about)
        } else {
            Inertia::default()
        };
        Body {
            name: format!("link{}", k + 1),
            joint_name: format!("joint{}", k + 1),
            parent: k.checked_sub(1),
            joint: Joint::Revolute(Vector3::z_axis()),
            pose: Pose::of_modified_dh(alpha, a, d),
            coordinate: k,
            ratio: 1.0,
            offset: 0.0,
            inertia,
            limits: Limits { position: [from, to], velocity, effort },
        }
    };
    Tree::new((0..N).map(body).collect()).unwrap()
}

/// The description that a user has: frames, and bodies that are guessed.
pub fn guessed() -> Tree {
    tree(false).with_guessed_inertias(18.0, 0.1)
}

/// The arm, with `load` in its hand.
pub fn arm(load: Option<Inertia>) -> Arm {
    let mut tree = tree(true);
    assert!(tree.bodies().iter().all(|body| body.inertia.consistency() > 0.0));
    tree.rotors = JOINTS.map(|numbers| numbers[0]).to_vec();
    if let Some(load) = load {
        let mut parameters = tree.parameters();
        parameters[60..70].iter_mut().zip(load.0).for_each(|(own, more)| *own += more);
        tree = tree.with_parameters(&parameters);
    }
    let joint = |[rotor, viscous, coulomb, load, width, offset]: [f64; 6]| JointNumbers {
        rotor,
        viscous,
        coulomb,
        load,
        width,
        offset,
        ..JointNumbers::default()
    };
    Arm { tree, joints: JOINTS.map(joint).into() }
}

/// A motion within the arm's limits, with this period.
pub fn motion(period: f64) -> Series {
    let tree = guessed();
    let limits: Vec<Limits> = (0..N).map(|k| tree.limits(k)).collect();
    let search = Search { period, starts: 2, trials: 60, ..Search::default() };
    excite(&tree, &limits, &search).unwrap().series
}

/// Exact states and torques of the arm along a motion.
pub fn exact(arm: &Arm, motion: &Series, seconds: f64) -> Samples {
    let mut samples = motion.samples((seconds / STEP) as usize + 1, STEP);
    samples.tau = Rows::from_flat(N, arm.torques(&samples)).unwrap();
    samples
}

/// Samples as a log gives them: positions and torques with noise, filtered and differentiated.
pub fn logged(exact: &Samples, noise: &Noise, seed: u64) -> Samples {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = move || {
        let radius = (-2.0 * (1.0 - random.random_range(0.0..1.0_f64)).ln()).sqrt();
        radius * (TAU * random.random_range(0.0..1.0_f64)).cos()
    };
    let size = |i: usize| if i < 4 { 1.0 } else { 0.25 };
    let mut drifts = [0.0; N];
    let kept = (-STEP / MEMORY).exp();
    let renewed = (1.0 - kept * kept).sqrt();
    drifts.iter_mut().enumerate().for_each(|(i, drift)| *drift = noise.drift * size(i) * normal());
    let q = exact.q.as_flat().iter().map(|q| q + noise.encoder * normal()).collect();
    let torque = |(k, tau): (usize, &f64)| {
        let i = k % N;
        drifts[i] = kept * drifts[i] + renewed * noise.drift * size(i) * normal();
        tau + drifts[i] + noise.torque * size(i) * normal()
    };
    let tau = exact.tau.as_flat().iter().enumerate().map(torque).collect();
    let [q, tau] = [q, tau].map(|values| Rows::from_flat(N, values).unwrap());
    Samples::of_even((&q, None, Some(&tau)), &Preparation::default()).unwrap()
}
