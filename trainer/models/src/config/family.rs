//! The interface of a family's configuration.

use super::origin::{Open, Origin};
use super::place::ShapeError;
use crate::architecture::Architecture;
use crate::laws::corrections::config::{DissipationConfig, PotentialConfig};
use crate::urdf::DescriptionNote;
use std::path::PathBuf;

/// Networks beside a family: one that dissipates energy and one that is added to the potential.
pub type NetworksBeside<'c> = (&'c mut Option<DissipationConfig>, &'c mut Option<PotentialConfig>);

/// Data that training takes from a trained model named by the configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Nothing: no model is named, or its numbers are already in the shape.
    Nothing,
    /// The energies of the model.
    Energies,
    /// The weights of the model, networks included.
    Weights,
}

/// `[model]` of a family.
pub trait FamilyConfig {
    /// Returns a TOML configuration with every key of `[model]` explained.
    fn defaults() -> &'static str
    where
        Self: Sized;

    /// Files named by the configuration, relative to the configuration file.
    fn files(&mut self) -> Vec<&mut PathBuf> {
        Vec::new()
    }

    /// Networks beside the family; `None` if its coordinates can have none.
    fn networks(&mut self) -> Option<NetworksBeside<'_>>;

    /// Data that training takes from a model named by the configuration.
    fn source(&self) -> Source {
        Source::Nothing
    }

    /// Opens the model at whose energies training begins, if there is one.
    ///
    /// # Errors
    /// [`ShapeError`] if it cannot be read or has other coordinates.
    fn origin(&self, _open: Open) -> Result<Option<Origin>, ShapeError> {
        Ok(None)
    }

    /// Returns the shape of the model.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn architecture(&self, open: Open) -> Result<Architecture, ShapeError>;

    /// Returns notes on the description of a robot that the model is made from.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn notes(&self, _open: Open) -> Result<Vec<DescriptionNote>, ShapeError> {
        Ok(Vec::new())
    }

    /// Returns the shape of the model and the weights that training begins with.
    ///
    /// # Errors
    /// [`ShapeError`]: what is wrong, and where.
    fn beginning(&self, seed: u64, open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        let architecture = self.architecture(open)?;
        let weights = architecture.initial_weights(seed);
        Ok((architecture, weights))
    }
}
