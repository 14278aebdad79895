//! Layers of networks and their random weights.

use leastaction_core::energy::NetworkShape;
use leastaction_core::network::Dense;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Returns random weights of layers with these numbers of inputs and outputs: uniform with Glorot's variance, biases zero.
pub fn random_layers(layers: impl IntoIterator<Item = (usize, usize)>, seed: u64) -> Vec<f64> {
    let (mut stream, mut weights) = (Pcg64::seed_from_u64(seed), Vec::new());
    for (inputs, outputs) in layers {
        uniform_layer(&mut weights, inputs, outputs, &mut stream);
    }
    weights
}

/// Appends a layer: uniform with Glorot's variance, biases zero.
fn uniform_layer(weights: &mut Vec<f64>, inputs: usize, outputs: usize, stream: &mut impl Rng) {
    let limit = (6.0 / (inputs + outputs) as f64).sqrt();
    let mut layer = vec![0.0; inputs * outputs];
    for i in 0..outputs {
        for j in 0..inputs {
            layer[Dense::<f64>::position(inputs, outputs, i, j)] = stream.random_range(-limit..limit);
        }
    }
    weights.extend(layer);
    weights.extend(std::iter::repeat_n(0.0, outputs));
}

/// Numbers of units in the hidden layers.
pub(crate) fn hidden(network: &NetworkShape) -> impl Iterator<Item = usize> + use<> {
    let (widths, depth) = network.widths();
    widths.into_iter().take(depth)
}

/// Numbers of inputs and outputs of every layer, first to last.
pub(crate) fn layers(network: &NetworkShape) -> Vec<(usize, usize)> {
    let mut sizes = vec![usize::from(network.inputs)];
    sizes.extend(hidden(network));
    sizes.push(network.outputs.into());
    sizes.windows(2).map(|pair| (pair[0], pair[1])).collect()
}
