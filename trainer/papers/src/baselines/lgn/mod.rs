//! The Lagrangian graph network (LGN of LGNN's authors): a graph network that gives the whole Lagrangian as one number.

use super::graph_network::{GraphNetwork, GraphSizes};
use super::lagrangian::{acceleration_error, motion};
use super::{AccelerationModel, MotionModel, coordinates_fit};
use leastaction_core::model::ModelError;
use leastaction_learning::training::{Objective, Samples};
use leastaction_models::accelerations::Accelerations;
use leastaction_models::{NamedGraph, random_layers};
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::Energies;
use leastaction_programs::{Builder, Node};

/// Model L_vv v̇ = L_q − L_vq v + Aᵀλ, A v̇ = −Ȧv with L = N_L(Σ_i h′_i): the node embeddings of a [`Gns`](super::Gns)
/// after the messages are summed and read out to one number.
///
/// Sizes and inputs are those of LGNN's program; messages pass along edges and along rods between two nodes. L_vv need
/// not be positive definite or regular: if it is singular, there is no acceleration. The weights fit any graph in the
/// plane. They start uniform with Glorot's variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Lgn {
    network: GraphNetwork,
    graph: NamedGraph,
}

impl Lgn {
    /// Creates the model on the nodes, edges and rods of a graph; an error for a dimension other than 2, or if an edge
    /// refers to a node that does not exist.
    pub fn new(sizes: GraphSizes, graph: NamedGraph) -> Result<Self, ModelError> {
        if sizes.dimension != 2 {
            return Err(ModelError::Shape { what: "dimensions", found: sizes.dimension, compiled: 2 });
        }
        let rods = graph.rods.iter().filter_map(|rod| Some([rod.from?, rod.to]));
        let ends = graph.edges.iter().map(|edge| edge.ends).chain(rods);
        Ok(Self { network: GraphNetwork::new((sizes, 1), &graph, ends)?, graph })
    }
}

impl Energies for Lgn {
    fn n(&self) -> usize {
        self.network.coordinates()
    }

    /// The number does not depend on the graph.
    fn parameters(&self) -> usize {
        self.network.parameters()
    }

    /// Returns L and 0: the kinetic part of L is not known.
    fn energies(&self, builder: &mut Builder, q: Node, v: Node) -> [Node; 2] {
        let (nodes, size) = (self.network.messages(builder, q, v), self.network.sizes.node);
        let entries: Vec<usize> = (0..builder.length(nodes)).map(|entry| entry % size).collect();
        let sum = builder.scatter(nodes, &entries, size);
        [self.network.read_out(builder, 1, sum), builder.zeros(1)]
    }
}

impl AccelerationModel for Lgn {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(self.network.layers(), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        coordinates_fit(&samples, self.n())?;
        let rods = Rods::new(2, &self.graph.rods);
        Ok(acceleration_error(self, (rods, false), samples))
    }
}

impl MotionModel for Lgn {
    fn motion<'w>(&self, weights: &'w [f64]) -> Result<Box<Accelerations<'w>>, ModelError> {
        motion(self, self.graph.constraints::<2>(), weights)
    }
}

#[cfg(test)]
mod tests;
