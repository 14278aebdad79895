//! The graph network simulator (Sanchez-Gonzalez et al., 2020) as LGNN's authors compare with it: accelerations of nodes by
//! one round of messages.

mod network;

use super::regression::{Explicit, Regression};
use super::{AccelerationModel, Follow, coordinates_fit};
use crate::architecture::{NamedGraph, random_layers};
use crate::evaluate::prediction::{Prediction, Truth};
use crate::training::{Objective, Samples};
use leastaction_core::model::ModelError;
use leastaction_core::scalar::Lanes;
use network::{MAX_WIDTH, Networks, Trace, Wiring};

/// Sizes of a [`Gns`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GnsShape {
    /// Components D of a position, 1 or more.
    pub dimension: usize,
    /// Numbers that stand for a node, 1 or more.
    pub node: usize,
    /// Numbers that stand for an edge, 1 or more.
    pub edge: usize,
    /// Units of each of two hidden layers, 1 to 16.
    pub hidden: usize,
}

impl GnsShape {
    /// Those of LGNN's program: 2,130 weights.
    pub const LGNN: Self = Self { dimension: 2, node: 8, edge: 8, hidden: 16 };

    /// Inputs, hidden layers and outputs of the networks, in the order of the weight block.
    fn networks(self) -> [[usize; 3]; 5] {
        let Self { dimension, node, edge, .. } = self;
        [
            [1, 0, edge],
            [2 * dimension + 1, 0, node],
            [edge + 2 * node, 2, edge],
            [node + 2 * edge, 2, node],
            [node, 2, dimension],
        ]
    }

    /// Inputs and outputs of every layer, in the order of the weight block.
    fn layers(self) -> impl Iterator<Item = (usize, usize)> {
        self.networks().into_iter().flat_map(move |[inputs, hidden, outputs]| {
            let mut sizes = vec![inputs];
            sizes.extend(std::iter::repeat_n(self.hidden, hidden));
            sizes.push(outputs);
            sizes.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        })
    }
}

/// v̇_i = N_a(h′_i): nodes h_i = N_h(x_i, v_i, type_i) and both directions of every edge e_ij = N_e(|x_i − x_j|) are embedded
/// linearly; then e′_ij = N_m(e_ij, h_i, h_j) and h′_i = N_u(h_i, Σ_j e′_ij, Σ_j e′_ji). N_m, N_u and N_a have two hidden
/// squareplus layers.
///
/// Sizes and inputs are those of LGNN's program. Positions are inputs as they are, so that nothing makes the accelerations the
/// same elsewhere; and nothing keeps energy. The weights serve any graph. They start uniform with Glorot's variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Gns {
    shape: GnsShape,
    wiring: Wiring,
}

impl Gns {
    /// On the nodes and edges of a graph; its rods are not seen.
    ///
    /// # Errors
    /// [`ModelError::Shape`] for wider hidden layers than are compiled, or where an edge ends at no node.
    pub fn new(shape: GnsShape, graph: &NamedGraph) -> Result<Self, ModelError> {
        let error = |what, found, compiled| Err(ModelError::Shape { what, found, compiled });
        if shape.hidden > MAX_WIDTH {
            return error("units in a hidden layer", shape.hidden, MAX_WIDTH);
        }
        let wiring = Wiring::new(shape.dimension, graph);
        match wiring.last_end() {
            Some(end) if end >= wiring.nodes() => error("nodes", end + 1, wiring.nodes()),
            _ => Ok(Self { shape, wiring }),
        }
    }

    /// Numbers in the weight block, whatever the graph.
    pub fn parameters(&self) -> usize {
        self.shape.layers().map(|(inputs, outputs)| (inputs + 1) * outputs).sum()
    }

    /// Writes v̇(q, v), m/s², \[nodes\]\[D\]; `None` where the weights or a slice are too short.
    pub fn acceleration(&self, weights: &[f64], q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let n = self.wiring.coordinates();
        let state = [q.get(..n)?, v.get(..n)?].concat();
        let trace = self.networks(weights)?.forward(&self.wiring, &state);
        trace.accelerations(out.get_mut(..n)?);
        Some(())
    }

    fn networks<'w>(&self, weights: &'w [f64]) -> Option<Networks<'w>> {
        Networks::take(self.shape, weights)
    }
}

impl AccelerationModel for Gns {
    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        random_layers(self.shape.layers(), seed)
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

impl Explicit for Gns {
    type Trace = Option<Trace<Lanes>>;

    fn parameters(&self) -> usize {
        self.parameters()
    }

    fn inputs(&self) -> usize {
        2 * self.wiring.coordinates()
    }

    fn outputs(&self) -> usize {
        self.wiring.coordinates()
    }

    fn forward(
        &self,
        weights: &[f64],
        x: Vec<Lanes>,
        trace: &mut Self::Trace,
        y: &mut [Lanes],
    ) -> Option<()> {
        trace.insert(self.networks(weights)?.forward(&self.wiring, &x)).accelerations(y);
        Some(())
    }

    fn adjoint(
        &self,
        weights: &[f64],
        trace: &Self::Trace,
        y_bar: &[Lanes],
        row: &mut [Lanes],
    ) -> Option<()> {
        self.networks(weights)?.adjoint(&self.wiring, trace.as_ref()?, y_bar, row);
        Some(())
    }
}

#[cfg(test)]
mod tests;
