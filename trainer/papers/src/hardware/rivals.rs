//! Networks that learn from single states, using the training logs alone: L-NODE and DeLaN.

use super::entries::{Fitted, Training};
use super::log::Log;
use super::predictor::Learned;
use super::states::{dataset, smoothed};
use crate::task::{TaskError, watch};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia};
use leastaction_learning::training::{
    Levenberg, LossKind, Objective, Samples, TorqueTerms, objective, torque_objective,
};
use leastaction_models::{Architecture, GroupLaws, InertiaNetworkArchitecture, Number};
use leastaction_programs::System;
use std::time::Instant;

/// Number of units of both hidden layers.
const WIDTH: u16 = 16;
/// Maximum numbers of Levenberg–Marquardt iterations: for a full run, and for a first look.
const ITERATIONS: [usize; 2] = [60, 10];
/// Initial viscous friction b, N m s/rad.
const VISCOUS: f64 = 0.01;
/// Initial c (N m), c_load, τ_s (N m) and ε (rad/s), each with whether it is learned.
const FRICTION: [(f64, bool); 4] = [(0.1, true), (0.0, false), (0.1, false), (0.1, true)];

/// Method of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rival {
    /// Loss of the state after a Runge–Kutta step of order 4 from logged states (Zhong, Dey and Chakraborty 2020;
    /// Lutter and Peters 2021).
    LNode,
    /// Loss of the torque that a smoothed motion needs by inverse dynamics (Lutter, Ritter and Peters 2019).
    Delan,
}

impl Rival {
    /// Learns from the training logs; if there are several, the last one decides which iteration to keep.
    pub fn fit(self, training: &Training, has_friction: bool) -> Result<Fitted, TaskError> {
        let clock = Instant::now();
        let (network, [learned, judges]) = (network(training, has_friction), training.split());
        let [loss, judge] = [learned, judges].map(|logs| self.objective(&network, logs));
        let (loss, judge) = (loss?, judge?);
        let mut tell = watch(training.tell, 10, (String::new(), ": loss".to_owned()));
        let iterations = ITERATIONS[usize::from(training.quick)];
        let weights = network.initial_weights(training.seed);
        let weights =
            Levenberg::new(&*loss, weights).best(&*loss, &*judge, iterations, |k, state| tell(k, state.loss));
        let system = System::new(&*network.energies()?);
        Ok(Fitted {
            parameters: network.learned_parameters()?,
            predictor: Box::new(Learned::new(&system, weights)),
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    fn objective(self, network: &Architecture, logs: &[&Log]) -> Result<Box<dyn Objective>, TaskError> {
        let samples = match self {
            Self::LNode => Samples::next_states(&dataset(logs))?,
            Self::Delan => smoothed(logs),
        };
        if samples.is_empty() {
            return Err("the training logs have no samples to learn from".into());
        }
        Ok(match self {
            Self::LNode => objective(network, samples, LossKind::NextState, 4)?,
            Self::Delan => torque_objective(network, samples, TorqueTerms::default())?,
        })
    }
}

/// Returns an inertia network for rotating joints, with friction of each joint or without.
fn network(training: &Training, has_friction: bool) -> Architecture {
    let n = training.machine.joints();
    let mut inertia_network = InertiaNetworkArchitecture::new(&vec![Coordinate::Angle; n], WIDTH);
    if n > 1 {
        // The constant 10⁻⁴ kg m² prevents division by nearly zero in the first iterations, in which the inertia is far
        // from that of the machine.
        inertia_network.inertia = Inertia::Cholesky { epsilon: 1e-4 };
    }
    let mut network = Architecture::from(inertia_network);
    if has_friction {
        let dry = FRICTION.map(|(value, learned)| Number::new(value, learned));
        network.group_laws = GroupLaws::of_friction(vec![Number::learned(VISCOUS); n], vec![dry; n]);
    }
    network
}
