//! The simulated arm of the demo: its bodies, its motion, its sensors.

use leastaction::cli::Failure;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::TrainedStep;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Arm, JointNumbers};
use leastaction_learning::training::{Samples as States, inverse_dynamics};
use leastaction_models::Model;
use leastaction_models::file::encode;
use leastaction_models::urdf::{Inertias, parse};
use leastaction_models::{Architecture, ArmArchitecture, GroupLaws, Number};
use leastaction_plot::{Panel, Series, Stroke, time_series};
use leastaction_programs::System;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::path::Path;

/// The description that the user has of the arm.
pub const DESCRIPTION: &str = include_str!("../arm.urdf");

/// Number of joints.
const N: usize = 6;
/// Mass ratio of each true body to its description: the forearm carries cables, the flange a tool.
const HEAVIER: [f64; N] = [1.1, 1.05, 1.3, 1.1, 1.2, 2.5];
/// Rotor inertias, kg m².
const ROTORS: [f64; N] = [0.4, 0.4, 0.2, 0.05, 0.05, 0.03];
/// Viscous friction, N m s/rad.
const VISCOUS: [f64; N] = [3.0, 3.0, 1.5, 0.5, 0.4, 0.3];
/// Coulomb friction, N m.
const COULOMB: [f64; N] = [4.0, 4.5, 2.5, 1.0, 0.8, 0.6];
/// Width of Coulomb friction, rad/s.
const WIDTH: f64 = 0.06;

/// Number of harmonics of a motion.
const HARMONICS: usize = 5;
/// Frequency of the first harmonic, Hz.
const FREQUENCY: f64 = 0.1;
/// Typical speed of every joint, rad/s.
const SPEEDS: [f64; N] = [1.0, 0.8, 1.0, 1.5, 1.5, 1.5];
/// Centre of the motion of every joint, rad.
const CENTRE: [f64; N] = [0.0, 0.3, 0.9, 0.0, 0.6, 0.0];
/// Largest torque of every joint, N m.
const LIMIT: [f64; N] = [120.0, 120.0, 60.0, 20.0, 20.0, 20.0];
/// Step of the log, s.
const STEP: f64 = 0.005;
/// Length of the log, s.
const SECONDS: f64 = 20.0;
/// Standard deviations of positions (rad), velocities (rad/s) and torques (N m).
const NOISE: [f64; 3] = [1e-4, 2e-3, 0.2];

/// Coefficients of the cosines and sines of every joint, rad.
type Waves = [[[f64; HARMONICS]; N]; 2];

/// A motion with random phases, in which all harmonics have the same speed amplitude.
fn waves(seed: u64, which: u64) -> Waves {
    let mut stream = Pcg64::seed_from_u64(seed.wrapping_mul(3).wrapping_add(which));
    let mut waves = [[[0.0; HARMONICS]; N]; 2];
    let [cosines, sines] = &mut waves;
    for ((cosines, sines), speed) in cosines.iter_mut().zip(sines).zip(SPEEDS) {
        for (k, (c, s)) in cosines.iter_mut().zip(sines).enumerate() {
            let size = speed * (2.0 / HARMONICS as f64).sqrt() / (TAU * FREQUENCY * (k + 1) as f64);
            let (sine, cosine) = stream.random_range(0.0..TAU).sin_cos();
            // Without this limit the low harmonics would have large amplitudes.
            let size = size.min(0.4);
            (*c, *s) = (size * cosine, size * sine);
        }
    }
    waves
}

/// Position, velocity and acceleration of every joint at a time (s).
fn state([cosines, sines]: &Waves, t: f64) -> [[f64; N]; 3] {
    let mut state = [CENTRE, [0.0; N], [0.0; N]];
    for joint in 0..N {
        for k in 0..HARMONICS {
            let w = TAU * FREQUENCY * (k + 1) as f64;
            let (sine, cosine) = (w * t).sin_cos();
            let (c, s) = (cosines[joint][k], sines[joint][k]);
            state[0][joint] += c * cosine + s * sine;
            state[1][joint] += w * (s * cosine - c * sine);
            state[2][joint] -= w * w * (c * cosine + s * sine);
        }
    }
    state
}

/// The true arm.
fn arm() -> Result<Arm, Failure> {
    let described =
        parse(DESCRIPTION, Inertias::Required).map_err(|error| Failure::Work(error.to_string()))?;
    let own = described.bodies().iter().zip(HEAVIER);
    let numbers = own.flat_map(|(body, heavier)| body.inertia.0.map(|number| heavier * number));
    let tree = described.with_parameters(&numbers.chain(ROTORS).collect::<Vec<_>>());
    let joint = |k: usize| JointNumbers {
        rotor: ROTORS[k],
        viscous: VISCOUS[k],
        coulomb: COULOMB[k],
        width: WIDTH,
        ..JointNumbers::default()
    };
    Ok(Arm { tree, joints: (0..N).map(joint).collect() })
}

