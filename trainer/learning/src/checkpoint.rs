//! The checkpoint of a run: where it is, to go on bit for bit, and the best weights so far.

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

/// Its name in the folder of a run.
pub(crate) const FILE: &str = "checkpoint.postcard";

/// The first bytes of the file: what it is, and the version of its layout.
const MAGIC: &[u8] = b"LARUN\x08";

/// Everything in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// The configuration without what may change on resuming, as TOML.
    pub identity: String,
    /// Fingerprint of the data.
    pub data: u64,
    /// Of the model.
    pub architecture: Architecture,
    /// Of the model.
    pub trained_step: Option<TrainedStep>,
    /// What the data covered.
    pub range: Vec<CoordinateRange>,
    /// Where what is learned of sensors and actuators is, among the numbers of a loss over windows.
    pub calibration: Option<CalibrationLayout>,
    /// Where the run is.
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

/// The best weights of a stage, and their losses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// The weight block.
    pub weights: Vec<f64>,
    /// The iteration that gave them.
    pub iteration: u64,
    /// Their training loss.
    pub train: f64,
    /// Their loss on the trajectories held back.
    pub validation: Option<f64>,
    /// Their error of the next position, where the DEL residual is minimised.
    pub next_position: Option<f64>,
    /// Whether they can solve none of the training samples, as was found when training ended: all samples then count as predicted by
    /// a constant velocity.
    pub solves_nothing: bool,
}

impl Best {
    /// Whether it is of use: its training loss is a number, and not that of constant velocities alone.
    pub fn is_a_model(&self) -> bool {
        self.train.is_finite() && !self.solves_nothing && self.weights.iter().all(|weight| weight.is_finite())
    }
}

/// The state of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// Position in the plan's stages.
    pub stage: usize,
    /// Iterations done in this stage.
    pub in_stage: u64,
    /// Iterations done in all.
    pub iteration: u64,
    /// Seconds of training.
    pub seconds: f64,
    /// Of this stage.
    pub optimiser: Optimiser,
    /// Of this stage.
    pub best: Best,
    /// The best numbers of the model alone, before networks that correct it.
    pub alone: Option<Vec<f64>>,
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

/// A trained model as a run holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// Its shape.
    pub architecture: Architecture,
    /// The step that it was trained with, where the loss has one.
    pub trained_step: Option<TrainedStep>,
    /// What the training data covered of every coordinate.
    pub range: Vec<CoordinateRange>,
    /// The best weights of the model and their losses.
    pub best: Best,
    /// Sensors and actuators, of a loss over windows.
    pub calibrated: Option<Calibrated>,
    /// Iterations of the run so far.
    pub iterations: u64,
    /// Where it comes from, for people: the same for the same run.
    pub provenance: String,
}

impl Trained {
    /// What a model file says of it beside its shape and weights.
    pub fn facts(&self) -> Facts {
        let Self { trained_step, range, provenance, calibrated, .. } = self.clone();
        let actuator = calibrated.map_or_else(Actuator::default, |calibrated| calibrated.actuator);
        Facts { range, actuator, ..Facts::new(trained_step, &provenance) }
    }

    /// The best model.
    pub fn model(&self) -> Model {
        Model::new(self.architecture.clone(), self.best.weights.clone()).with_facts(self.facts())
    }

    /// The best model of the run in a folder.
    ///
    /// # Errors
    /// [`CheckpointError`] where there is no usable checkpoint.
    pub fn read(folder: &Path) -> Result<Self, CheckpointError> {
        Ok(Checkpoint::read(&folder.join(FILE))?.into())
    }

    /// The same, of the bytes of a checkpoint; `None` where they are none, or were damaged.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        checksummed::decode::<Checkpoint>(bytes, MAGIC).map(Self::from)
    }
}

/// The best model of the run in a folder, or the model of a file.
///
/// # Errors
/// Why it cannot be read.
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
        // What follows the weight block belongs to logs or samples.
        best.weights.truncate(architecture.parameters().unwrap_or(usize::MAX));
        Self { architecture, trained_step, range, best, calibrated, iterations: state.iteration, provenance }
    }
}
