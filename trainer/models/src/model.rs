//! A model on the host: one object that every path asks.

use crate::precision::Precision;
use crate::{Actuator, Architecture};
use leastaction_core::model::{CoordinateRange, FORMAT_VERSION, ModelError, TrainedStep};
use leastaction_programs::System;

/// A model: its shape and weights, and all else that a step of it depends on.
///
/// Forces are τ, at the actuator's output; along logs, which have commands u, the actuator makes one of the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Shape.
    pub architecture: Architecture,
    /// Weight block; of a model that was read every number is one of `precision`.
    pub weights: Vec<f64>,
    /// Precision of the weights in a file.
    pub precision: Precision,
    /// Actuator, step, range and provenance.
    pub facts: Facts,
    /// Version of the format that it was read from.
    pub version: u8,
}

/// What a model has beside shape and weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Step that it was trained with, where it was.
    pub trained_step: Option<TrainedStep>,
    /// What the training data covered of every coordinate; empty where that is not known.
    pub range: Vec<CoordinateRange>,
    /// From commands to forces.
    pub actuator: Actuator,
    /// Where it comes from.
    pub provenance: String,
}

impl Facts {
    /// A step and a text.
    pub fn new(trained_step: Option<TrainedStep>, provenance: &str) -> Self {
        Self { trained_step, provenance: provenance.to_owned(), ..Self::default() }
    }
}

impl Model {
    /// A model of this shape and weights, whose commands are forces.
    pub fn new(architecture: impl Into<Architecture>, weights: Vec<f64>) -> Self {
        Self {
            architecture: architecture.into(),
            weights,
            precision: Precision::Single,
            facts: Facts::default(),
            version: FORMAT_VERSION,
        }
    }

    /// The model with these facts.
    #[must_use]
    pub fn with_facts(self, facts: Facts) -> Self {
        Self { facts, ..self }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.architecture.n()
    }

    /// Energies and forces, from which programs are made.
    ///
    /// # Errors
    /// [`ModelError`] where the shape does not fit in itself, or the weights to the shape.
    pub fn system(&self) -> Result<System, ModelError> {
        let system = System::new(&*self.architecture.energies()?);
        if system.parameters() == self.weights.len() {
            Ok(system)
        } else {
            Err(ModelError::WeightCount { found: self.weights.len(), needed: system.parameters() })
        }
    }

    /// Weights as shipped.
    pub fn weights_f32(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }
}
