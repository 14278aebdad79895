//! Networks that correct a model, in words.

use leastaction_models::CorrectionNetwork;
use serde::Serialize;
use std::fmt;

/// What a network sees, and its hidden layers.
#[derive(Serialize)]
pub struct NetworkReport {
    /// The coordinates that it sees, from 0.
    coordinates: Vec<usize>,
    /// Those of them whose positions it sees.
    positions: Vec<usize>,
    /// What the velocities that it sees are divided by, m/s or rad/s.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scale: Vec<f64>,
    /// Units of the hidden layers.
    hidden: Vec<u16>,
    /// Of the hidden layers.
    activation: String,
}

impl NetworkReport {
    /// Of a network that divides velocities by these numbers.
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
        let names =
            |places: &[usize]| places.iter().map(|i| format!("q{}", i + 1)).collect::<Vec<_>>().join(", ");
        let Self { coordinates, positions, scale, hidden, activation } = self;
        write!(f, "sees {}", names(positions))?;
        if !scale.is_empty() {
            let joint = if positions.is_empty() { "" } else { " and " };
            write!(f, "{joint}the velocity of {} over {scale:?} m/s or rad/s", names(coordinates))?;
        }
        write!(f, ", hidden layers {hidden:?}, {activation}")
    }
}
