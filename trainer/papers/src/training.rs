//! How the models that papers compare with are trained: by Adam, as their authors do, within limits.

use super::folder::FolderError;
use super::interrupted::{Course, Interrupted};
use crate::baselines::AccelerationModel;
use leastaction_core::model::ModelError;
use leastaction_learning::training::{Adam, AdamSettings, Objective, Progress, Samples};
use serde::{Serialize, Serializer};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(10);
/// Time after which it is written down how far training is.
const WRITTEN: Duration = Duration::from_secs(60);

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
    /// That they took, s.
    pub seconds: f64,
    pub ending: Ending,
}

/// Where training ends, and where it is written down now and then.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounds<'a> {
    /// When.
    pub limits: Limits,
    /// Where; `None`: nowhere.
    pub interrupted: Option<&'a Interrupted>,
}

/// Training that cannot be done.
#[derive(Debug, Error)]
pub enum TrainingError {
    /// The shape does not fit in itself or the data.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// It cannot go on where it was interrupted, or not be written down.
    #[error(transparent)]
    Interrupted(#[from] FolderError),
}

impl Recipe {
    /// Trains until a limit, or until the loss is not a number any more: then the weights are the last that had one. `tell` gets
    /// a line of progress now and then. Where it was interrupted before it goes on, to the same bits.
    pub(super) fn train(
        &self,
        model: &dyn AccelerationModel,
        samples: Samples,
        (seed, bounds): (u64, Bounds),
        tell: &dyn Fn(&str),
    ) -> Result<Trained, TrainingError> {
        let objective = model.training(samples)?;
        let mut course = match bounds.interrupted.map_or(Ok(None), Interrupted::read)? {
            Some(course) => course,
            None => self.begin(&*objective, model.initial_weights(seed)),
        };
        if course.adam.epoch() > 0 {
            tell(&format!("goes on after epoch {}", course.adam.epoch()));
        }
        let ending = self.follow(&mut course, &*objective, bounds, tell)?;
        let (epochs, weights) = match ending {
            Ending::Diverged { epoch } => (epoch - 1, course.good),
            Ending::Complete | Ending::OutOfTime { .. } => (course.adam.epoch(), course.adam.weights),
        };
        Ok(Trained { weights, epochs, seconds: course.spent.as_secs_f64(), ending })
    }

    fn begin(&self, objective: &dyn Objective, weights: Vec<f64>) -> Course {
        let good = weights.clone();
        Course { adam: Adam::new(objective, weights, self.adam), good, spent: Duration::ZERO }
    }

    fn follow(
        &self,
        course: &mut Course,
        objective: &dyn Objective,
        Bounds { limits, interrupted }: Bounds,
        tell: &dyn Fn(&str),
    ) -> Result<Ending, TrainingError> {
        let epochs = limits.epochs.unwrap_or(self.epochs);
        let (spent, clock) = (course.spent, Instant::now());
        let (mut told, mut written) = (clock, clock);
        while course.adam.epoch() < epochs {
            if limits.time.is_some_and(|time| spent + clock.elapsed() >= time) {
                return Ok(Ending::OutOfTime { epoch: course.adam.epoch() });
            }
            let (epoch, before) = (course.adam.epoch() + 1, course.adam.weights.clone());
            if course.adam.iterate(objective) == Progress::Stuck || !course.adam.loss.is_finite() {
                return Ok(Ending::Diverged { epoch });
            }
            // The loss is that of the weights before the step.
            course.good = before;
            course.spent = spent + clock.elapsed();
            if told.elapsed() >= PAUSE {
                told = Instant::now();
                tell(&format!("epoch {epoch} of {epochs}: training loss {:.2e}", course.adam.loss));
            }
            if let Some(interrupted) = interrupted.filter(|_| epoch == epochs || written.elapsed() >= WRITTEN)
            {
                written = Instant::now();
                interrupted.write(course)?;
            }
        }
        Ok(Ending::Complete)
    }
}

#[cfg(test)]
#[path = "training_tests.rs"]
mod tests;
