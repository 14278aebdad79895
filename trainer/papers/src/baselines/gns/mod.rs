//! The graph network simulator (Sanchez-Gonzalez et al., 2020) as LGNN's authors compare with it: accelerations of nodes by
//! one round of messages.

mod regression;

use super::graph_network::{GraphSizes, Networks, Placed, Trace, Used, Wiring};
use super::{AccelerationModel, Follow, coordinates_fit};
use leastaction::architecture::{NamedGraph, random_layers};
use leastaction::evaluate::prediction::{Prediction, Truth};
use leastaction::training::{Objective, Samples};
use leastaction_core::model::ModelError;
use leastaction_core::network::Jet;
use leastaction_core::scalar::{Lanes, Scalar};
use regression::Regression;

/// v̇_i = N_a(h′_i): nodes h_i = N_h(x_i, v_i, type_i) and both directions of every edge e_ij = N_e(|x_i − x_j|) are embedded
/// linearly; then e′_ij = N_m(e_ij, h_i, h_j) and h′_i = N_u(h_i, Σ_j e′_ij, Σ_j e′_ji). N_m, N_u and N_a have two hidden
/// squareplus layers.
///
/// Sizes and inputs are those of LGNN's program. Positions are inputs as they are, so that nothing makes the accelerations the
/// same elsewhere; and nothing keeps energy. The weights serve any graph. They start uniform with Glorot's variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Gns {
    sizes: GraphSizes,
    wiring: Wiring,
}

impl Gns {
    /// On the nodes and edges of a graph; its rods are not seen.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for wider hidden layers than are compiled, or where an edge ends at no node.
    pub fn new(sizes: GraphSizes, graph: &NamedGraph) -> Result<Self, ModelError> {
        let sizes = sizes.checked()?;
        Ok(Self {
            sizes,
            wiring: Wiring::new(sizes.dimension, graph, graph.edges.iter().map(|edge| edge.ends))?,
        })
    }

    /// Numbers in the weight block, whatever the graph.
    pub fn parameters(&self) -> usize {
        self.sizes.parameters(self.sizes.dimension)
    }

    /// Writes v̇(q, v), m/s², \[nodes\]\[D\]; `None` where the weights or a slice are too short.
    pub fn acceleration(&self, weights: &[f64], q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let n = self.wiring.coordinates();
        let state = [q.get(..n)?, v.get(..n)?].concat();
        self.pass(&self.networks(weights)?, &state).accelerations(out.get_mut(..n)?);
        Some(())
    }

    fn networks<'w>(&self, weights: &'w [f64]) -> Option<Networks<'w>> {
        Networks::take(self.sizes, self.sizes.dimension, weights)
    }

    fn pass<S: Scalar<Weight = f64>>(&self, networks: &Networks, state: &[S]) -> Pass<S> {
        let state: Vec<_> = state.iter().copied().map(Jet::constant).collect();
        let messages = networks.messages(&self.wiring, &state);
        let accelerations =
            messages.nodes.iter().map(|node| networks.read_out.used(node.y.clone())).collect();
        Pass { messages, accelerations }
    }

    /// Adds ∂(ȳ·v̇)/∂θ after a forward pass with these weights; `None` where they are too few.
    fn adjoint(&self, weights: &[f64], pass: &Pass<Lanes>, y_bar: &[Lanes], row: &mut [Lanes]) -> Option<()> {
        let networks = self.networks(weights)?;
        let mut back = |network: &Placed, used: &Used<Lanes, 0>, y_bar: &[Jet<Lanes, 0>]| {
            network.adjoint(used, y_bar, |start, layer, x, bar| {
                layer.series_gradient(x, bar, |position, g| row[start + position] += g);
            })
        };
        let y_bar: Vec<_> = y_bar.iter().copied().map(Jet::constant).collect();
        let read = pass.accelerations.iter().zip(y_bar.chunks_exact(self.wiring.dimension()));
        let nodes_bar: Vec<_> = read.map(|(read, bar)| back(&networks.read_out, read, bar)).collect();
        networks.messages_adjoint(&self.wiring, &pass.messages, nodes_bar.into_iter(), back);
        Some(())
    }

    /// Numbers that are seen of a sample.
    fn inputs(&self) -> usize {
        2 * self.wiring.coordinates()
    }

    /// Accelerations of a sample.
    fn outputs(&self) -> usize {
        self.wiring.coordinates()
    }
}

/// What a forward pass leaves for the adjoint.
struct Pass<S> {
    messages: Trace<S, 0>,
    accelerations: Vec<Used<S, 0>>,
}

impl<S: Scalar> Pass<S> {
    /// Writes v̇ of all nodes.
    fn accelerations(&self, out: &mut [S]) {
        let all = self.accelerations.iter().flat_map(|node| &node.y);
        out.iter_mut().zip(all).for_each(|(out, y)| *out = y.value);
    }
}

impl AccelerationModel for Gns {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(self.sizes.layers(self.sizes.dimension), seed)
    }

    fn objective(&self, samples: Samples) -> Result<Box<dyn Objective>, ModelError> {
        let n = self.wiring.coordinates();
        coordinates_fit(&samples, n)?;
        let [q, v, targets] = samples.states;
        let inputs = q.chunks_exact(n).zip(v.chunks_exact(n)).flat_map(|(q, v)| [q, v]).flatten();
        Ok(Box::new(Regression { model: self.clone(), inputs: inputs.copied().collect(), targets }))
    }

    fn predict(&self, weights: &[f64], truth: &Truth, follow: Follow) -> Result<Prediction, ModelError> {
        let short = ModelError::Shape { what: "weights", found: weights.len(), compiled: self.parameters() };
        self.networks(weights).ok_or(short)?;
        Ok(follow.compare(truth, |q, v, out| self.acceleration(weights, q, v, out)))
    }
}

#[cfg(test)]
mod tests;
