//! Training of the models that papers compare with: by Adam, with their authors' recipes, within limits.

use super::interrupted::{Course, Interrupted};
use super::task::TaskError;
use crate::baselines::AccelerationModel;
use leastaction_learning::training::{Adam, AdamSettings, Objective, Progress, Samples};
use serde::{Serialize, Serializer};
use std::time::{Duration, Instant};

/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(10);
/// Time between writes of the training state.
const WRITTEN: Duration = Duration::from_secs(60);

/// Limits of the training of a baseline, in addition to the end of its recipe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Limits {
    /// Number of epochs; `None` for the number in the recipe.
    pub epochs: Option<u64>,
    /// Wall time of training, and separately of the predictions.
    pub time: Option<Duration>,
}

impl Limits {
    /// Deadline of predictions that begin now.
    pub(super) fn deadline(&self) -> Option<Instant> {
        self.time.map(|time| Instant::now() + time)
    }

    /// Rough duration of a baseline, s.
    pub(super) fn expected_seconds(&self) -> f64 {
        const AN_HOUR: f64 = 3_600.0;
        self.time.map_or(AN_HOUR, |time| 1.5 * time.as_secs_f64())
    }
}

/// Whether a deadline has passed.
pub(super) fn is_past(deadline: Option<Instant>) -> bool {
    deadline.is_some_and(|deadline| Instant::now() > deadline)
}

/// Way in which a training ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ending {
    /// The recipe was completed.
    #[default]
    Complete,
    /// The time ran out.
    OutOfTime {
        /// Number of epochs done.
        epoch: u64,
    },
    /// The loss became infinite or NaN.
    Diverged {
        /// Epoch in which it did.
        epoch: u64,
    },
}

impl Ending {
    /// Description in words; `None` if training was complete.
    pub fn words(self) -> Option<String> {
        match self {
            Self::Complete => None,
            Self::OutOfTime { epoch } => Some(format!("out of time at epoch {epoch}")),
            Self::Diverged { epoch } => Some(format!("diverged at epoch {epoch}")),
        }
    }
}

/// Serialises [`Ending::words`].
pub(super) fn in_words<S: Serializer>(ending: &Ending, serializer: S) -> Result<S::Ok, S::Error> {
    ending.words().serialize(serializer)
}

/// Training of a baseline by Adam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Number of passes through the samples.
    pub epochs: u64,
    /// Settings of the steps.
    pub adam: AdamSettings,
}

/// Result of a training.
pub(super) struct Trained {
    pub weights: Vec<f64>,
    /// Number of epochs done.
    pub epochs: u64,
    /// Training time, s.
    pub seconds: f64,
    pub ending: Ending,
}

/// Limits of a training, and the file for its state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounds<'a> {
    /// Limits of the training.
    pub limits: Limits,
    /// File for the state; `None` for no file.
    pub interrupted: Option<&'a Interrupted>,
}

impl Recipe {
    /// Trains until a limit, or until the loss is not finite; then the last weights with a finite loss are returned.
    /// `tell` occasionally gets a line of progress. Interrupted training continues, with the same bits.
    pub(super) fn train(
        &self,
        model: &dyn AccelerationModel,
        samples: Samples,
        (seed, bounds): (u64, Bounds),
        tell: &dyn Fn(&str),
    ) -> Result<Trained, TaskError> {
        let objective = model.training(samples)?;
        let mut course = match bounds.interrupted.map_or(Ok(None), Interrupted::read)? {
            Some(course) => course,
            None => {
                let good = model.initial_weights(seed);
                Course { adam: Adam::new(&*objective, good.clone(), self.adam), good, spent: Duration::ZERO }
            }
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

    fn follow(
        &self,
        course: &mut Course,
        objective: &dyn Objective,
        Bounds { limits, interrupted }: Bounds,
        tell: &dyn Fn(&str),
    ) -> Result<Ending, TaskError> {
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
            // The computed loss is that of the weights before the step.
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
