//! The configuration of a training run, a TOML file. `leastaction train --print-defaults` prints it with every key explained.

mod calibration;
mod data;
mod error;
mod fields;
mod loss;
mod read;

pub use calibration::{CalibrationConfig, SettingConfig};
pub use data::{ColumnsConfig, DataConfig, JoinConfig, LeftOutConfig, LogFiles};
pub use error::ConfigError;
pub use fields::OptimiserKind;
pub use loss::TrainingLoss;

use crate::checkpoint::open;
use crate::training::StateNoise;
use crate::windows::Integrator;
use data::OtherOrder;
use leastaction_models::Architecture;
use leastaction_models::config::{ModelConfig, ShapeError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The configuration of a training run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Config {
    /// `[data]`.
    pub data: DataConfig,
    /// `[model]`.
    pub model: ModelConfig,
    /// `[calibration]`.
    #[serde(skip_serializing_if = "CalibrationConfig::is_default")]
    pub calibration: CalibrationConfig,
    /// `[training]`.
    pub training: TrainingConfig,
}

/// Loss, optimiser and when to stop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrainingConfig {
    /// Loss to minimise; by default windows if the positions are noisy, else the next position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss: Option<TrainingLoss>,
    /// Length of a window, s; by default, the one of several candidate lengths that predicts held-back logs best.
    #[serde(deserialize_with = "fields::some_limit", skip_serializing_if = "Option::is_none")]
    pub window: Option<f64>,
    /// Fraction of a window shared with the next window, in [0, 1); by default a half if there are few windows.
    #[serde(deserialize_with = "fields::some_fraction", skip_serializing_if = "Option::is_none")]
    pub overlap: Option<f64>,
    /// Cut-off frequency of the low-pass filter for the torque loss, Hz.
    #[serde(deserialize_with = "fields::limit")]
    pub cut_off: f64,
    /// Integrator for windows; by default Runge–Kutta.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Integrator>,
    /// Order of the integrator, 2 or 4. The integrator is Runge–Kutta for the next state and, by default, for windows;
    /// otherwise it is the discrete Euler–Lagrange equation.
    #[serde(deserialize_with = "fields::order")]
    pub order: u8,
    /// Optimiser.
    pub optimiser: OptimiserKind,
    /// Iteration limit, not counting warm-up.
    pub iterations: u64,
    /// Warm-up iterations. For the next position they minimise the DEL residual or, if the motion is free, the error of
    /// the next position over fewer samples. For windows they minimise the loss over shorter windows. A graph with
    /// networks beside laws first fits the laws alone.
    pub warm_up: u64,
    /// Training loss at which to stop.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub target: Option<f64>,
    /// Number of iterations without a better validation loss after which training stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patience: Option<u64>,
    /// Time limit, s.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub max_seconds: Option<f64>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of threads, at most 1024; 0: all that the machine has.
    #[serde(deserialize_with = "fields::threads")]
    pub threads: usize,
    /// Iterations between checkpoints, at least 1.
    #[serde(deserialize_with = "fields::positive")]
    pub checkpoint_iterations: u64,
    /// Time between checkpoints, s.
    #[serde(deserialize_with = "fields::limit")]
    pub checkpoint_seconds: f64,
    /// Standard deviations of the logged states, if their noise is to be estimated beside the weights; for the acceleration loss.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::state_noise")]
    pub state_noise: Option<StateNoise>,
    /// Whether correcting networks are kept only if they predict held-back logs better.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub try_networks: bool,
    /// λ ≥ 0 of the penalty λ|θ|² that Levenberg–Marquardt adds to the loss.
    #[serde(deserialize_with = "fields::penalty")]
    pub weight_decay: f64,
    /// Settings of Adam.
    pub adam: AdamConfig,
}

/// Adam with a learning rate that falls on plateaus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AdamConfig {
    /// Initial learning rate, > 0.
    #[serde(deserialize_with = "fields::limit")]
    pub learning_rate: f64,
    /// Batch size, in samples; 0: all samples.
    pub batch: usize,
    /// Factor applied to the learning rate on a plateau, in (0, 1].
    #[serde(deserialize_with = "fields::factor")]
    pub plateau_factor: f64,
    /// Number of iterations without a lower loss that counts as a plateau.
    pub plateau_patience: u32,
}

