//! The graph network simulator (Sanchez-Gonzalez et al., 2020), in the version that LGNN's authors compare with: accelerations of nodes by
//! one round of messages.

use super::direct::Direct;
use super::graph_network::{GraphNetwork, GraphSizes};
use super::{AccelerationModel, MotionModel, coordinates_fit};
use leastaction_core::model::ModelError;
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::accelerations::Accelerations;
use leastaction_models::{NamedGraph, random_layers};

/// Accelerations v̇_i = N_a(h′_i). Nodes h_i = N_h(x_i, v_i, type_i) and both directions of every edge e_ij = N_e(|x_i
/// − x_j|) are embedded linearly; then e′_ij = N_m(e_ij, h_i, h_j) and h′_i = N_u(h_i, Σ_j e′_ij, Σ_j e′_ji). N_m, N_u
/// and N_a have two hidden squareplus layers.
///
/// Sizes and inputs are those of LGNN's program. Positions themselves are inputs, so the accelerations are not translation-invariant, and
/// energy is not conserved. The weights fit any graph. They start uniform with Glorot's variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Gns {
    network: GraphNetwork,
}

impl Gns {
    /// Creates the model on the nodes and edges of a graph; its rods are ignored. An error if an edge refers to a node
    /// that does not exist.
    pub fn new(sizes: GraphSizes, graph: &NamedGraph) -> Result<Self, ModelError> {
        let ends = graph.edges.iter().map(|edge| edge.ends);
        Ok(Self { network: GraphNetwork::new((sizes, sizes.dimension), graph, ends)? })
    }

    /// Length of the weight block in numbers, the same for any graph.
    pub fn parameters(&self) -> usize {
        self.network.parameters()
    }

    fn function(&self) -> Direct {
        Direct::new(self.network.coordinates(), |builder, [q, v, _]| {
            let nodes = self.network.messages(builder, q, v);
            self.network.read_out(builder, self.network.nodes(), nodes)
        })
    }
}

impl AccelerationModel for Gns {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(self.network.layers(), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.network.coordinates())?;
        Ok(self.function().error(self.parameters(), |block| block.states[2].clone(), samples))
    }
}

impl MotionModel for Gns {
    fn motion<'w>(&self, weights: &'w [f64]) -> Result<Box<Accelerations<'w>>, ModelError> {
        let forced = self.function().motion(self.network.coordinates(), (weights, self.parameters()))?;
        Ok(Box::new(move |q, v, out| forced(q, v, &[], out)))
    }
}

#[cfg(test)]
mod tests;
