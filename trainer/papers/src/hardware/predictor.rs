//! What predicts a machine's motion: acceleration from state and torque, whatever it was learned by.

use super::log::Log;
use leastaction_learning::data::Rows;
use leastaction_programs::dynamics::Accelerations;
use leastaction_programs::{Row, System};

/// Writes accelerations, rad/s², n rows, of many samples side by side from their positions (rad), velocities (rad/s) and torques
/// (N m), n rows each; not a number where there is none. It keeps its workspace.
pub type Predict<'p> = dyn FnMut([&[Row]; 3], &mut [Row]) + 'p;

/// A model of a machine in physical coordinates.
pub trait Predictor: Sync {
    /// The torque that acts in every step of a log, \[samples\]\[n\] (N m), from what the log has: a model that has learned a
    /// drive's gain and delay applies them here. Measured torque as it is where nothing else is said.
    fn torques(&self, log: &Log) -> Rows {
        log.measured.clone()
    }

    /// Its accelerations, with a workspace of their own.
    fn motion(&self) -> Box<Predict<'_>>;
}

/// No acceleration at all: what any model must be better than.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstantVelocity;

impl Predictor for ConstantVelocity {
    fn motion(&self) -> Box<Predict<'_>> {
        Box::new(|_, a| a.fill(Row::default()))
    }
}

/// Learned energies and forces.
#[derive(Clone, Debug)]
pub struct Learned {
    accelerations: Accelerations,
    weights: Vec<f64>,
}

impl Learned {
    /// A system, without constraints, over its weight block.
    pub fn new(system: &System, weights: Vec<f64>) -> Self {
        Self { accelerations: Accelerations::new(system), weights }
    }
}

impl Predictor for Learned {
    fn motion(&self) -> Box<Predict<'_>> {
        let mut accelerations = self.accelerations.clone();
        Box::new(move |state, a| {
            // What failed is not a number.
            let _failures = accelerations.evaluate(&self.weights, state, a, None);
        })
    }
}
