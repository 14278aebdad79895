//! Results of an experiment.

use super::super::training::{Ending, in_words};
use super::{Case, Energies, LongRun, Published};
use leastaction_learning::evaluate::prediction::Prediction;
use serde::Serialize;

/// A prediction beside the floor of single precision, in the authors' measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Predicted {
    /// Length of the predictions, s.
    pub prediction_seconds: f64,
    /// Number of starts.
    pub starts: usize,
    /// Position error A_q.
    pub position: f64,
    /// Energy error A_E.
    pub energy: f64,
    /// Median time for which predictions are valid, s.
    pub valid_seconds: f64,
    /// Position error A_q of exact accelerations rounded to f32.
    pub floor_position: f64,
    /// Energy error A_E of exact accelerations rounded to f32.
    pub floor_energy: f64,
    /// Median time for which predictions by exact accelerations rounded to f32 are valid, s.
    pub floor_valid_seconds: f64,
}

impl Predicted {
    /// Creates the measures of predictions over `length` s and of their floor.
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
    /// Time between comparisons, s.
    pub h: f64,
    /// Prediction by the learned model.
    pub ours: Prediction,
    /// Prediction by exact physics in single precision.
    pub floor: Prediction,
    /// States (q, v) along the exact motion from the first start.
    pub exact: Vec<f64>,
}

/// Effect of a long run in single precision on the energy of a learned double pendulum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stepped {
    /// Number of steps.
    pub steps: usize,
    /// Step size, s.
    pub step_seconds: f32,
    /// Energy errors of the DEL equation of order 2.
    pub energy_del_2: Energies,
    /// Energy errors of the DEL equation of order 4.
    pub energy_del_4: Energies,
    /// Energy errors of a Runge–Kutta method of order 4.
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

/// Results of one row of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Outcome {
    /// Experiment of the row.
    pub case: Case,
    /// Kind of system: n-pendulum or n-body.
    pub system: &'static str,
    /// Number of elements.
    pub count: usize,
    /// Kind of model: `trained`, `zero-shot` or `fine-tuned`, or the name of a baseline. `mlp` in [`Case::Noise`] is a
    /// plain network of the same size; any other name is that of [`Baseline::name`](super::Baseline::name).
    pub kind: &'static str,
    /// Number of rows learned from.
    pub samples: usize,
    /// Standard deviation of the noise on positions and velocities of these rows, rad (m) and rad/s (m/s).
    pub noise: f64,
    /// Length of the weight block, in numbers.
    pub parameters: usize,
    /// Mean squared error of accelerations on the training set.
    pub train_mse: f64,
    /// Mean squared error of accelerations on the test set.
    pub test_mse: f64,
    /// Mean squared error of accelerations on the test set, relative to their mean square.
    pub relative_test_mse: f64,
    /// Training time, s.
    pub train_seconds: f64,
    /// Number of epochs of Adam; `None` for Levenberg–Marquardt.
    pub epochs: Option<u64>,
    /// Reason, in words, why training ended early; null if it was complete.
    #[serde(rename = "stopped", serialize_with = "in_words")]
    pub ending: Ending,
    /// Seed of the weights and of generated data.
    pub seed: u64,
    /// Long predictions, if the paper has them.
    #[serde(flatten)]
    pub predicted: Option<Predicted>,
    /// Reason why there are no predictions.
    pub unpredicted: Option<&'static str>,
    /// Long run of two pendulums in single precision.
    #[serde(flatten)]
    pub stepped: Option<Stepped>,
    /// Some accelerations of the test set, true and learned.
    #[serde(skip)]
    pub accelerations: Vec<(f64, f64)>,
    /// Predictions over time.
    #[serde(skip)]
    pub pictured: Option<Pictured>,
    /// Energies along the long run.
    #[serde(skip)]
    pub long_run: Option<LongRun>,
    /// Results of the paper.
    #[serde(skip)]
    pub published: Published,
}