/// A model file of the true arm.
pub fn plant() -> Result<Vec<u8>, Failure> {
    let Arm { tree, joints } = arm()?;
    let failed = |what: &str| Failure::Work(format!("the demo's arm: {what}"));
    let family = ArmArchitecture::new(&tree, |_| false, |k| Number::known(ROTORS[k]))
        .ok_or_else(|| failed("no arm of a file"))?;
    let dry = |joint: &JointNumbers| [joint.coulomb, 0.0, 1.0, joint.width].map(Number::known);
    let viscous = joints.iter().map(|joint| Number::known(joint.viscous)).collect();
    let friction = GroupLaws::of_friction(viscous, joints.iter().map(dry).collect());
    let architecture = Architecture { group_laws: friction, ..Architecture::from(family) };
    let weights = architecture.initial_weights(0);
    encode(&architecture, &weights, None::<TrainedStep>, "the arm of leastaction demo")
        .map_err(|error| failed(&error.to_string()))
}

/// Exact states of a motion, with the torques that the motion needs.
fn samples(waves: &Waves) -> Result<Samples, Failure> {
    let t: Vec<f64> = (0..(SECONDS / STEP) as usize).map(|k| k as f64 * STEP).collect();
    let states: Vec<_> = t.iter().map(|t| state(waves, *t)).collect();
    let [q, v, a] = [0, 1, 2].map(|part| rows(states.iter().flat_map(|state| state[part]).collect()));
    let (q, v, a) = (q?, v?, a?);
    let samples = Samples { t, tau: q.clone(), q, v, a };
    Ok(Samples { tau: rows(arm()?.torques(&samples))?, ..samples })
}

fn rows(values: Vec<f64>) -> Result<Rows, Failure> {
    Rows::from_flat(N, values).ok_or_else(|| Failure::Work("rows of another width".to_owned()))
}

/// Sensor readings along a motion; every pair of `seed` and `which` gives another motion.
pub fn log(seed: u64, which: u64) -> Result<Dataset, Failure> {
    let Samples { q, v, tau, .. } = samples(&waves(seed, which))?;
    let mut stream = Pcg64::seed_from_u64(seed ^ (which + 1));
    let mut read = |exact: &Rows, size: f64| {
        let noise = StandardNormal.sample_iter(&mut stream).map(|x: f64| size * x);
        rows(exact.as_flat().iter().zip(noise).map(|(exact, noise)| exact + noise).collect())
    };
    let [of_q, of_v, of_torque] = NOISE;
    let (q, v, u) = (read(&q, of_q)?, read(&v, of_v)?, read(&tau, of_torque)?);
    let trajectory = Trajectory { id: 0, t0: 0.0, q, v: Some(v), a: None, u: Some(u) };
    Ok(Dataset { n: N, h: STEP, control: Some(ControlKind::Linear), trajectories: vec![trajectory] })
}

/// The file of a third motion, which the firmware is to follow.
pub fn motion(seed: u64) -> String {
    let [cosines, sines] = waves(seed, 2);
    format!(
        "frequency = {FREQUENCY}   # Hz, of the first harmonic\ncentre = {CENTRE:?}\ncosine = {cosines:?}\nsine = {sines:?}\nlimit = {LIMIT:?}\n"
    )
}

/// Number of samples of which the plots show one.
const SHOWN: usize = 10;

/// Plots the torques of the motion that was held back from learning: sensor readings, and the model's torques.
pub fn draw_torques(file: &Path, model: &Model, seed: u64, unseen: &Dataset) -> Result<(), Failure> {
    let failed = |error: &dyn std::fmt::Display| Failure::Work(error.to_string());
    let exact = samples(&waves(seed, 1))?;
    let system = System::new(&*model.architecture.energies().map_err(|error| failed(&error))?);
    let of_model = inverse_dynamics(&system, &model.weights, &States::of_torques(&exact, STEP));
    let read =
        unseen.trajectories.first().and_then(|log| log.u.as_ref()).map(Rows::as_flat).unwrap_or_default();
    let names: Vec<String> = (1..=N).map(|joint| format!("joint {joint} (N m)")).collect();
    let curve = |label: &str, torques: &[f64], joint: usize| {
        let own = torques.iter().skip(joint).step_by(N);
        Series::new(label, exact.t.iter().copied().zip(own.copied()).step_by(SHOWN))
    };
    let series: Vec<[Series; 2]> = (0..N)
        .map(|joint| {
            [curve("logged", read, joint).with_stroke(Stroke::Wide), curve("by the model", &of_model, joint)]
        })
        .collect();
    let panels: Vec<Panel> =
        names.iter().zip(&series).map(|(name, series)| Panel::new(name, series)).collect();
    time_series(file, "Torques of a motion that was not learned from", &panels)
        .map_err(|error| failed(&error))
}
