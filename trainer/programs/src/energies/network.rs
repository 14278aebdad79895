use crate::builder::{Builder, Layer, Node};
use crate::function::Function;
use leastaction_core::energy::NetworkShape;
use leastaction_core::network::Activation;

/// A multilayer perceptron in the weight block: hidden layers, each followed by the activation, and a linear output layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    layers: Vec<Layer>,
    activation: Activation,
}

impl Network {
    /// The network of this shape whose numbers begin at `start`.
    pub fn new(shape: &NetworkShape, start: usize) -> Self {
        let (widths, depth) = shape.widths();
        Self::of_widths(
            shape.inputs.into(),
            &widths[..depth],
            (shape.outputs.into(), shape.activation),
            start,
        )
    }

    /// A network of as many inputs and outputs as may be.
    pub fn of_widths(
        inputs: usize,
        widths: &[usize],
        (outputs, activation): (usize, Activation),
        mut start: usize,
    ) -> Self {
        let mut inputs = inputs;
        let mut layers = Vec::new();
        for outputs in widths.iter().copied().chain([outputs]) {
            let layer = Layer { start, inputs, outputs };
            (start, inputs) = (layer.end(), outputs);
            layers.push(layer);
        }
        Self { layers, activation }
    }

    /// Position of the number after its last.
    pub fn end(&self) -> usize {
        self.layers.last().map_or(0, Layer::end)
    }

    /// y(x).
    pub fn output(&self, builder: &mut Builder, x: Node) -> Node {
        self.outputs(builder, 1, x)
    }

    /// y of so many inputs x, one after the other; so are the outputs.
    pub fn outputs(&self, builder: &mut Builder, columns: usize, x: Node) -> Node {
        let mut x = x;
        for (i, layer) in self.layers.iter().enumerate() {
            x = builder.linear(*layer, columns, x);
            if i + 1 < self.layers.len() && self.activation != Activation::Identity {
                x = builder.map(Function::Activation(self.activation), x);
            }
        }
        x
    }
}
