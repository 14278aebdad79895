//! Cost of a graph of any size.

use crate::{Cost, LAYER, WORD, Work, network_weights, tape};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::energy::graph::{Edge, GraphShape, Kinetic, NodeShape, Potential};
use leastaction_core::model::ModelError;
use leastaction_models::GraphArchitecture;

/// Number of steps of order 2 that make up one of order 4.
pub(super) const COMPOSED: usize = 5;

/// The cost of RATTLE steps: forces once, then momenta and velocities of every node; state and workspace belong to the caller.
pub(super) fn cost(architecture: &GraphArchitecture) -> Result<Cost, ModelError> {
    let graph = architecture.graph()?;
    let shape = &architecture.shape;
    let networks = || shape.networks.iter().map(|network| network.widths());
    let widest = networks().flat_map(|(widths, _)| widths).max().unwrap_or(0);
    let depth = networks().map(|(_, depth)| depth).max().unwrap_or(0);
    let stack_bytes = tape(1, 1, widest, depth);
    let (nodes, rods) = (graph.nodes.len(), graph.rods.len());
    let numbers = if architecture.dimension() == 3 {
        ParticleState::<f32, 3>::workspace(nodes, rods)
            + Rattle::<f32>::workspace_of::<3>(nodes, rods, graph.band(), 0)
    } else {
        ParticleState::<f32, 2>::workspace(nodes, rods)
            + Rattle::<f32>::workspace_of::<2>(nodes, rods, graph.band(), 0)
    };
    let forces = Forces::of(shape, &graph.nodes, &graph.edges).multiply_adds();
    Ok(Cost {
        state_bytes: size_of::<f32>() * numbers,
        // These are the shape, the networks' layers, and the edges, which are copied into RAM.
        handle_bytes: size_of::<GraphShape>()
            + shape.networks.len() * (depth + 1) * LAYER
            + size_of::<Edge>() * graph.edges.len()
            + 8 * WORD,
        acceleration: Work { multiply_adds: forces, stack_bytes },
        step_order_2: Work { multiply_adds: forces, stack_bytes },
        step_order_4: Work { multiply_adds: COMPOSED * forces, stack_bytes },
        iterated: false,
    })
}

/// Numbers of weights in one evaluation of all networks.
struct Forces {
    potentials: usize,
    kinetics: usize,
    edges: usize,
    messages: usize,
}

impl Forces {
    fn of(shape: &GraphShape, nodes: &[u8], edges: &[Edge]) -> Self {
        let weights = |network: u8| shape.networks.get(network).map_or(0, network_weights);
        let kinds = || nodes.iter().filter_map(|kind| shape.nodes.get(*kind));
        let potential = |kind: &NodeShape| match kind.potential {
            Potential::Network(network) => weights(network),
            Potential::None | Potential::Uniform => 0,
        };
        let kinetic = |kind: &NodeShape| match kind.kinetic {
            Kinetic::Network(network) => weights(network),
            Kinetic::Mass => 0,
        };
        let joined = || edges.iter().filter_map(|edge| shape.edges.get(edge.kind));
        let pairs = joined().flat_map(|kind| [kind.potential, kind.embedding]).flatten();
        let messages = shape.messages.map_or(0, |messages| {
            let an_edge = 2 * weights(messages.message)
                + weights(messages.update)
                + messages.edge_potential.map_or(0, weights);
            edges.len() * an_edge + nodes.len() * messages.node_potential.map_or(0, weights)
        });
        Self {
            potentials: kinds().map(potential).sum(),
            kinetics: kinds().map(kinetic).sum(),
            edges: pairs.map(weights).sum(),
            messages,
        }
    }

    /// Multiply-adds of the forces. Potentials and messages take a forward pass and an adjoint. Edges take a forward
    /// pass with a derivative. Kinetic energies take one with a derivative for the momentum and one with two
    /// derivatives for the mass.
    fn multiply_adds(&self) -> usize {
        2 * (self.potentials + self.edges + self.messages) + 5 * self.kinetics
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::model::Rod;
    use leastaction_ground_truth::LgnnSystem;
    use leastaction_ground_truth::lgnn_shape;
    use leastaction_models::NamedGraph;

    #[test]
    fn three_pendulums_and_five_springs_by_hand() {
        let pendulums = cost(&lgnn_shape(LgnnSystem::Pendulum(3), false, false).unwrap()).unwrap();
        assert_eq!(pendulums.step_order_2.multiply_adds, 2 * 3 * (2 * 8 + 8));
        assert_eq!(pendulums.step_order_4.multiply_adds, 5 * 2 * 3 * (2 * 8 + 8));
        let springs = cost(&lgnn_shape(LgnnSystem::Spring(5), false, false).unwrap()).unwrap();
        assert_eq!(springs.acceleration.multiply_adds, 2 * 5 * (16 + 16));
        // There are two states of six vectors per node; without rods no workspace for the multipliers is needed.
        assert_eq!(springs.state_bytes, 4 * 2 * 6 * 5 * 2);
    }

    #[test]
    fn the_band_of_a_chain_is_one() {
        let rod = |from: Option<u16>, to| Rod { from, to, length: 1.0 };
        let band = |rods: &[Rod]| {
            NamedGraph { name: String::new(), nodes: vec![0; 3], edges: Vec::new(), rods: rods.to_vec() }
                .band()
        };
        assert_eq!(band(&[rod(None, 0), rod(Some(0), 1), rod(Some(1), 2)]), 1);
        assert_eq!(band(&[rod(None, 0), rod(Some(1), 2), rod(Some(0), 1)]), 2);
        assert_eq!(band(&[rod(None, 0), rod(None, 1)]), 0);
    }
}
