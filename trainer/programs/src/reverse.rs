//! Backward differentiation.

use crate::builder::{Builder, Layer, Node, Operation};
use crate::forward::widened;

/// A part of the gradient in the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightTerm {
    /// Σ ȳxᵀ over the columns for a layer's weights, and Σ ȳ for its biases where it had them.
    Layer {
        /// The layer.
        layer: Layer,
        /// Vectors that it was applied to.
        columns: usize,
        /// The adjoint of its outputs.
        y_bar: Node,
        /// Its inputs.
        x: Node,
        /// Whether it added its biases.
        bias: bool,
    },
    /// The adjoint of numbers of the weight block.
    Parameters {
        /// Position of the first.
        start: usize,
        /// Their adjoint.
        bar: Node,
    },
}

/// The gradient of a scalar.
#[derive(Clone, Debug, Default)]
pub struct Adjoints {
    bars: Vec<Option<Node>>,
    /// In the weights: the sum of these.
    pub weights: Vec<WeightTerm>,
}

impl Adjoints {
    /// The gradient in a vector, as its entries move alone.
    pub fn of(&self, builder: &mut Builder, x: Node) -> Node {
        let bar = self.bars.get(x.index()).copied().flatten();
        bar.unwrap_or_else(|| builder.zeros(builder.length(x)))
    }
}

impl Builder {
    /// The gradient of ȳ·y for a vector y and a vector ȳ that does not move.
    pub fn pull_back(&mut self, y: Node, y_bar: Node) -> Adjoints {
        assert_eq!(self.length(y), self.length(y_bar), "an adjoint");
        let mut adjoints = Adjoints { bars: vec![None; y.index() + 1], weights: Vec::new() };
        adjoints.bars[y.index()] = Some(y_bar);
        for at in (0..=y.index()).rev() {
            if let Some(bar) = adjoints.bars[at] {
                self.pull(at, bar, &mut adjoints);
            }
        }
        adjoints
    }

    /// Hands the adjoint of one node on to what it was computed from.
    fn pull(&mut self, at: usize, bar: Node, adjoints: &mut Adjoints) {
        match self.operations[at].clone() {
            Operation::Input(_) | Operation::Constant(_) => {}
            Operation::Parameters(start) => adjoints.weights.push(WeightTerm::Parameters { start, bar }),
            Operation::Linear { layer, columns, bias, x } => {
                adjoints.weights.push(WeightTerm::Layer { layer, columns, y_bar: bar, x, bias });
                let own = self.transposed(layer, columns, bar);
                self.add_to(x, own, adjoints);
            }
            Operation::Transposed { layer, columns, y } => {
                adjoints.weights.push(WeightTerm::Layer { layer, columns, y_bar: y, x: bar, bias: false });
                let own = self.product_of(layer, columns, bar, false);
                self.add_to(y, own, adjoints);
            }
            Operation::Map { function, order, x } => {
                let rate = self.derivative(self.functions[&function], order + 1, x);
                let own = self.product(rate, bar);
                self.add_to(x, own, adjoints);
            }
            Operation::Product(x, y) => {
                let (to_x, to_y) = (self.product(bar, y), self.product(bar, x));
                self.add_to(x, to_x, adjoints);
                self.add_to(y, to_y, adjoints);
            }
            Operation::Sum(x, y) => {
                self.add_to(x, bar, adjoints);
                self.add_to(y, bar, adjoints);
            }
            Operation::Scaled(c, x) => {
                let own = self.scaled(f64::from_bits(c), bar);
                self.add_to(x, own, adjoints);
            }
            Operation::Gather { x, index } => {
                let own = self.scatter(bar, &widened(&index), self.length(x));
                self.add_to(x, own, adjoints);
            }
            Operation::Scatter { x, index } => {
                let own = self.gather(bar, &widened(&index));
                self.add_to(x, own, adjoints);
            }
        }
    }

    fn add_to(&mut self, x: Node, own: Node, adjoints: &mut Adjoints) {
        let vanishes = self.known(own).is_some_and(|known| known.iter().all(|x| *x == 0.0));
        if !vanishes {
            let before = adjoints.bars[x.index()];
            adjoints.bars[x.index()] = self.sum_of(before, Some(own));
        }
    }
}
