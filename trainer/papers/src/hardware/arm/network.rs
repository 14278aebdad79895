//! Inertia matrix and potential of the arm from a single network, with the friction and the offsets of the body models,
//! learned by the torque loss. This is the learned alternative to rigid bodies (DeLaN: Lutter, Ritter and Peters 2019).

use super::ArmData;
use super::models::{Learned, WITHOUT_LOAD, consistent};
use crate::task::TaskError;
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_learning::torque::Samples;
use leastaction_learning::torque::fit::{Arm, JointNumbers, SOFTNESS};
use leastaction_learning::training::{
    Covered, Levenberg, Objective, Offsets, Samples as States, TorqueTerms, inverse_dynamics, network_start,
    torque_objective,
};
use leastaction_models::Family as _;
use leastaction_models::{Architecture, ArmArchitecture, GroupLaws, InertiaNetworkArchitecture, Number};
use leastaction_programs::System;
use leastaction_programs::energies::WithOffsets;

/// Number of units of both hidden layers.
const WIDTH: u16 = 16;
/// Factor of the unit matrix that keeps H positive definite, kg m².
const EPSILON: f32 = 1e-4;
/// Maximum number of Levenberg–Marquardt iterations.
const ITERATIONS: usize = 25;
/// Strengths λ of the penalty λ|θ|² that are tried; held-back motion chooses one, and the number of iterations.
const DECAYS: [f64; 4] = [1e-4, 1e-3, 3e-3, 1e-2];
/// Fold of the motion that is held back for this choice.
const HELD_BACK: usize = 0;
/// Step of the samples, s; the torque loss does not use it.
const STEP: f64 = 1e-3;
/// Initial friction if it does not come from a fit of bodies.
const FIRST: JointNumbers = JointNumbers {
    rotor: 0.0,
    viscous: 0.1,
    coulomb: 0.1,
    load: 0.0,
    width: 0.05,
    offset: 0.0,
    smoothing: SOFTNESS,
    viscous_asymmetry: 0.0,
    asymmetry: 0.0,
};

/// A network and its initial numbers: its weights, then the offsets of the drives.
type Beginning = (Architecture, Vec<f64>);

/// Learns from random weights.
pub(super) fn from_nothing(data: &ArmData) -> Result<Learned, TaskError> {
    learn(data, |data| {
        let joints = vec![FIRST; data.train.q.width()];
        let network = network(&joints);
        let weights = network.initial_weights(0);
        Ok((network, with_offsets(weights, &joints)))
    })
}

/// Learns from weights that reproduce the inertia and potential of bodies fitted to the same samples, and from the
/// friction and the offsets found with these bodies.
pub(super) fn from_bodies(data: &ArmData) -> Result<Learned, TaskError> {
    learn(data, |data| {
        let Arm { tree, joints } = consistent(data, &WITHOUT_LOAD)?.arm;
        let network = network(&joints);
        let bodies = ArmArchitecture::new(&tree, |_| false, |k| Number::known(tree.rotors[k]));
        let bodies = bodies.ok_or("the arm is none of a model file")?;
        let numbers = bodies.initial_weights(0);
        let sizes = [&data.train.v, &data.train.a].map(root_mean_squares);
        let covered = Covered { q: data.train.q.as_flat(), sizes };
        let weights =
            network_start((&network, network.initial_weights(0)), (&bodies.into(), &numbers), &covered)?;
        Ok((network, with_offsets(weights, &joints)))
    })
}

fn root_mean_squares(rows: &leastaction_learning::data::Rows) -> Vec<f64> {
    let square = |i: usize| rows.iter().map(|row| row[i] * row[i]).sum::<f64>() / rows.len() as f64;
    (0..rows.width()).map(|i| square(i).sqrt()).collect()
}

/// Returns the shape of the network, with this initial friction.
fn network(joints: &[JointNumbers]) -> Architecture {
    let mut inertia_network = InertiaNetworkArchitecture::new(&vec![Coordinate::Angle; joints.len()], WIDTH);
    inertia_network.inertia = Inertia::Cholesky { epsilon: EPSILON };
    let dry = |joint: &JointNumbers| {
        let [constant, width] = [joint.coulomb, joint.width].map(Number::learned);
        [constant, Number::known(0.0), Number::known(1.0), width]
    };
    let viscous = joints.iter().map(|joint| Number::learned(joint.viscous)).collect();
    let friction = GroupLaws::of_friction(viscous, joints.iter().map(dry).collect());
    Architecture { group_laws: friction, ..Architecture::from(inertia_network) }
}

/// Appends the negative offsets of the drives to the weights: a log with τ + o has the torque τ = u − o.
fn with_offsets(mut weights: Vec<f64>, joints: &[JointNumbers]) -> Vec<f64> {
    weights.extend(joints.iter().map(|joint| -joint.offset));
    weights
}

/// Chooses the penalty and the number of iterations by held-back motion, then trains with them on all samples.
fn learn(
    data: &ArmData,
    begin: impl Fn(&ArmData) -> Result<Beginning, TaskError>,
) -> Result<Learned, TaskError> {
    let units = States::of_torques(&data.train, STEP).torque_deviations();
    let objective = |network: &Architecture, of: &Samples| {
        let terms = TorqueTerms { units: units.clone(), offsets: Some(Offsets::default()) };
        torque_objective(network, States::of_torques(of, STEP), terms)
    };
    let folds = data.folds();
    let [part, held_back] =
        [false, true].map(|is_held| data.train.selected(|k| (folds[k] == HELD_BACK) == is_held));
    let (network, initial) = begin(&ArmData { train: part.clone(), ..data.clone() })?;
    let choice = chosen(&initial, [&*objective(&network, &part)?, &*objective(&network, &held_back)?]);
    let (network, initial) = begin(data)?;
    let all = objective(&network, &data.train)?;
    let weights = run(&*all, initial, choice.decay, choice.iterations, |_, _| ());
    let system = System::new(&WithOffsets::new(network.energies()?));
    Ok(Learned {
        predict: Box::new(move |of| inverse_dynamics(&system, &weights, &States::of_torques(of, STEP))),
        parameters: network.learned_parameters()? + network.n(),
        rank: None,
        consistency: None,
    })
}

/// Choice made by held-back motion.
struct Choice {
    loss: f64,
    decay: f64,
    iterations: usize,
}

fn chosen(initial: &[f64], [part, held_back]: [&dyn Objective; 2]) -> Choice {
    let mut best = Choice { loss: held_back.loss(initial), decay: DECAYS[0], iterations: 0 };
    for decay in DECAYS {
        let _last = run(part, initial.to_vec(), decay, ITERATIONS, |iterations, state| {
            let loss = held_back.loss(&state.weights);
            if loss < best.loss {
                best = Choice { loss, decay, iterations };
            }
        });
    }
    best
}

fn run(
    objective: &dyn Objective,
    initial: Vec<f64>,
    decay: f64,
    iterations: usize,
    watch: impl FnMut(usize, &Levenberg),
) -> Vec<f64> {
    Levenberg::new(objective, initial).with_decay(decay).run(objective, iterations, watch).weights
}