impl Default for TrainingConfig {
    fn default() -> Self {
        Self {
            loss: None,
            window: None,
            overlap: None,
            cut_off: 20.0,
            integrator: None,
            order: 4,
            optimiser: OptimiserKind::LevenbergMarquardt,
            iterations: 200,
            warm_up: 20,
            target: None,
            patience: None,
            max_seconds: None,
            seed: 0,
            threads: 0,
            checkpoint_iterations: 50,
            checkpoint_seconds: 10.0,
            state_noise: None,
            try_networks: false,
            weight_decay: 0.0,
            adam: AdamConfig::default(),
        }
    }
}

impl Default for AdamConfig {
    fn default() -> Self {
        Self { learning_rate: 1e-3, batch: 0, plateau_factor: 0.7, plateau_patience: 50 }
    }
}

impl Config {
    /// The defaults for the given log files and model; a list of `Coordinate`s gives an inertia network.
    pub fn new(file: impl Into<LogFiles>, model: impl Into<ModelConfig>) -> Self {
        Self {
            data: DataConfig::new(file),
            model: model.into(),
            calibration: CalibrationConfig::default(),
            training: TrainingConfig::default(),
        }
    }

    /// Reads a configuration file; paths become relative to the working folder.
    ///
    /// # Errors
    /// [`ConfigError`] with file, line and key.
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| ConfigError::Read { file: path.to_owned(), error })?;
        Self::parse_in(&text, path, path.parent())
    }

    /// Reads a configuration from text; `file` only appears in messages.
    ///
    /// # Errors
    /// [`ConfigError::Invalid`] with line and key.
    pub fn parse(text: &str, file: &Path) -> Result<Self, ConfigError> {
        Self::parse_in(text, file, None)
    }

    fn parse_in(text: &str, file: &Path, folder: Option<&Path>) -> Result<Self, ConfigError> {
        let mut config: Self = read::parse(text).map_err(|error| ConfigError::invalid(file, text, &error))?;
        if let Some(folder) = folder {
            config.data.file = config.data.file.map(|file| folder.join(file));
            config.model.files().into_iter().for_each(|file| *file = folder.join(&*file));
        }
        if let Some(problem) = config.data.problem() {
            return Err(read::at_key(file, text, &["data", "join"], problem));
        }
        if let Some((key, must)) = config.calibration.problem() {
            return Err(read::at_key(file, text, &["calibration", key], format!("`{key}` must be {must}")));
        }
        let architecture = config.model.architecture(&open);
        let architecture = architecture.map_err(|error| read::located(file, text, &error))?;
        if let Some(OtherOrder { key, message }) = config.joints_in_other_order(&architecture) {
            return Err(read::at_key(file, text, &["data", "columns", key], message));
        }
        Ok(config)
    }

    /// Columns that name the joints of an arm in another order than the arm has them.
    fn joints_in_other_order(&self, architecture: &Architecture) -> Option<OtherOrder> {
        let joints: Vec<&str> =
            architecture.family.arm()?.bodies.iter().map(|body| body.name.as_str()).collect();
        self.data.columns.as_ref()?.in_other_order(&joints)
    }

    /// The configuration as TOML, every key written out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The configuration without what may change when a run is resumed: paths of data and models, stopping and saving limits, threads.
    #[must_use]
    pub fn identity(&self) -> Self {
        let defaults = TrainingConfig::default();
        let mut model = self.model.clone();
        model.files().into_iter().for_each(|file| *file = PathBuf::new());
        Self {
            model,
            calibration: self.calibration,
            data: DataConfig { file: PathBuf::new().into(), ..self.data.clone() },
            training: TrainingConfig {
                iterations: defaults.iterations,
                target: defaults.target,
                patience: defaults.patience,
                max_seconds: defaults.max_seconds,
                threads: defaults.threads,
                checkpoint_iterations: defaults.checkpoint_iterations,
                checkpoint_seconds: defaults.checkpoint_seconds,
                ..self.training.clone()
            },
        }
    }

    /// The shape of the model, and the initial weights.
    ///
    /// # Errors
    /// [`ShapeError`] if a tree, a graph or its types are invalid, or if the model to start from cannot be read.
    pub fn beginning(&self) -> Result<(Architecture, Vec<f64>), ShapeError> {
        self.model.beginning(self.training.seed, &open)
    }
}

#[cfg(test)]
mod tests;
