//! Backward differentiation.

use crate::builder::Builder;
use crate::forward::widened;
use crate::operation::{Layer, Node, Operation};

/// A part of the gradient with respect to the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightTerm {
    /// Sum Σ ȳxᵀ over the columns for a layer's weights, and Σ ȳ for its biases if they were added.
    Layer {
        /// The layer.
        layer: Layer,
        /// Number of vectors that it was applied to.
        columns: usize,
        /// Adjoint of its outputs.
        y_bar: Node,
        /// Inputs of the layer.
        x: Node,
        /// Whether it added its biases.
        bias: bool,
    },
    /// Adjoint of numbers of the weight block.
    Parameters {
        /// Position of the first number.
        start: usize,
        /// Adjoint of these numbers.
        bar: Node,
    },
}

/// Gradient of a scalar.
#[derive(Clone, Debug, Default)]
pub struct Adjoints {
    bars: Vec<Option<Node>>,
    /// The numbers of which the node is a function, column by column, that is passing on its adjoint.
    of_reader: Option<Node>,
    /// Terms whose sum is the gradient with respect to the weights.
    pub weights: Vec<WeightTerm>,
}

impl Adjoints {
    /// Gradient with respect to a vector if only this vector's entries change.
    pub fn of(&self, builder: &mut Builder, x: Node) -> Node {
        let bar = self.bars.get(x.index()).copied().flatten();
        bar.unwrap_or_else(|| builder.zeros(builder.length(x)))
    }

    fn add(&mut self, builder: &mut Builder, x: Node, own: Node) {
        let before = self.bars[x.index()];
        self.bars[x.index()] = builder.sum_of(before, Some(own));
    }
}

impl Builder {
    /// Returns the gradient of ȳ·y for a vector y and a constant vector ȳ.
    pub fn pull_back(&mut self, y: Node, y_bar: Node) -> Adjoints {
        assert_eq!(self.length(y), self.length(y_bar), "an adjoint");
        let mut adjoints = Adjoints { bars: vec![None; y.index() + 1], ..Adjoints::default() };
        self.add_to(y, y_bar, &mut adjoints);
        for at in (0..=y.index()).rev() {
            if let Some(bar) = adjoints.bars[at] {
                adjoints.of_reader = self.variable(Node::new(at));
                self.pull(at, bar, &mut adjoints);
            }
        }
        adjoints
    }

    /// Passes the adjoint of one node on to its operands.
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

    /// Adds to the adjoint of a node, on behalf of a node that reads it. Functions of a single number that other nodes
    /// read pass their adjoint directly to that number, not through each other.
    fn add_to(&mut self, x: Node, own: Node, adjoints: &mut Adjoints) {
        if self.is_all(own, 0.0) || adjoints.of_reader == Some(x) {
            return;
        }
        adjoints.add(self, x, own);
        if let Some(variable) = self.variable(x).filter(|_| adjoints.of_reader.is_none())
            && let Some(slope) = self.own_slope(x)
        {
            let own = self.column_products(own, slope, self.length(variable));
            adjoints.add(self, variable, own);
        }
    }
}
