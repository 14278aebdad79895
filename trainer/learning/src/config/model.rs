//! `[model]`, whatever the family.

use super::bodies::BodiesConfig;
use super::fields::Coordinates;
use super::graph::GraphConfig;
use super::modular::ModularConfig;
use super::origin::Origin;
use super::problem::ShapeError;
use super::rigid::RigidConfig;
use serde::Serialize;

/// The shape of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ModelConfig {
    /// `family = "rigid"`, the default.
    Rigid(RigidConfig),
    /// `family = "modular"`.
    Modular(ModularConfig),
    /// `family = "graph"`.
    Graph(GraphConfig),
    /// `family = "bodies"`.
    Bodies(BodiesConfig),
}

impl ModelConfig {
    /// The model of another shape whose energies training begins at, where there is one.
    pub(crate) fn origin(&self) -> Result<Option<Origin>, ShapeError> {
        match self {
            Self::Rigid(rigid) => rigid.origin(),
            _ => Ok(None),
        }
    }

    /// Whether training begins with trained weights.
    pub(crate) fn goes_on(&self) -> bool {
        match self {
            Self::Rigid(rigid) => rigid.start_from.is_some(),
            Self::Modular(modular) => modular.from.is_some(),
            _ => false,
        }
    }
}

impl From<Coordinates> for ModelConfig {
    fn from(coordinates: Coordinates) -> Self {
        Self::Rigid(RigidConfig::new(coordinates))
    }
}

impl From<RigidConfig> for ModelConfig {
    fn from(rigid: RigidConfig) -> Self {
        Self::Rigid(rigid)
    }
}

impl From<ModularConfig> for ModelConfig {
    fn from(modular: ModularConfig) -> Self {
        Self::Modular(modular)
    }
}

impl From<GraphConfig> for ModelConfig {
    fn from(graph: GraphConfig) -> Self {
        Self::Graph(graph)
    }
}

impl From<BodiesConfig> for ModelConfig {
    fn from(bodies: BodiesConfig) -> Self {
        Self::Bodies(bodies)
    }
}
