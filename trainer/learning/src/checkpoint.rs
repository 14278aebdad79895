//! The checkpoint of a run: its full state, for resuming bit for bit, and the best weights so far.

use crate::checksummed::{self, ReadError};
use crate::training::{Adam, Levenberg};
use crate::windows::{Calibrated, CalibrationLayout};
use leastaction_core::model::{CoordinateRange, TrainedStep};
use leastaction_models::file::decode;
use leastaction_models::{Actuator, Architecture, Facts, Model};
use serde::{Deserialize, Serialize};
use std::fmt::Display;
use std::path::Path;
use std::{fs, io};
use thiserror::Error;

/// File name in the run folder.
pub(crate) const FILE: &str = "checkpoint.postcard";

/// First bytes of the file: a signature and the version of the layout.
const MAGIC: &[u8] = b"LARUN\x0a";

/// Contents of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// Configuration as TOML, without the keys that may change on resuming.
    pub identity: String,
    /// Fingerprint of the data.
    pub data: u64,
    /// Shape of the model.
    pub architecture: Architecture,
    /// Step that the model was trained with.
    pub trained_step: Option<TrainedStep>,
    /// Range that the data covers in every coordinate.
    pub range: Vec<CoordinateRange>,
    /// Layout of the learned sensor and actuator numbers in the parameter vector of a loss over windows.
    pub calibration: Option<CalibrationLayout>,
    /// Progress of the run.
    pub state: State,
}

/// An optimiser with its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Optimiser {
    /// Damped Gauss–Newton.
    Levenberg(Levenberg),
    /// Adam.
    Adam(Adam),
}

/// The best weights of a stage with their losses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// The weight block.
    pub weights: Vec<f64>,
    /// Iteration that gave these weights.
    pub iteration: u64,
    /// Training loss.
    pub train: f64,
    /// Validation loss: the loss on the held-back trajectories.
    pub validation: Option<f64>,
    /// Mean squared error of the next position; present if the DEL residual is minimised.
    pub next_position: Option<f64>,
    /// Whether the final check at the end of training found no training sample that can be solved with these weights.
    /// Every sample then counts as predicted by a constant velocity.
    pub solves_nothing: bool,
}

impl Best {
    /// Whether the weights are usable: finite, with a finite training loss, and able to solve at least one training
    /// sample.
    pub fn is_a_model(&self) -> bool {
        self.train.is_finite() && !self.solves_nothing && self.weights.iter().all(|weight| weight.is_finite())
    }
}

/// The state of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Index into the plan's stages.
    pub stage: usize,
    /// Iterations done in this stage.
    pub in_stage: u64,
    /// Iterations done in all stages.
    pub iteration: u64,
    /// Training time, s.
    pub seconds: f64,
    /// Optimiser of this stage.
    pub optimiser: Optimiser,
    /// Best weights of this stage.
    pub best: Best,
    /// Best parameters of the model alone, before correcting networks are added.
    pub alone: Option<Vec<f64>>,
    /// Number of the start from which this fit began; 0 is the first.
    pub start: u64,
    /// Best of the fits from earlier starts, all of which ended badly.
    pub earlier: Option<Box<State>>,
}

/// A checkpoint that cannot be read.
#[derive(Debug, Error)]
#[error("{error}; {}", way_out(.0), error = .0)]
pub struct CheckpointError(#[from] ReadError);

fn way_out(error: &ReadError) -> &'static str {
    match error {
        ReadError::File { .. } => "is this the folder of a training run?",
        ReadError::Damaged { .. } => "train again with --force",
    }
}

impl Checkpoint {
    pub fn write(&self, file: &Path) -> io::Result<()> {
        checksummed::write(file, MAGIC, self)
    }

    pub fn read(file: &Path) -> Result<Self, CheckpointError> {
        Ok(checksummed::read(file, MAGIC)?)
    }

    fn provenance(&self) -> String {
        let Best { iteration, train, validation, .. } = &self.state.best;
        let validation = validation.map_or(String::new(), |loss| format!(", validation loss {loss:.3e}"));
        let config: toml::Table = toml::from_str(&self.identity).unwrap_or_default();
        let setting = |key: &str| config.get("training").and_then(|training| training.get(key)).cloned();
        let name =
            |key: &str| setting(key).and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default();
        let seed = setting("seed").and_then(|seed| seed.as_integer()).unwrap_or_default();
        let (loss, optimiser) = (name("loss"), name("optimiser"));
        format!(
            "leastaction {}; {loss} by {optimiser}, seed {seed}, data {:016x}; iteration {iteration}, training loss {train:.3e}{validation}",
            env!("CARGO_PKG_VERSION"),
            self.data,
        )
    }
}

/// A trained model as read from a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Shape of the model.
    pub architecture: Architecture,
    /// Step that the model was trained with, if its loss has one.
    pub trained_step: Option<TrainedStep>,
    /// Range that the training data covers in every coordinate.
    pub range: Vec<CoordinateRange>,
    /// Best weights of the model, with their losses.
    pub best: Best,
    /// Calibrated sensors and actuators, if the model was trained over windows.
    pub calibrated: Option<Calibrated>,
    /// Iterations of the run so far.
    pub iterations: u64,
    /// Origin of the model, as readable text; identical for identical runs.
    pub provenance: String,
}

impl Trained {
    /// Facts that a model file holds in addition to shape and weights.
    pub fn facts(&self) -> Facts {
        let Self { trained_step, range, provenance, calibrated, .. } = self.clone();
        let actuator = calibrated.map_or_else(Actuator::default, |calibrated| calibrated.actuator);
        Facts { range, actuator, ..Facts::new(trained_step, &provenance) }
    }

    /// The best model.
    pub fn model(&self) -> Model {
        Model::new(self.architecture.clone(), self.best.weights.clone()).with_facts(self.facts())
    }

    /// Reads the best model of the run in `folder`.
    ///
    /// # Errors
    /// [`CheckpointError`] if there is no usable checkpoint.
    pub fn read(folder: &Path) -> Result<Self, CheckpointError> {
        Ok(Checkpoint::read(&folder.join(FILE))?.into())
    }

    /// Decodes the bytes of a checkpoint; `None` if they are no checkpoint or are damaged.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        checksummed::decode::<Checkpoint>(bytes, MAGIC).map(Self::from)
    }
}

/// Opens the best model of a run folder, or a model file.
///
/// # Errors
/// The reason why the model cannot be read, as text.
pub fn open(path: &Path) -> Result<Model, String> {
    if path.is_dir() {
        return Ok(Trained::read(path).map_err(|error| error.to_string())?.model());
    }
    let named = |error: &dyn Display| format!("{}: {error}", path.display());
    decode(&fs::read(path).map_err(|error| named(&error))?).map_err(|error| named(&error))
}

impl From<Checkpoint> for Trained {
    fn from(checkpoint: Checkpoint) -> Self {
        let provenance = checkpoint.provenance();
        let Checkpoint { architecture, trained_step, range, calibration, state, .. } = checkpoint;
        let mut best = state.best;
        let calibrated = calibration.map(|layout| layout.read(&best.weights));
        // Entries after the weight block belong to logs or samples.
        best.weights.truncate(architecture.parameters().unwrap_or(usize::MAX));
        Self { architecture, trained_step, range, best, calibrated, iterations: state.iteration, provenance }
    }
}
