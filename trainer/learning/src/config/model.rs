//! `[model]`, whatever the family.

use super::arm::ArmConfig;
use super::bodies::BodiesConfig;
use super::fields::Coordinates;
use super::graph::GraphConfig;
use super::inertia_network::InertiaNetworkConfig;
use super::modular::ModularConfig;
use super::origin::Origin;
use super::problem::ShapeError;
use serde::Serialize;
use std::path::PathBuf;

/// The shape of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ModelConfig {
    /// `family = "inertia-network"`, the default.
    InertiaNetwork(InertiaNetworkConfig),
    /// `family = "modular"`.
    Modular(ModularConfig),
    /// `family = "graph"`.
    Graph(GraphConfig),
    /// `family = "bodies"`.
    Bodies(BodiesConfig),
    /// `family = "arm"`.
    Arm(ArmConfig),
}

impl From<ArmConfig> for ModelConfig {
    fn from(arm: ArmConfig) -> Self {
        Self::Arm(arm)
    }
}

impl ModelConfig {
    /// The model of another shape whose energies training begins at, where there is one.
    pub(crate) fn origin(&self) -> Result<Option<Origin>, ShapeError> {
        match self {
            Self::InertiaNetwork(inertia_network) => inertia_network.origin(),
            _ => Ok(None),
        }
    }

    /// Whether training begins with trained networks that correct the model.
    pub(crate) fn has_trained_networks(&self) -> bool {
        matches!(self, Self::Modular(modular) if modular.from.is_some())
    }

    /// The same with these of the networks that correct a model alone, as they are given or else by default; `None` where its coordinates
    /// can have none.
    pub(crate) fn with_networks(&self, with_dissipation: bool, with_potential: bool) -> Option<Self> {
        let mut own = self.clone();
        let (dissipation, potential) = match &mut own {
            Self::InertiaNetwork(inertia_network) => {
                (&mut inertia_network.dissipation, &mut inertia_network.potential)
            }
            Self::Modular(modular) => (&mut modular.dissipation, &mut modular.potential),
            Self::Bodies(bodies) => (&mut bodies.dissipation, &mut bodies.potential),
            Self::Arm(arm) => (&mut arm.dissipation, &mut arm.potential),
            Self::Graph(_) => return None,
        };
        *dissipation = with_dissipation.then(|| dissipation.take().unwrap_or_default());
        *potential = with_potential.then(|| potential.take().unwrap_or_default());
        Some(own)
    }

    /// The files that the model comes from.
    pub(crate) fn files(&mut self) -> Vec<&mut PathBuf> {
        match self {
            Self::InertiaNetwork(inertia_network) => inertia_network.start_from.iter_mut().collect(),
            Self::Modular(modular) => modular.from.iter_mut().collect(),
            Self::Arm(arm) => arm.files(),
            Self::Graph(_) | Self::Bodies(_) => Vec::new(),
        }
    }

    /// Whether it is an arm.
    pub(crate) fn is_arm(&self) -> bool {
        matches!(self, Self::Arm(_))
    }

    /// Whether training begins with trained weights.
    pub(crate) fn goes_on(&self) -> bool {
        match self {
            Self::InertiaNetwork(inertia_network) => inertia_network.start_from.is_some(),
            Self::Modular(modular) => modular.from.is_some(),
            _ => false,
        }
    }
}

impl From<Coordinates> for ModelConfig {
    fn from(coordinates: Coordinates) -> Self {
        Self::InertiaNetwork(InertiaNetworkConfig::new(coordinates))
    }
}

impl From<InertiaNetworkConfig> for ModelConfig {
    fn from(inertia_network: InertiaNetworkConfig) -> Self {
        Self::InertiaNetwork(inertia_network)
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
