//! What a configuration of a family is.

use super::origin::{Open, Origin};
use super::problem::ShapeError;
use crate::architecture::Architecture;
use crate::laws::corrections::config::{DissipationConfig, PotentialConfig};
use std::path::PathBuf;

/// Networks beside a family: one that dissipates and one that is added to the potential.
pub type NetworksBeside<'c> = (&'c mut Option<DissipationConfig>, &'c mut Option<PotentialConfig>);

/// What training takes from a trained model that the configuration names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Nothing: there is none, or its numbers stand in the shape.
    Nothing,
    /// Its energies.
    Energies,
    /// Its weights, networks included.
    Weights,
}

/// `[model]` of a family.
pub trait FamilyConfig {
    /// A configuration with every key of `[model]` explained, TOML.
    fn defaults() -> &'static str
    where
        Self: Sized;

    /// Files that it names, relative to the configuration file.
    fn files(&mut self) -> Vec<&mut PathBuf> {
        Vec::new()
    }

    /// Networks beside the family; `None` where its coordinates can have none.
    fn networks(&mut self) -> Option<NetworksBeside<'_>>;

    /// What training takes from a model that the configuration names.
    fn source(&self) -> Source {
        Source::Nothing
    }

    /// The model whose energies training begins at, where there is one.
    ///
    /// # Errors
    /// [`ShapeError`] where it cannot be read, or is of other coordinates.
    fn origin(&self, _open: Open) -> Result<Option<Origin>, ShapeError> {
        Ok(None)
    }

    /// The shape of the model.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError>;

    /// Refuses what cannot be a model.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn check(&self, open: Open) -> Result<(), ShapeError> {
        self.architecture(open).map(drop)
    }

    /// The shape of the model, and the weights that training begins with.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn beginning(&self, seed: u64, open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        let architecture = self.architecture(open)?;
        let weights = architecture.initial_weights(seed);
        Ok((architecture, weights))
    }
}
