//! Evaluation of long predictions: exact motions from starts that are not in the training data.

use super::{Options, Outcome, Pictured, Predicted};
use crate::baselines::{Follow, PredictionModel};
use crate::rollouts::UNSEEN;
use crate::task::TaskError;
use leastaction_core::model::ModelError;
use leastaction_ground_truth::{ExactMotion, GenerationError, Horizon, ManyBody, ModlanetSettings, starts};
use leastaction_learning::evaluate::prediction::{Prediction, Truth};

/// Exact motions of a system, and the errors that single precision causes in them.
pub(super) struct Judge {
    /// Exact motion of the system.
    pub motion: Box<dyn ExactMotion>,
    /// Length of the predictions, s.
    pub length: f64,
    truth: Truth,
    floor: Prediction,
}

impl Judge {
    pub fn new(system: ManyBody, options: &Options, length: f64) -> Result<Self, TaskError> {
        let motion = system.motion().map_err(GenerationError::from)?;
        let settings = ModlanetSettings::published(system, options.seed ^ UNSEEN);
        let settings = ModlanetSettings { trajectories: options.starts, speed: 8.0, ..settings };
        let truth = Truth::new(motion.as_ref(), starts(&settings), Horizon::of_seconds(length))?;
        let floor = truth.single_precision(motion.as_ref());
        Ok(Self { motion, length, truth, floor })
    }

    /// Errors of a model.
    pub fn predict(
        &self,
        (shape, weights): (&dyn PredictionModel, &[f64]),
        follow: Follow,
    ) -> Result<Prediction, ModelError> {
        shape.predict(weights, &self.truth, follow)
    }

    /// Puts errors into a row of the table.
    pub fn put(&self, outcome: &mut Outcome, found: Prediction) {
        outcome.predicted = Some(Predicted::new(self.length, &found, &self.floor));
        let (h, exact) = (self.truth.horizon().h, self.truth.first().to_vec());
        outcome.pictured = Some(Pictured { h, ours: found, floor: self.floor.clone(), exact });
    }
}
