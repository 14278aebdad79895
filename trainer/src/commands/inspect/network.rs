//! Description of networks that correct a model.

use leastaction_models::CorrectionNetwork;
use serde::Serialize;
use std::fmt;

/// Inputs of a network, and its hidden layers.
#[derive(Serialize)]
pub struct NetworkReport {
    /// Coordinates that the network depends on, from 0.
    coordinates: Vec<usize>,
    /// Coordinates whose positions it depends on.
    positions: Vec<usize>,
    /// Divisors of the velocities, m/s or rad/s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scale: Vec<f64>,
    /// Units of the hidden layers.
    hidden: Vec<u16>,
    /// Activation of the hidden layers.
    activation: String,
}

impl NetworkReport {
    /// Describes a network with these divisors of velocities.
    pub fn of(network: &CorrectionNetwork, scale: &[f64]) -> Self {
        let coordinates: Vec<usize> = network.seen().collect();
        let letters: Vec<char> = network.coordinates.chars().collect();
        let has_position = |i: &usize| letters.get(*i).is_some_and(|letter| *letter != 'c');
        Self {
            positions: coordinates.iter().copied().filter(has_position).collect(),
            coordinates,
            scale: scale.to_vec(),
            hidden: network.widths.clone(),
            activation: format!("{:?}", network.activation).to_lowercase(),
        }
    }
}

impl fmt::Display for NetworkReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let names = |places: &[usize]| places.iter().map(|i| format!("q{i}")).collect::<Vec<_>>().join(", ");
        let Self { coordinates, positions, scale, hidden, activation } = self;
        write!(f, "sees {}", names(positions))?;
        if !scale.is_empty() {
            let joint = if positions.is_empty() { "" } else { " and " };
            write!(f, "{joint}the velocity of {} over {scale:?} m/s or rad/s", names(coordinates))?;
        }
        write!(f, ", hidden layers {hidden:?}, {activation}")
    }
}
