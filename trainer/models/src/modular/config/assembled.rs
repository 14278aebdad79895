//! Shape of a model as a configuration describes it, with the weights that training begins with.

use crate::architecture::Architecture;
use crate::family::Family;
use crate::laws::corrections::Corrections;
use crate::laws::group::GroupLaws;
use crate::modular::ModularArchitecture;
use leastaction_core::energy::modular::{NetworkShape, TransformShape, TypeShape};
use std::ops::Range;

/// Shape of a model, with the weights that are already trained.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembled {
    /// Shape of the trees; the first one is trained.
    pub architecture: ModularArchitecture,
    /// Friction of the coordinates, one set of numbers per element type.
    pub group_laws: GroupLaws,
    /// Correction networks.
    pub corrections: Corrections,
    /// Numbers of the correction networks that come from a trained model, for dissipation and potential; empty for new ones.
    pub trained_corrections: [Vec<f64>; 2],
    /// Weights of the networks that come from a trained model, which begin the weight block.
    pub(super) trained: Vec<f64>,
}

impl Assembled {
    /// Returns the architecture, and the weights that training begins with.
    pub(super) fn beginning(self, seed: u64) -> (Architecture, Vec<f64>) {
        let (weights, trained) = (self.initial_weights(seed), self.trained_corrections.clone());
        let architecture = Architecture::from(self);
        let mut weights = architecture.with_laws(weights, seed);
        let place = architecture.corrections_place();
        architecture.corrections.put(&trained, weights.get_mut(place).unwrap_or_default());
        (architecture, weights)
    }

    /// Returns the trained weights, and random ones for the rest. Position networks of the same shape start with equal
    /// weights.
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = self.architecture.initial_weights(seed);
        weights.iter_mut().zip(&self.trained).for_each(|(weight, trained)| *weight = *trained);
        for (from, to) in self.alike() {
            if to.start >= self.trained.len() && from.end <= to.start {
                weights.copy_within(from, to.start);
            }
        }
        weights
    }

    /// Pairs of ranges in the weight block: the position network of each type, preceded by that of the first type with
    /// a network of the same shape. If one of the two started as a mirror image of the other, no descent of the loss
    /// could correct it.
    fn alike(&self) -> Vec<(Range<usize>, Range<usize>)> {
        let shape = &self.architecture.shape;
        let mut start = 0;
        let networks: Vec<_> = shape
            .networks
            .iter()
            .map(|network| {
                let from = start;
                start += network.parameters().unwrap_or(0);
                (network, from..start)
            })
            .collect();
        let position = |kind: &TypeShape| match kind.transform {
            TransformShape::Network { position, .. } => networks.get(usize::from(position)),
            TransformShape::Rod | TransformShape::Slide | TransformShape::Free => None,
        };
        let positions: Vec<_> = shape.types.iter().filter_map(position).collect();
        let first = |(shape, place): &&(&NetworkShape, Range<usize>)| {
            let (_, from) = positions.iter().find(|(other, _)| other == shape)?;
            Some((from.clone(), place.clone()))
        };
        positions.iter().filter_map(first).collect()
    }
}

impl From<Assembled> for Architecture {
    fn from(Assembled { architecture, group_laws, corrections, .. }: Assembled) -> Self {
        Self { group_laws, corrections, ..Self::from(architecture) }
    }
}
