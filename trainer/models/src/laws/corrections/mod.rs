//! Networks that correct a model: dissipation and a potential of a few coordinates.

pub mod config;

use crate::layers::{layers, random_layers};
use crate::limits::MAX_HIDDEN;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::{Law, LawNetwork, Laws, ModelError};
use leastaction_core::network::Activation;
use leastaction_programs::energies::{Energies, LawNetwork as HostNetwork, WithNetworks};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Every diagonal entry of L where training begins: Q = −0.01 v, N s/m or N m s/rad. At 0 no entry would have a derivative.
const FIRST_ENTRY: f64 = 0.1;
/// By how much outputs of networks are smaller than random ones where training begins.
const FIRST_OUTPUTS: f64 = 0.1;

/// Networks beside a model's energies and friction: Q = −L(q, v)Lᵀv, which only takes energy away, and V + V_c(q). Their numbers end
/// the weight block as those laws of a model file do.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Corrections {
    /// L.
    pub dissipation: Option<DissipationNetwork>,
    /// V_c.
    pub potential: Option<CorrectionNetwork>,
}

/// What a network sees, and its hidden layers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CorrectionNetwork {
    /// One letter a coordinate, up to the last that it sees: `t` by its length, `a` by its angle, `c` not by its position, `-` not at
    /// all.
    pub coordinates: String,
    /// Units of the hidden layers.
    pub widths: Vec<u16>,
    /// Activation of the hidden layers.
    pub activation: Activation,
}

/// The network of a dissipation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DissipationNetwork {
    /// Its positions and layers.
    pub network: CorrectionNetwork,
    /// What each velocity that it sees is divided by, > 0, m/s or rad/s; known.
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

    /// In the words of a model file.
    pub fn header(&self) -> LawNetwork<'_> {
        let mut widths = [0; MAX_HIDDEN];
        widths.iter_mut().zip(&self.widths).for_each(|(slot, width)| *slot = *width);
        LawNetwork { coordinates: &self.coordinates, widths, activation: self.activation }
    }

    /// The numbers of the coordinates that it sees.
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

    /// Numbers of its layers; 0 of a network that cannot be.
    fn count(&self, law: Law) -> usize {
        self.header().network(law).ok().and_then(|shape| shape.parameters()).unwrap_or(0)
    }

    /// Random weights, the outputs small.
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
    /// Scales, and a network that hardly dissipates.
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
    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Those of a model file, whose numbers end the weight block.
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

    /// These laws with the networks.
    pub(crate) fn laws<'a>(&'a self, friction: Laws<'a>) -> Laws<'a> {
        let laws =
            self.dissipation.as_ref().map_or(friction, |of| friction.with_dissipation(of.network.header()));
        self.potential.as_ref().map_or(laws, |of| laws.with_potential(of.header()))
    }

    /// How many numbers.
    pub fn count(&self) -> usize {
        let of = |of: &DissipationNetwork| of.scales.len() + of.network.count(Law::Dissipation);
        self.dissipation.as_ref().map_or(0, of)
            + self.potential.as_ref().map_or(0, |of| of.count(Law::Potential))
    }

    /// Where the numbers of the dissipation and of the potential are in a weight block of this length, which they end.
    fn places(&self, length: usize) -> [Range<usize>; 2] {
        let start = length.saturating_sub(self.count());
        let potential = self.potential.as_ref().map_or(0, |of| of.count(Law::Potential));
        let middle = length.saturating_sub(potential).max(start);
        [start..middle, middle..length]
    }

    /// The numbers of the dissipation and of the potential, which end a weight block.
    pub fn split<'w>(&self, weights: &'w [f64]) -> [&'w [f64]; 2] {
        self.places(weights.len()).map(|place| weights.get(place).unwrap_or_default())
    }

    /// Puts numbers of the dissipation and of the potential at the end of a weight block; where there are none it stays.
    pub fn put(&self, numbers: &[Vec<f64>; 2], weights: &mut [f64]) {
        for (place, own) in self.places(weights.len()).into_iter().zip(numbers) {
            let slots = weights.get_mut(place).unwrap_or_default();
            slots.iter_mut().zip(own).for_each(|(slot, own)| *slot = *own);
        }
    }

    /// Random weights, such that they hardly act.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let dissipation = self.dissipation.iter().flat_map(|of| of.initial_weights(seed));
        // Another stream than that of the dissipation.
        let potential = self.potential.iter().flat_map(|of| of.initial_weights(Law::Potential, !seed));
        dissipation.chain(potential).collect()
    }

    /// Numbers with which they do not act at all: scales, and zeros.
    pub fn without_effect(&self) -> Vec<f64> {
        let mut numbers = vec![0.0; self.count()];
        let scales = self.dissipation.iter().flat_map(|of| &of.scales);
        numbers.iter_mut().zip(scales).for_each(|(number, scale)| *number = *scale);
        numbers
    }

    /// The numbers that training must leave as they are, the first of all being at `start`: scales, and the last bias of a potential,
    /// which has no effect.
    pub(crate) fn fixed_positions(&self, start: usize) -> Vec<usize> {
        let scales = start..start + self.dissipation.as_ref().map_or(0, |of| of.scales.len());
        let constant = self.potential.iter().map(|_| (start + self.count()).saturating_sub(1));
        scales.chain(constant).collect()
    }

    /// Units of all hidden layers.
    pub fn widths(&self) -> impl Iterator<Item = usize> {
        self.networks().flat_map(|network| &network.widths).map(|width| usize::from(*width))
    }

    /// Hidden layers of the deeper network.
    pub fn depth(&self) -> usize {
        self.networks().map(|network| network.widths.len()).max().unwrap_or(0)
    }

    /// Both networks, where they are there.
    pub fn networks(&self) -> impl Iterator<Item = &CorrectionNetwork> {
        self.dissipation.iter().map(|of| &of.network).chain(&self.potential)
    }

    /// The model with them, written down.
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
