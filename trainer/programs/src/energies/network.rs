use crate::builder::Builder;
use crate::function::Function;
use crate::operation::{Layer, Node};
use leastaction_core::energy::NetworkShape;
use leastaction_core::network::Activation;

/// Numbers that all inputs of one kind share.
pub(crate) struct Kinds<'k> {
    /// Numbers of every kind, `width` each, kind after kind.
    pub table: Node,
    pub width: usize,
    /// Kind of every input.
    pub of: &'k [usize],
}

/// Positions of the entries of these items, `each` per item.
pub(crate) fn entries(items: impl IntoIterator<Item = usize>, each: usize) -> Vec<usize> {
    items.into_iter().flat_map(|item| item * each..(item + 1) * each).collect()
}

/// A multilayer perceptron in the weight block: hidden layers, each followed by the activation, and a linear output layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    layers: Vec<Layer>,
    activation: Activation,
}

impl Network {
    /// Creates the network of this shape whose numbers begin at `start`.
    pub fn new(shape: &NetworkShape, start: usize) -> Self {
        let (widths, depth) = shape.widths();
        Self::of_widths(
            shape.inputs.into(),
            &widths[..depth],
            (shape.outputs.into(), shape.activation),
            start,
        )
    }

    /// Creates a network with any numbers of inputs and outputs.
    pub fn of_widths(
        inputs: usize,
        widths: &[usize],
        (outputs, activation): (usize, Activation),
        mut start: usize,
    ) -> Self {
        let mut inputs = inputs;
        let mut layers = Vec::new();
        for outputs in widths.iter().copied().chain([outputs]) {
            let layer = Layer::new(start, inputs, outputs);
            (start, inputs) = (layer.end(), outputs);
            layers.push(layer);
        }
        Self { layers, activation }
    }

    /// Position of the number after the network's last one.
    pub fn end(&self) -> usize {
        self.layers.last().map_or(0, Layer::end)
    }

    /// Output y(x).
    pub fn output(&self, builder: &mut Builder, x: Node) -> Node {
        self.outputs(builder, 1, x)
    }

    /// Outputs y for `columns` inputs x, one after the other; the outputs have the same order.
    pub fn outputs(&self, builder: &mut Builder, columns: usize, x: Node) -> Node {
        let Some((first, others)) = self.layers.split_first() else { return x };
        let y = builder.linear(*first, columns, x);
        self.behind(builder, others, columns, y)
    }

    /// Outputs y for inputs x, where each input is preceded by the numbers of its kind. The first layer's product with
    /// these numbers is computed once per kind.
    pub(crate) fn outputs_of_kinds(&self, builder: &mut Builder, kinds: &Kinds, x: Node) -> Node {
        let (columns, width) = (kinds.of.len(), kinds.width);
        let Some((first, others)) = self.layers.split_first().filter(|_| width > 0) else {
            return self.outputs(builder, columns, x);
        };
        let of_kinds =
            builder.linear(first.of_inputs(0..width), builder.length(kinds.table) / width, kinds.table);
        let of_kinds = builder.gather(of_kinds, &entries(kinds.of.iter().copied(), first.outputs));
        let own = builder.product_of(first.of_inputs(width..first.inputs), columns, x, false);
        let y = builder.sum(of_kinds, own);
        self.behind(builder, others, columns, y)
    }

    /// Applies the remaining layers to a layer's outputs y.
    fn behind(&self, builder: &mut Builder, layers: &[Layer], columns: usize, y: Node) -> Node {
        let mut y = y;
        for layer in layers {
            if self.activation != Activation::Identity {
                y = builder.map(Function::Activation(self.activation), y);
            }
            y = builder.linear(*layer, columns, y);
        }
        y
    }
}
