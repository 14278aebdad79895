//! `[model]` of the rigid family.

use super::fields::{self, Coordinates, InertiaKind};
use crate::architecture::{Architecture, RigidArchitecture};
use leastaction_core::energy::rigid::Inertia;
use leastaction_core::network::Activation;
use serde::{Deserialize, Serialize};

/// The shape of a rigid model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidConfig {
    /// What each coordinate is.
    pub coordinates: Coordinates,
    /// Units of the hidden layers.
    #[serde(default = "hidden", deserialize_with = "fields::widths")]
    pub hidden: Vec<u16>,
    /// Of the hidden layers.
    #[serde(default = "activation", with = "fields::ActivationName")]
    pub activation: Activation,
    /// The inertia matrix; by default diagonal for one coordinate, else Cholesky.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<InertiaKind>,
    /// ε of the Cholesky form, ≥ 0.
    #[serde(default = "epsilon", deserialize_with = "fields::epsilon")]
    pub epsilon: f32,
    /// Whether viscous damping is learned.
    #[serde(default)]
    pub damping: bool,
}

fn hidden() -> Vec<u16> {
    vec![24, 24]
}

fn activation() -> Activation {
    Activation::Tanh
}

fn epsilon() -> f32 {
    1e-9
}

impl RigidConfig {
    /// The defaults for these coordinates.
    pub fn new(coordinates: Coordinates) -> Self {
        Self {
            coordinates,
            hidden: hidden(),
            activation: activation(),
            inertia: None,
            epsilon: epsilon(),
            damping: false,
        }
    }

    /// The shape of the model.
    pub fn architecture(&self) -> Architecture {
        let Self { coordinates, hidden, activation, damping, .. } = self;
        let plain = RigidArchitecture::new(&coordinates.0, 0);
        let cholesky = Inertia::Cholesky { epsilon: self.epsilon };
        let inertia = match (self.inertia, plain.inertia) {
            (Some(InertiaKind::Diagonal), _) | (None, Inertia::Diagonal) => Inertia::Diagonal,
            _ => cholesky,
        };
        RigidArchitecture {
            widths: hidden.clone(),
            activation: *activation,
            inertia,
            damped: *damping,
            ..plain
        }
        .into()
    }
}
