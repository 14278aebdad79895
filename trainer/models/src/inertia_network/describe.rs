//! Description of an inertia network in words.

use crate::inertia_network::InertiaNetworkArchitecture;
use crate::words::Describe;
use leastaction_core::energy::inertia_network::Inertia;
use serde::Serialize;

/// The network and the form of the inertia matrix.
#[derive(Serialize)]
pub struct InertiaNetworkDescription {
    /// Numbers of inputs and outputs of every layer.
    layers: Vec<[usize; 2]>,
    /// Name of the activation of the hidden layers.
    activation: String,
    /// Form of the inertia matrix.
    inertia: String,
}

impl From<&InertiaNetworkArchitecture> for InertiaNetworkDescription {
    fn from(network: &InertiaNetworkArchitecture) -> Self {
        Self {
            layers: network.layers().into_iter().map(|(inputs, outputs)| [inputs, outputs]).collect(),
            activation: format!("{:?}", network.activation).to_lowercase(),
            inertia: match network.inertia {
                Inertia::Diagonal => "diagonal".to_owned(),
                Inertia::Cholesky { epsilon } => format!("cholesky, epsilon {epsilon:e}"),
                Inertia::Factor { rows, epsilon } => format!("factor of {rows} rows, epsilon {epsilon:e}"),
            },
        }
    }
}

impl Describe for InertiaNetworkDescription {
    fn lines(&self) -> Vec<(&'static str, String)> {
        let Self { layers, activation, inertia } = self;
        let layers: Vec<_> = layers.iter().map(|[inputs, outputs]| format!("{inputs}x{outputs}")).collect();
        vec![("layers", format!("{} ({activation})", layers.join(", "))), ("inertia matrix", inertia.clone())]
    }
}
