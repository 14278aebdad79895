//! What an experiment gives, and why it cannot be done.

use super::super::training::{Ending, TrainingError, in_words};
use super::{Case, Energies, LongRun, Published, SteppingError};
use leastaction_core::model::ModelError;
use leastaction_ground_truth::GenerationError;
use leastaction_learning::evaluate::prediction::Prediction;
use serde::Serialize;
use thiserror::Error;

/// A prediction beside the floor of single precision, in the authors' measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Predicted {
    /// Length, s.
    pub prediction_seconds: f64,
    /// Starts.
    pub starts: usize,
    /// A_q.
    pub position: f64,
    /// A_E.
    pub energy: f64,
    /// Median valid-prediction time, s.
    pub valid_seconds: f64,
    /// A_q of exact accelerations rounded to f32.
    pub floor_position: f64,
    /// A_E of the same.
    pub floor_energy: f64,
    /// Median valid-prediction time of the same, s.
    pub floor_valid_seconds: f64,
}

impl Predicted {
    /// Of predictions over `length` s and their floor.
    pub fn new(length: f64, ours: &Prediction, floor: &Prediction) -> Self {
        Self {
            prediction_seconds: length,
            starts: ours.trajectories.len(),
            position: ours.position().mean,
            energy: ours.energy().mean,
            valid_seconds: ours.valid_median(),
            floor_position: floor.position().mean,
            floor_energy: floor.energy().mean,
            floor_valid_seconds: floor.valid_median(),
        }
    }
}

/// A prediction over time, for pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictured {
    /// Time from comparison to comparison, s.
    pub h: f64,
    /// The learned model's.
    pub ours: Prediction,
    /// That of exact physics in single precision.
    pub floor: Prediction,
    /// (q, v) along the exact motion from the first start.
    pub exact: Vec<f64>,
}

/// What a million steps in single precision do to the energy of a learned double pendulum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stepped {
    /// Steps.
    pub steps: usize,
    /// Step, s.
    pub step_seconds: f32,
    /// By the DEL equation of order 2.
    pub energy_del_2: Energies,
    /// Of order 4.
    pub energy_del_4: Energies,
    /// By a Runge–Kutta method of order 4.
    pub energy_rk4: Energies,
}

impl From<&LongRun> for Stepped {
    fn from(run: &LongRun) -> Self {
        Self {
            steps: run.steps,
            step_seconds: run.h,
            energy_del_2: Energies::of(&run.del_2),
            energy_del_4: Energies::of(&run.del_4),
            energy_rk4: Energies::of(&run.rk4),
        }
    }
}

/// What one row of a table gives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The experiment.
    pub case: Case,
    /// n-pendulum or n-body.
    pub system: &'static str,
    /// Elements.
    pub count: usize,
    /// `trained`, `zero-shot` or `fine-tuned`; or a baseline: of [`Case::Noise`] `mlp` is a plain network of the same size,
    /// else as in [`Baseline::name`](super::Baseline::name).
    pub kind: &'static str,
    /// Rows learned from.
    pub samples: usize,
    /// Standard deviation of the noise on their positions and velocities, rad (m) and rad/s (m/s).
    pub noise: f64,
    /// Numbers in the weight block.
    pub parameters: usize,
    /// Mean squared error of accelerations, training set.
    pub train_mse: f64,
    /// The same, test set.
    pub test_mse: f64,
    /// The same, relative to the mean squared acceleration of the test set.
    pub relative_test_mse: f64,
    /// Training time, s.
    pub train_seconds: f64,
    /// Epochs of Adam; none by Levenberg–Marquardt.
    pub epochs: Option<u64>,
    /// How training ended, in words; null where it was complete.
    #[serde(rename = "stopped", serialize_with = "in_words")]
    pub ending: Ending,
    /// Of the weights and of generated data.
    pub seed: u64,
    /// Long predictions, where the paper has them.
    #[serde(flatten)]
    pub predicted: Option<Predicted>,
    /// Why there are none.
    pub unpredicted: Option<&'static str>,
    /// A million steps in single precision, of two pendulums.
    #[serde(flatten)]
    pub stepped: Option<Stepped>,
    /// Accelerations of the test set, true and learned: some of them.
    #[serde(skip)]
    pub accelerations: Vec<(f64, f64)>,
    /// The predictions over time.
    #[serde(skip)]
    pub pictured: Option<Pictured>,
    /// The energies along those steps.
    #[serde(skip)]
    pub long_run: Option<LongRun>,
    /// The paper's.
    #[serde(skip)]
    pub published: Published,
}

/// An experiment that cannot be done.
#[derive(Debug, Error)]
pub enum ReproduceError {
    /// There is no data.
    #[error(transparent)]
    Data(#[from] GenerationError),
    /// The shape does not fit in itself or the data.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model that the paper compares with cannot be trained.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// A step of the learned model failed.
    #[error(transparent)]
    Stepping(#[from] SteppingError),
    /// The exact motion cannot be followed.
    #[error(transparent)]
    ExactMotion(#[from] leastaction_ground_truth::IntegrationError),
    /// The data of another system.
    #[error("the data has {found} coordinates, the case needs {needed}")]
    Coordinates {
        /// Of the data.
        found: usize,
        /// Of the case.
        needed: usize,
    },
}
