//! The Lagrangian network in Cartesian coordinates with explicit constraints (Finzi et al., 2020), in the version that LGNN's authors
//! compare with.

use super::lagrangian::{acceleration_error, motion};
use super::{AccelerationModel, MotionModel, coordinates_fit, layers_of};
use leastaction_core::model::ModelError;
use leastaction_core::network::Activation;
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::accelerations::Accelerations;
use leastaction_models::{NamedGraph, random_layers};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, Network};
use leastaction_programs::{Builder, Node};

/// Initial k, kg, which corresponds to a mass of 1 kg.
const HALF: f64 = 0.5;

/// Model M v̇ = −V_q + Aᵀλ, A v̇ = −Ȧv with L = Σ k_i |v_i|² − V(q) for nodes in the plane and known rods. V is a
/// network of all positions with two hidden squareplus layers.
///
/// LGNN's program has 256 units per layer. Every k_i is learned, starting at ½ kg, so L is only determined up to its
/// scale. All other weights start uniform with Glorot's variance. V fits only one number of nodes, so nothing can be
/// transferred to other graphs.
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianLnn {
    graph: NamedGraph,
    width: usize,
}

impl CartesianLnn {
    /// Creates the model on the nodes and rods of a graph, with `width` units in each hidden layer; the edges are ignored.
    pub fn new(graph: NamedGraph, width: usize) -> Self {
        Self { graph, width }
    }

    /// Network of V, whose weights follow those of all k.
    fn potential(&self) -> Network {
        let start = self.graph.nodes.len();
        Network::of_widths(self.n(), &[self.width; 2], (1, Activation::Squareplus), start)
    }
}

impl Energies for CartesianLnn {
    fn n(&self) -> usize {
        2 * self.graph.nodes.len()
    }

    fn parameters(&self) -> usize {
        self.potential().end()
    }

    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let k = builder.parameters(0, self.graph.nodes.len());
        let k = builder.gather(k, &(0..self.n()).map(|i| i / 2).collect::<Vec<_>>());
        let momentum = builder.product(k, v);
        [builder.dot(momentum, v), self.potential().output(builder, q)]
    }
}

impl AccelerationModel for CartesianLnn {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = vec![HALF; self.graph.nodes.len()];
        weights.extend(random_layers(layers_of(&[self.n(), self.width, self.width, 1]), seed));
        weights
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        let rods = Rods::new(2, &self.graph.rods);
        Ok(acceleration_error(self, (rods, true), samples))
    }
}

impl MotionModel for CartesianLnn {
    fn motion<'w>(&self, weights: &'w [f64]) -> Result<Box<Accelerations<'w>>, ModelError> {
        motion(self, self.graph.constraints::<2>(), weights)
    }
}

#[cfg(test)]
mod tests;
