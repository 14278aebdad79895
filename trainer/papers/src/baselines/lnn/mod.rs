//! The Lagrangian neural network (Cranmer et al., 2020): a single network gives L(q, v), of any form.

use super::features::{count, seen};
use super::lagrangian::{acceleration_error, motion};
use super::{AccelerationModel, Follow, PredictionModel, coordinates_fit};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::ModelError;
use leastaction_core::network::{Activation, Dense};
use leastaction_learning::evaluate::prediction::{Prediction, Truth};
use leastaction_learning::training::{Objective, Samples};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, Network};
use leastaction_programs::{Builder, Node};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Acceleration v̇ = M⁻¹(L_q − L_vq v) with L(q, v) = N(s(q), v) and M = L_vv; the network has two hidden softplus
/// layers of equal width.
///
/// M need not be positive definite or regular: if it is singular, there is no acceleration. The output's bias, one of
/// the weights, is a constant of L that no motion determines; ModLaNet's authors leave it out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lnn {
    coordinates: String,
    width: usize,
}

impl Lnn {
    /// Creates the network with `width` units in each hidden layer. `coordinates` has one letter each: `a` for angles,
    /// any other letter for translations.
    pub fn new(coordinates: &str, width: usize) -> Self {
        Self { coordinates: coordinates.to_owned(), width }
    }

    fn network(&self) -> Network {
        let (inputs, activation) = (count(&self.coordinates), Activation::Softplus);
        Network::of_widths(inputs, &[self.width; 2], (1, activation), 0)
    }
}

impl Energies for Lnn {
    fn n(&self) -> usize {
        self.coordinates.len()
    }

    fn parameters(&self) -> usize {
        self.network().end()
    }

    /// Returns L and 0: the kinetic part of L is not known.
    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let kind = |letter| if letter == 'a' { Coordinate::Angle } else { Coordinate::Translation };
        let features = seen(builder, &self.coordinates.chars().map(kind).collect::<Vec<_>>(), q);
        let x = builder.joined(&[features, v]);
        [self.network().output(builder, x), builder.zeros(1)]
    }
}

impl AccelerationModel for Lnn {
    /// Normal deviates with standard deviation 2.2/√n₀ for the first layer with n₀ inputs, 1.16/√n between layers of n
    /// units, and 1 for the output layer; biases are 0. These are the variances of ModLaNet's program after Cranmer et
    /// al., appendix C (which has √n for the output).
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let (mut weights, mut stream) = (Vec::new(), Pcg64::seed_from_u64(seed));
        let (inputs, width) = (count(&self.coordinates), self.width);
        let root = |n: usize| (n as f64).sqrt();
        for (fan_in, outputs, deviation) in
            [(inputs, width, 2.2 / root(inputs)), (width, width, 1.16 / root(width)), (width, 1, 1.0)]
        {
            let mut draw = || -> f64 { StandardNormal.sample(&mut stream) };
            let mut layer = vec![0.0; Dense::<f64>::parameters(fan_in, outputs).unwrap_or(0)];
            layer[..fan_in * outputs].fill_with(|| deviation * draw());
            weights.extend(layer);
        }
        weights
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        Ok(acceleration_error(self, (Rods::default(), false), samples))
    }
}

impl PredictionModel for Lnn {
    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        Ok(follow.compare(truth, motion::<2>(self, Vec::new(), weights)?))
    }
}

#[cfg(test)]
mod lagrangian_tests;
#[cfg(test)]
mod tests;
