//! The trained model that a new one begins from.

use crate::architecture::Architecture;
use crate::config::origin::Open;
use crate::config::problem::Problem;
use crate::laws::corrections::Corrections;
use crate::laws::group::GroupLaws;
use crate::model::Model;
use crate::modular::ModularArchitecture;
use crate::registry::AnyFamily;
use std::path::Path;

/// A trained tree of elements: its shape with the trained numbers, and its weights.
pub(super) struct Source {
    pub architecture: ModularArchitecture,
    pub group_laws: GroupLaws,
    pub corrections: Corrections,
    /// Numbers of the correction networks.
    pub networks: Vec<f64>,
    pub weights: Vec<f64>,
}

impl Source {
    /// Opens a trained tree. Numbers that were learned in a run stay learned; the numbers of a model file are all
    /// known.
    pub fn read(path: &Path, open: Open) -> Result<Self, Problem> {
        let Model { architecture, weights, .. } = open(path).map_err(|message| Problem::From { message })?;
        let networks = weights.get(architecture.corrections_place()).unwrap_or_default().to_vec();
        let Architecture { family, group_laws, corrections } = architecture;
        if group_laws.has_servos() {
            let message = "its commands are positions, which a model of elements does not take".into();
            return Err(Problem::From { message });
        }
        let group_laws = group_laws.with_numbers(&weights, corrections.count());
        match family {
            AnyFamily::Modular(modular) => Ok(Self {
                architecture: modular.with_numbers(&weights),
                group_laws,
                corrections,
                networks,
                weights,
            }),
            other => Err(Problem::OtherFamily { file: path.to_owned(), found: other.name() }),
        }
    }
}
