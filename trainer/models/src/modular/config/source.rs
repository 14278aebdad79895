//! The trained model that a new one begins from.

use crate::architecture::Architecture;
use crate::config::origin::Open;
use crate::config::problem::Problem;
use crate::laws::corrections::Corrections;
use crate::laws::friction::FrictionArchitecture;
use crate::model::Model;
use crate::modular::ModularArchitecture;
use crate::registry::AnyFamily;
use std::path::Path;

/// A trained tree of elements: its shape with the trained numbers, and its weights.
pub(super) struct Source {
    pub architecture: ModularArchitecture,
    pub friction: FrictionArchitecture,
    pub corrections: Corrections,
    pub weights: Vec<f64>,
}

impl Source {
    /// Opens a trained tree. Numbers that were learned in a run stay learned; the numbers of a model file are all
    /// known.
    pub fn read(path: &Path, open: Open) -> Result<Self, Problem> {
        let Model { architecture, weights, .. } = open(path).map_err(|message| Problem::From { message })?;
        let Architecture { family, friction, corrections, servo } = architecture;
        if !servo.is_none() {
            let message = "its commands are positions, which a model of elements does not take".into();
            return Err(Problem::From { message });
        }
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
