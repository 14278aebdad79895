//! Predictors of a machine's motion: acceleration from state and torque, learned in any way.

use super::log::Log;
use leastaction_learning::data::Rows;
use leastaction_programs::dynamics::Accelerations;
use leastaction_programs::{Row, System};

/// Writes accelerations, rad/s², n rows, of many samples side by side, from their positions (rad), velocities (rad/s)
/// and torques (N m), n rows each. A missing acceleration is NaN. The function keeps its workspace between calls.
pub type Predict<'p> = dyn FnMut([&[Row]; 3], &mut [Row]) + 'p;

/// A model of a machine in physical coordinates.
pub trait Predictor: Sync {
    /// Torque that acts in every step of a log, \[samples\]\[n\] (N m). A model that has learned a drive's gain and
    /// delay applies them here. The default is the measured torque.
    fn torques(&self, log: &Log) -> Rows {
        log.measured.clone()
    }

    /// Returns the model's accelerations, with their own workspace.
    fn motion(&self) -> Box<Predict<'_>>;
}

/// A model without any acceleration, which every other model must beat.
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
    /// Creates the predictor of a system without constraints, with its weight block.
    pub fn new(system: &System, weights: Vec<f64>) -> Self {
        Self { accelerations: Accelerations::new(system), weights }
    }
}

impl Predictor for Learned {
    fn motion(&self) -> Box<Predict<'_>> {
        let mut accelerations = self.accelerations.clone();
        Box::new(move |state, a| {
            // Failed samples are NaN.
            let _failures = accelerations.evaluate(&self.weights, state, a, None);
        })
    }
}
