//! Potentials between pairs of elements.

use crate::builder::Builder;
use crate::energies::Network;
use crate::function::Function;
use crate::operation::Node;
use leastaction_core::energy::modular::{PairInput, PairShape};

/// The pair potential over the weight block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pair {
    network: Network,
    input: PairInput,
}

impl Pair {
    /// Creates the pair potential; `networks` are all networks of the model.
    pub fn new(shape: &PairShape, networks: &[Network]) -> Self {
        Self { network: networks[usize::from(shape.network)].clone(), input: shape.input }
    }

    /// Potential U₂ of two positions, J/kg².
    pub fn potential(&self, builder: &mut Builder, a: Node, b: Node) -> Node {
        match self.input {
            PairInput::Concat => {
                let both = [[a, b], [b, a]].map(|positions| builder.joined(&positions));
                self.mean(builder, both)
            }
            PairInput::Difference => {
                let forth = builder.difference(a, b);
                let back = builder.scaled(-1.0, forth);
                self.mean(builder, [forth, back])
            }
            PairInput::Distance => {
                let distance = distance(builder, a, b);
                self.network.output(builder, distance)
            }
            PairInput::InverseDistance => {
                let distance = distance(builder, a, b);
                let inverse = builder.map(Function::Reciprocal, distance);
                self.network.output(builder, inverse)
            }
        }
    }

    /// Mean ½[U(x) + U(y)], which does not depend on the order of the two elements.
    fn mean(&self, builder: &mut Builder, inputs: [Node; 2]) -> Node {
        let [x, y] = inputs.map(|input| self.network.output(builder, input));
        let sum = builder.sum(x, y);
        builder.scaled(0.5, sum)
    }
}

/// Distance |a − b|, m; not differentiable where the two meet.
fn distance(builder: &mut Builder, a: Node, b: Node) -> Node {
    let difference = builder.difference(a, b);
    let square = builder.dot(difference, difference);
    builder.map(Function::SquareRoot, square)
}
