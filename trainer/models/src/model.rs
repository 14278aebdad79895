//! A model on the host: one object for every use.

use crate::precision::Precision;
use crate::{Actuator, Architecture};
use leastaction_core::model::{CoordinateRange, FORMAT_VERSION, ModelError, TrainedStep};
use leastaction_programs::System;

/// A model: its shape, its weights, and everything else that its steps depend on.
///
/// Forces are τ, at the actuator's output. Logs hold commands u; the actuator converts between the two.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Shape of the model.
    pub architecture: Architecture,
    /// Weight block; if the model was read from a file, every number can be represented in `precision`.
    pub weights: Vec<f64>,
    /// Precision of the weights in a file.
    pub precision: Precision,
    /// Actuator, step, range and provenance.
    pub facts: Facts,
    /// Format version of the file from which the model was read.
    pub version: u8,
}

/// Properties of a model beside its shape and weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Step that the model was trained with, if any.
    pub trained_step: Option<TrainedStep>,
    /// Range of the training data in every coordinate; empty if unknown.
    pub range: Vec<CoordinateRange>,
    /// Actuator, from commands to forces.
    pub actuator: Actuator,
    /// Origin of the model, as a text.
    pub provenance: String,
}

impl Facts {
    /// Creates facts with a trained step and a provenance text.
    pub fn new(trained_step: Option<TrainedStep>, provenance: &str) -> Self {
        Self { trained_step, provenance: provenance.to_owned(), ..Self::default() }
    }
}

impl Model {
    /// Creates a model with this shape and these weights; its commands are forces.
    pub fn new(architecture: impl Into<Architecture>, weights: Vec<f64>) -> Self {
        Self {
            architecture: architecture.into(),
            weights,
            precision: Precision::Single,
            facts: Facts::default(),
            version: FORMAT_VERSION,
        }
    }

    /// Returns the model with these facts.
    #[must_use]
    pub fn with_facts(self, facts: Facts) -> Self {
        Self { facts, ..self }
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.architecture.n()
    }

    /// Energies and forces, from which the programs are made.
    ///
    /// # Errors
    /// [`ModelError`] if the shape is inconsistent or the weights do not fit it.
    pub fn system(&self) -> Result<System, ModelError> {
        let system = System::new(&*self.architecture.energies()?);
        if system.parameters() == self.weights.len() {
            Ok(system)
        } else {
            Err(ModelError::WeightCount { found: self.weights.len(), needed: system.parameters() })
        }
    }

    /// Weights in single precision, as they are shipped.
    pub fn weights_f32(&self) -> Vec<f32> {
        self.weights.iter().map(|w| *w as f32).collect()
    }
}
