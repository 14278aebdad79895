//! Correction networks of a model: dissipation and a potential of a few coordinates.

pub mod config;

use crate::layers::{layers, random_layers};
use crate::limits::MAX_HIDDEN;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::{Law, LawNetwork, Laws, ModelError};
use leastaction_core::network::Activation;
use leastaction_programs::energies::{Energies, LawNetwork as HostNetwork, WithNetworks};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Initial diagonal entries of L: Q = −0.01 v, N s/m or N m s/rad. If the diagonal were 0, all derivatives would be 0.
const FIRST_ENTRY: f64 = 0.1;
/// Factor on the random initial outputs of the networks.
const FIRST_OUTPUTS: f64 = 0.1;

/// Networks in addition to a model's energies and friction: Q = −L(q, v)Lᵀv, which only removes energy, and V + V_c(q).
/// Their numbers are at the end of the weight block, in the order of the laws of a model file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Corrections {
    /// The network for L.
    pub dissipation: Option<DissipationNetwork>,
    /// The network for V_c.
    pub potential: Option<CorrectionNetwork>,
}

/// Inputs of a network, and its hidden layers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CorrectionNetwork {
    /// Input of each coordinate as a letter, up to the last coordinate that is an input: `t` its length, `a` its angle,
    /// `c` its velocity without its position, `-` nothing.
    pub coordinates: String,
    /// Numbers of units in the hidden layers.
    pub widths: Vec<u16>,
    /// Activation of the hidden layers.
    pub activation: Activation,
}

/// The network of a dissipation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DissipationNetwork {
    /// Inputs and layers.
    pub network: CorrectionNetwork,
    /// Scale > 0 that each input velocity is divided by, m/s or rad/s; known.
    pub scales: Vec<f64>,
}

impl CorrectionNetwork {
    fn from_header(header: &LawNetwork) -> Self {
        Self {
            coordinates: header.coordinates.to_owned(),
            widths: header.widths.into_iter().take_while(|width| *width != 0).collect(),
            activation: header.activation,
        }
    }

    /// The network as a model file states it.
    pub fn header(&self) -> LawNetwork<'_> {
        let mut widths = [0; MAX_HIDDEN];
        widths.iter_mut().zip(&self.widths).for_each(|(slot, width)| *slot = *width);
        LawNetwork { coordinates: &self.coordinates, widths, activation: self.activation }
    }

    /// Numbers of the coordinates that are inputs.
    pub fn seen(&self) -> impl Iterator<Item = usize> {
        self.coordinates.char_indices().filter(|(_, letter)| *letter != '-').map(|(i, _)| i)
    }

    fn host(&self) -> HostNetwork {
        HostNetwork {
            coordinates: self.coordinates.chars().map(Coordinate::from_letter).collect(),
            widths: self.widths.iter().map(|width| usize::from(*width)).collect(),
            activation: self.activation,
        }
    }

    /// Number of weights of its layers; 0 for an invalid network.
    fn count(&self, law: Law) -> usize {
        self.header().network(law).ok().and_then(|shape| shape.parameters()).unwrap_or(0)
    }

    /// Returns random weights that give small outputs.
    fn initial_weights(&self, law: Law, seed: u64) -> Vec<f64> {
        let Ok(shape) = self.header().network(law) else { return Vec::new() };
        let mut weights = random_layers(layers(&shape), seed);
        let (inputs, outputs) = layers(&shape).last().copied().unwrap_or((0, 0));
        let last = weights.len().saturating_sub((inputs + 1) * outputs);
        weights.iter_mut().skip(last).for_each(|weight| *weight *= FIRST_OUTPUTS);
        weights
    }
}

impl DissipationNetwork {
    /// Returns the scales, and weights of a network that hardly dissipates.
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = self.scales.clone();
        weights.extend(self.network.initial_weights(Law::Dissipation, seed));
        let m = self.scales.len();
        let biases = weights.len().saturating_sub(m * (m + 1) / 2);
        (0..m).for_each(|i| weights[biases + i * (i + 3) / 2] = FIRST_ENTRY);
        weights
    }
}

impl Corrections {
    /// Whether there are no networks.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the networks of a model file; their numbers are at the end of the weight block.
    pub(crate) fn from_laws(laws: Laws, weights: &[f64]) -> Self {
        let potential = laws.network(Law::Potential).map(|law| CorrectionNetwork::from_header(&law));
        let dissipation = laws.network(Law::Dissipation).map(|law| {
            let network = CorrectionNetwork::from_header(&law);
            DissipationNetwork { scales: vec![1.0; network.seen().count()], network }
        });
        let mut own = Self { dissipation, potential };
        let [numbers, _] = own.split(weights);
        let scales = own.dissipation.iter_mut().flat_map(|of| &mut of.scales);
        scales.zip(numbers).for_each(|(scale, number)| *scale = *number);
        own
    }

