//! How the models that papers compare with are trained: by Adam, as their authors do, within limits.

use crate::baselines::AccelerationModel;
use crate::training::{Adam, AdamSettings, Progress, Samples};
use leastaction_core::model::ModelError;
use serde::{Serialize, Serializer};
use std::time::{Duration, Instant};

/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(10);

/// Where the training of a baseline ends, beside the end of its recipe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Limits {
    /// Epochs; `None`: the recipe's.
    pub epochs: Option<u64>,
    /// Wall time of training, and again of the predictions.
    pub time: Option<Duration>,
}

impl Limits {
    /// When the predictions must be done that begin now.
    pub(super) fn deadline(&self) -> Option<Instant> {
        self.time.map(|time| Instant::now() + time)
    }

    /// How long a baseline takes, s, roughly.
    pub(super) fn expected_seconds(&self) -> f64 {
        const AN_HOUR: f64 = 3_600.0;
        self.time.map_or(AN_HOUR, |time| 1.5 * time.as_secs_f64())
    }
}

/// How training ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// As its recipe has it.
    Complete,
    /// There was no more time.
    OutOfTime {
        /// Epochs done.
        epoch: u64,
    },
    /// The loss was not a finite number any more.
    Diverged {
        /// In this epoch.
        epoch: u64,
    },
}

impl Ending {
    /// In words; `None` where training was complete.
    pub fn words(self) -> Option<String> {
        match self {
            Self::Complete => None,
            Self::OutOfTime { epoch } => Some(format!("out of time at epoch {epoch}")),
            Self::Diverged { epoch } => Some(format!("diverged at epoch {epoch}")),
        }
    }
}

/// As [`Ending::words`].
pub(super) fn in_words<S: Serializer>(ending: &Ending, serializer: S) -> Result<S::Ok, S::Error> {
    ending.words().serialize(serializer)
}

/// How a baseline is trained: by Adam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Passes through the samples.
    pub epochs: u64,
    /// Steps.
    pub adam: AdamSettings,
}

/// What training gives.
pub(super) struct Trained {
    pub weights: Vec<f64>,
    /// Epochs done.
    pub epochs: u64,
    pub ending: Ending,
}

impl Recipe {
    /// Trains until a limit, or until the loss is not a number any more: then the weights are the last that had one. `tell` gets
    /// a line of progress now and then.
    pub(super) fn train(
        &self,
        model: &dyn AccelerationModel,
        samples: Samples,
        (seed, limits): (u64, Limits),
        tell: &dyn Fn(&str),
    ) -> Result<Trained, ModelError> {
        let clock = Instant::now();
        let (epochs, mut told) = (limits.epochs.unwrap_or(self.epochs), clock);
        let objective = model.training(samples)?;
        let mut adam = Adam::new(&*objective, model.initial_weights(seed), self.adam);
        let mut good = adam.weights.clone();
        for epoch in 1..=epochs {
            if limits.time.is_some_and(|time| clock.elapsed() >= time) {
                let ending = Ending::OutOfTime { epoch: epoch - 1 };
                return Ok(Trained { weights: adam.weights, epochs: epoch - 1, ending });
            }
            let before = adam.weights.clone();
            if adam.iterate(&*objective) == Progress::Stuck || !adam.loss.is_finite() {
                return Ok(Trained { weights: good, epochs: epoch - 1, ending: Ending::Diverged { epoch } });
            }
            // The loss is that of the weights before the step.
            good = before;
            if told.elapsed() >= PAUSE {
                told = Instant::now();
                tell(&format!("epoch {epoch} of {epochs}: training loss {:.2e}", adam.loss));
            }
        }
        Ok(Trained { weights: adam.weights, epochs, ending: Ending::Complete })
    }
}
