//! Networks that learn from single states: L-NODE and DeLaN, on the training logs alone.

use super::entries::{Fitted, Training};
use super::grid::STEP;
use super::log::Log;
use super::predictor::Learned;
use super::states::{dataset, smoothed};
use crate::task::TaskError;
use leastaction_core::energy::rigid::{Coordinate, Inertia};
use leastaction_learning::architecture::RigidArchitecture;
use leastaction_learning::training::{Levenberg, Objective, Samples, objective_of};
use leastaction_programs::System;
use leastaction_programs::energies::{DryLaw, Energies, FrictionLaws, WithFriction};
use leastaction_programs::losses::{NextStateLoss, RungeKutta, TorqueLoss};
use std::time::Instant;

/// Units of both hidden layers.
const WIDTH: u16 = 16;
/// Iterations of Levenberg–Marquardt at most, and for a first look.
const ITERATIONS: [usize; 2] = [60, 10];
/// b before anything is learned, N m s/rad.
const VISCOUS: f64 = 0.01;
/// c (N m), c_load, τ_s (N m) and ε (rad/s) before anything is learned.
const DRY: [f64; 4] = [0.05, 0.0, 0.1, 0.2];

/// Which of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rival {
    /// The state after a Runge–Kutta step of order 4 from logged states: Zhong, Dey and Chakraborty 2020, Lutter and Peters 2021.
    LNode,
    /// The torque that a smoothed motion takes, by inverse dynamics: Lutter, Ritter and Peters 2019.
    Delan,
}

impl Rival {
    /// Learns from the training logs; the last of several judges which iteration to keep.
    ///
    /// # Errors
    /// Where the logs have no samples to learn from.
    pub fn fit(self, training: &Training, has_friction: bool) -> Result<Fitted, TaskError> {
        let clock = Instant::now();
        let (model, weights) = network(training, has_friction)?;
        let (system, [learned, judges]) = (System::new(&*model), training.split());
        let [loss, judge] = [learned, judges].map(|logs| self.objective(&system, logs));
        let (loss, judge) = (loss?, judge?);
        let watch = |iteration: usize, levenberg: &Levenberg| {
            if iteration.is_multiple_of(10) {
                (training.tell)(&format!("iteration {iteration}: loss {:.2e}", levenberg.loss));
            }
        };
        let iterations = ITERATIONS[usize::from(training.quick)];
        let weights = Levenberg::new(&*loss, weights).best(&*loss, &*judge, iterations, watch);
        Ok(Fitted {
            parameters: weights.len(),
            predictor: Box::new(Learned::new(&system, weights)),
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    fn objective(self, system: &System, logs: &[&Log]) -> Result<Box<dyn Objective>, TaskError> {
        let samples = match self {
            Self::LNode => Samples::next_states(&dataset(logs))?,
            Self::Delan => smoothed(logs),
        };
        if samples.is_empty() {
            return Err("the training logs have no samples to learn from".into());
        }
        let (own, parameters) = (system.clone(), system.parameters());
        Ok(match self {
            Self::LNode => {
                let next = move || NextStateLoss::new(&own, STEP, RungeKutta::ThreeEighths);
                objective_of(move || Box::new(next()), parameters, samples)
            }
            Self::Delan => objective_of(move || Box::new(TorqueLoss::new(&own)), parameters, samples),
        })
    }
}

/// The rigid family's network for joints that turn, with friction of each or without, and its initial weights.
fn network(training: &Training, has_friction: bool) -> Result<(Box<dyn Energies>, Vec<f64>), TaskError> {
    let n = training.machine.joints();
    let mut architecture = RigidArchitecture::new(&vec![Coordinate::Angle; n], WIDTH);
    if n > 1 {
        // 10⁻⁴ kg m² keeps the first iterations, whose inertia is far from that of the machine, from dividing by nothing.
        architecture.inertia = Inertia::Cholesky { epsilon: 1e-4 };
    }
    let (energies, mut weights) = (architecture.energies()?, architecture.initial_weights(training.seed));
    if !has_friction {
        return Ok((Box::new(energies), weights));
    }
    let laws = FrictionLaws { viscous: true, dry: DryLaw::Unloaded };
    let groups = WithFriction::new(energies, laws, n, (0..n).collect());
    weights.extend(vec![VISCOUS; n]);
    (0..n).for_each(|_| weights.extend(DRY));
    Ok((Box::new(groups.ok_or("friction of as many joints as there are")?), weights))
}