    /// Returns these laws together with those of the networks.
    pub(crate) fn laws<'a>(&'a self, friction: Laws<'a>) -> Laws<'a> {
        let laws =
            self.dissipation.as_ref().map_or(friction, |of| friction.with_dissipation(of.network.header()));
        self.potential.as_ref().map_or(laws, |of| laws.with_potential(of.header()))
    }

    /// Total count of the numbers of all networks.
    pub fn count(&self) -> usize {
        let of = |of: &DissipationNetwork| of.scales.len() + of.network.count(Law::Dissipation);
        self.dissipation.as_ref().map_or(0, of)
            + self.potential.as_ref().map_or(0, |of| of.count(Law::Potential))
    }

    /// Ranges of the numbers of the dissipation and of the potential in a weight block of this length; they are at its
    /// end.
    fn places(&self, length: usize) -> [Range<usize>; 2] {
        let start = length.saturating_sub(self.count());
        let potential = self.potential.as_ref().map_or(0, |of| of.count(Law::Potential));
        let middle = length.saturating_sub(potential).max(start);
        [start..middle, middle..length]
    }

    /// Splits off the numbers of the dissipation and of the potential, which are at the end of a weight block.
    pub fn split<'w>(&self, weights: &'w [f64]) -> [&'w [f64]; 2] {
        self.places(weights.len()).map(|place| weights.get(place).unwrap_or_default())
    }

    /// Writes the numbers of the dissipation and of the potential to the end of a weight block; an empty list leaves
    /// its part unchanged.
    pub fn put(&self, numbers: &[Vec<f64>; 2], weights: &mut [f64]) {
        for (place, own) in self.places(weights.len()).into_iter().zip(numbers) {
            let slots = weights.get_mut(place).unwrap_or_default();
            slots.iter_mut().zip(own).for_each(|(slot, own)| *slot = *own);
        }
    }

    /// Returns random weights with which the networks have almost no effect.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let dissipation = self.dissipation.iter().flat_map(|of| of.initial_weights(seed));
        // The random stream differs from that of the dissipation.
        let potential = self.potential.iter().flat_map(|of| of.initial_weights(Law::Potential, !seed));
        dissipation.chain(potential).collect()
    }

    /// Returns numbers with which the networks do not act at all: scales, and zeros.
    pub fn without_effect(&self) -> Vec<f64> {
        let mut numbers = vec![0.0; self.count()];
        let scales = self.dissipation.iter().flat_map(|of| &of.scales);
        numbers.iter_mut().zip(scales).for_each(|(number, scale)| *number = *scale);
        numbers
    }

    /// Positions of the numbers that training must leave unchanged, counted from `start`: the scales, and the last bias
    /// of a potential, which has no effect.
    pub(crate) fn fixed_positions(&self, start: usize) -> Vec<usize> {
        let scales = start..start + self.dissipation.as_ref().map_or(0, |of| of.scales.len());
        let constant = self.potential.iter().map(|_| (start + self.count()).saturating_sub(1));
        scales.chain(constant).collect()
    }

    /// Numbers of units in all hidden layers.
    pub fn widths(&self) -> impl Iterator<Item = usize> {
        self.networks().flat_map(|network| &network.widths).map(|width| usize::from(*width))
    }

    /// Number of hidden layers of the deeper network.
    pub fn depth(&self) -> usize {
        self.networks().map(|network| network.widths.len()).max().unwrap_or(0)
    }

    /// The networks that are present.
    pub fn networks(&self) -> impl Iterator<Item = &CorrectionNetwork> {
        self.dissipation.iter().map(|of| &of.network).chain(&self.potential)
    }

    /// Returns the energies of the model with the networks, as a program.
    pub(crate) fn energies(&self, model: Box<dyn Energies>) -> Result<Box<dyn Energies>, ModelError> {
        if self.is_none() {
            return Ok(model);
        }
        let [dissipation, potential] =
            [self.dissipation.as_ref().map(|of| &of.network), self.potential.as_ref()]
                .map(|network| network.map(CorrectionNetwork::host));
        let all = WithNetworks::new(model, dissipation.as_ref(), potential.as_ref());
        let all = all.ok_or(ModelError::OutOfRange { what: "coordinates of a law's network" })?;
        Ok(Box::new(all))
    }
}
