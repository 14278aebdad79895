//! The trained model that a new one begins from.

use super::Problem;
use crate::checkpoint::Trained;
use leastaction_models::file::decode;
use leastaction_models::{AnyFamily, Architecture, Corrections, FrictionArchitecture, ModularArchitecture};
use std::path::Path;

/// A trained tree of elements: its shape, whose numbers are the trained ones, and its weights.
pub(super) struct Source {
    pub architecture: ModularArchitecture,
    pub friction: FrictionArchitecture,
    pub corrections: Corrections,
    pub weights: Vec<f64>,
}

impl Source {
    /// The best weights of the run in a folder, in which what was learned is learned on; or a model file, in which all numbers
    /// are known.
    pub fn read(path: &Path) -> Result<Self, Problem> {
        let (architecture, weights) = if path.is_dir() { run(path) } else { file(path) }
            .map_err(|message| Problem::From { message })?;
        let Architecture { family, friction, corrections } = architecture;
        let of_networks = weights.len().saturating_sub(corrections.count());
        let friction = friction.with_numbers(weights.get(..of_networks).unwrap_or_default());
        match family {
            AnyFamily::Modular(modular) => {
                Ok(Self { architecture: modular.with_numbers(&weights), friction, corrections, weights })
            }
            other => Err(Problem::OtherFamily { file: path.to_owned(), found: other.name() }),
        }
    }
}

fn run(folder: &Path) -> Result<(Architecture, Vec<f64>), String> {
    let trained = Trained::read(folder).map_err(|error| error.to_string())?;
    Ok((trained.architecture, trained.best.weights))
}

fn file(path: &Path) -> Result<(Architecture, Vec<f64>), String> {
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| named(&error))?;
    let model = decode(&bytes).map_err(|error| named(&error))?;
    Ok((model.architecture, model.weights))
}
