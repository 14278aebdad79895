//! Chains of rigid bodies with friction: simple physics, from the training logs alone.

use super::entries::{Fitted, Training};
use super::predictor::Learned;
use super::states::smoothed;
use crate::task::TaskError;
use leastaction_core::energy::bodies::{BodyParameters, Joint, TreeBody};
use leastaction_learning::training::{Levenberg, objective_of};
use leastaction_programs::System;
use leastaction_programs::energies::{BodiesEnergies, Friction, FrictionNumber, WithFriction};
use leastaction_programs::losses::AccelerationLoss;
use std::time::Instant;

/// γ, m/s²: at q = 0 the bodies hang along it.
const GRAVITY: [f64; 2] = [9.81, 0.0];
/// Of every body, kg: torques show masses only in products with lengths, which are learned.
const MASS: f64 = 0.5;
/// Centre of mass and length (m), inertia and that of a rotor (kg m²), before anything is learned.
const START: [f64; 4] = [0.15, 0.2, 0.02, 1e-4];
/// A rotor turns so much faster than its joint. Any other number but 0 and 1 would do: it only makes the two entries of the inertia that a
/// joint shares with its parent independent.
const GEAR: f64 = 6.0;
/// θ of b = 0.01 N m s/rad, c = 0.05 N m and ε = 0.2 rad/s.
const FRICTION: [f64; 3] = [-4.6, -3.0, -0.75];
/// Iterations of Levenberg–Marquardt at most.
const ITERATIONS: usize = 100;

/// Learns a chain of the machine's joints with viscous friction, and dry friction c tanh(v/ε) or none, from the accelerations of smoothed
/// states.
///
/// # Errors
/// Where the logs have no samples to learn from.
pub(super) fn fit(training: &Training, is_dry: bool) -> Result<Fitted, TaskError> {
    let clock = Instant::now();
    let (samples, chain) = (smoothed(&training.logs), Chain::new(training.machine.joints(), is_dry)?);
    if samples.is_empty() {
        return Err("the training logs have no samples to learn from".into());
    }
    let (own, parameters) = (chain.system.clone(), chain.system.parameters());
    let loss = objective_of(move || Box::new(AccelerationLoss::new(&own)), parameters, samples);
    let weights = Levenberg::new(&*loss, chain.weights).run(&*loss, ITERATIONS, |_, _| ()).weights;
    Ok(Fitted {
        predictor: Box::new(Learned::new(&chain.system, weights)),
        parameters: chain.learned,
        seconds: clock.elapsed().as_secs_f64(),
    })
}

/// Bodies one on the other, with friction.
struct Chain {
    system: System,
    /// Before anything is learned.
    weights: Vec<f64>,
    /// Numbers that are.
    learned: usize,
}

impl Chain {
    fn new(joints: usize, is_dry: bool) -> Result<Self, TaskError> {
        let bodies = (0..joints).map(|k| TreeBody {
            joint: Joint::Revolute,
            parent: k.checked_sub(1).and_then(|parent| u8::try_from(parent).ok()),
        });
        let (mut weights, mut known) = (GRAVITY.to_vec(), GRAVITY.map(Some).to_vec());
        for body in 0..joints {
            let (start, learned) = numbers(body > 0);
            weights.extend(start);
            known.extend(start.iter().zip(learned).map(|(x, learned)| (!learned).then_some(*x)));
        }
        let of_friction = if is_dry { FRICTION.len() } else { 1 };
        let learned = known.iter().filter(|known| known.is_none()).count() + of_friction * joints;
        (0..joints).for_each(|_| weights.extend(&FRICTION[..of_friction]));
        let number =
            |is_learned| if is_learned { FrictionNumber::Learned } else { FrictionNumber::Known(0.0) };
        let width = if is_dry { FrictionNumber::Learned } else { Friction::NONE.width };
        let friction = Friction { viscous: number(true), constant: number(is_dry), width, ..Friction::NONE };
        let bodies = BodiesEnergies::new(bodies.collect())?.with_known(known).ok_or("numbers of bodies")?;
        let model = WithFriction::new(bodies, vec![friction; joints], (0..joints).collect());
        let system = System::new(&model.ok_or("friction of as many joints as there are")?);
        Ok(Self { system, weights, learned })
    }
}

/// The numbers of a body, and which of them are learned. That of the rotor and the length to the joint are of bodies on others alone.
fn numbers(is_carried: bool) -> ([f64; 9], [bool; 9]) {
    let [centre, length, inertia, rotor] = START;
    let of = |x: f64| if is_carried { x } else { 0.0 };
    let start = BodyParameters {
        place: [of(length), 0.0],
        angle: 0.0,
        mass: MASS,
        centre: [centre, 0.0],
        inertia,
        rotor: of(rotor),
        gear: GEAR,
    };
    let learned = BodyParameters {
        place: [is_carried, false],
        angle: false,
        mass: false,
        centre: [true, false],
        inertia: true,
        rotor: is_carried,
        gear: false,
    };
    (start.into_array(), learned.into_array())
}
