//! A model whose numbers have followed a log.

use crate::{AdaptationError, Choice, Course, Request, along, deviations, on_chip};
use leastaction_data::Dataset;
use leastaction_models::Model;

/// Rounds in which the uncertainty of the model is taken from the log itself.
const ROUNDS: usize = 3;

/// Numbers of a model that have followed a log.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The numbers, with how uncertain the model is in itself.
    pub choice: Choice,
    /// Course along the log.
    pub course: Course,
    /// The model with the numbers in use at the end of the log.
    pub model: Model,
}

impl Followed {
    /// Lets numbers of a model follow a log. How uncertain the model is in itself is measured on the log that it learned from, `training`;
    /// without that, on the log itself, after the numbers have followed it.
    ///
    /// # Errors
    /// [`AdaptationError`].
    pub fn new(
        model: &Model,
        log: &Dataset,
        training: Option<&Dataset>,
        request: &Request,
    ) -> Result<Self, AdaptationError> {
        let mut choice = Choice::new(model, log.h, request)?;
        match training {
            Some(training) => {
                let own = Choice::new(model, training.h, request)?;
                choice.settings.deviation = measured(model, &own, training)?;
            }
            None => {
                choice.settings.deviation = measured(model, &choice, log)?;
                for _ in 0..ROUNDS {
                    let followed = Self::along(model, log, choice.clone())?;
                    choice.settings.deviation = measured(&followed.model, &choice, log)?;
                }
            }
        }
        Self::along(model, log, choice)
    }

    fn along(model: &Model, log: &Dataset, choice: Choice) -> Result<Self, AdaptationError> {
        let course = on_chip(model, |chip| along((model, chip), &choice, log))?;
        let distances = course.entries.last().map(|entry| entry.applied.as_slice()).unwrap_or_default();
        let model = choice.adapted(model, distances)?;
        Ok(Self { choice, course, model })
    }
}

fn measured(model: &Model, choice: &Choice, log: &Dataset) -> Result<Vec<f32>, AdaptationError> {
    on_chip(model, |chip| deviations((model, chip), choice, log))
}
