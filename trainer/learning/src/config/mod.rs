//! The configuration of a training run, a TOML file. `leastaction train --print-defaults` prints it with every key
//! explained.

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
use leastaction_models::Architecture;
use leastaction_models::config::{ModelConfig, ShapeError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What to learn, from what, and how.
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
    /// What is minimised; by default windows where the positions are noisy, else the next position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loss: Option<TrainingLoss>,
    /// Length of a window, s; none: that of several by which held-back logs are predicted best.
    #[serde(deserialize_with = "fields::some_limit", skip_serializing_if = "Option::is_none")]
    pub window: Option<f64>,
    /// Part of a window that the next one has as well, in [0, 1); none: a half where windows are few.
    #[serde(deserialize_with = "fields::some_fraction", skip_serializing_if = "Option::is_none")]
    pub overlap: Option<f64>,
    /// Of the filter of the loss of torques, Hz.
    #[serde(deserialize_with = "fields::limit")]
    pub cut_off: f64,
    /// What windows are integrated by; by default Runge–Kutta steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integrator: Option<Integrator>,
    /// Of the discrete Euler–Lagrange equation or, for the next state and by default for windows, of the Runge–Kutta step: 2 or 4.
    #[serde(deserialize_with = "fields::order")]
    pub order: u8,
    /// Which optimiser.
    pub optimiser: OptimiserKind,
    /// Iterations at most, warm-up not counted.
    pub iterations: u64,
    /// Iterations before those on the next position: on the DEL residual or, of free motion, on the next position of fewer samples.
    pub warm_up: u64,
    /// Training loss at which to stop.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub target: Option<f64>,
    /// Iterations without a better validation loss after which to stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patience: Option<u64>,
    /// Seconds after which to stop.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub max_seconds: Option<f64>,
    /// Of all random numbers.
    pub seed: u64,
    /// Threads, at most 1024; 0: all.
    #[serde(deserialize_with = "fields::threads")]
    pub threads: usize,
    /// Iterations from checkpoint to checkpoint, at least 1.
    #[serde(deserialize_with = "fields::positive")]
    pub checkpoint_iterations: u64,
    /// Seconds from checkpoint to checkpoint.
    #[serde(deserialize_with = "fields::limit")]
    pub checkpoint_seconds: f64,
    /// Standard deviations of logged states, where their noise is to be learned beside the weights: of the acceleration loss.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "fields::state_noise")]
    pub state_noise: Option<StateNoise>,
    /// Whether networks that correct the model are kept only where they predict held-back logs better.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub try_networks: bool,
    /// λ ≥ 0 of the penalty λ|θ|² that Levenberg–Marquardt adds to the loss.
    #[serde(deserialize_with = "fields::penalty")]
    pub weight_decay: f64,
    /// Of Adam.
    pub adam: AdamConfig,
}

/// Adam with a learning rate that falls on plateaus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AdamConfig {
    /// Of the first iterations, > 0.
    #[serde(deserialize_with = "fields::limit")]
    pub learning_rate: f64,
    /// Samples in a step; 0: all.
    pub batch: usize,
    /// By which the learning rate is multiplied on a plateau, in (0, 1].
    #[serde(deserialize_with = "fields::factor")]
    pub plateau_factor: f64,
    /// Iterations without a lower loss that make a plateau.
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
    /// The defaults for a log, and a model of this shape; `Coordinates` give an inertia network.
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

    /// Reads a configuration from text; `file` is for messages alone.
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
        config.model.check(&open).map_err(|error| read::located(file, text, &error))?;
        Ok(config)
    }

    /// The configuration as TOML, every key written out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The same without what may change when a run is resumed: where data and models lie, when to stop and to save, threads.
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

    /// The shape of the model, and the weights that training begins with.
    ///
    /// # Errors
    /// [`ShapeError`] where a tree, a graph or its types cannot be, or the model that they come from cannot be read.
    pub fn beginning(&self) -> Result<(Architecture, Vec<f64>), ShapeError> {
        self.model.beginning(self.training.seed, &open)
    }
}

#[cfg(test)]
mod tests;
