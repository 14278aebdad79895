//! Functions of a single number. They are differentiated once, forwards. The derivative of any result computed from
//! them, with respect to that number, is their derivative times a factor.
//!
//! For example, the displacement by an element of a tree is a network of the element's own angle. Its derivatives x′,
//! x″ are used for all coordinates, in place of a backward pass through the network for every use.

use crate::builder::Builder;
use crate::operation::{Node, Operation};

/// Variables that a node depends on, besides constants and weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variables {
    /// No variable.
    None,
    /// One number: an input, or an entry of one.
    One(Node),
    /// Several numbers.
    Many,
}

impl Variables {
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::None, variables) | (variables, Self::None) => variables,
            (one, other) if one == other => one,
            _ => Self::Many,
        }
    }
}

impl Builder {
    /// Variables on which an operation depends that becomes the node `own`.
    pub(crate) fn variables_of(&self, operation: &Operation, length: usize, own: Node) -> Variables {
        let of_input = match operation {
            Operation::Input(_) => true,
            Operation::Gather { x, .. } => matches!(self.operations[x.index()], Operation::Input(_)),
            _ => false,
        };
        if of_input && length == 1 {
            return Variables::One(own);
        }
        let mut variables = if of_input { Variables::Many } else { Variables::None };
        operation.reads(|x| variables = variables.and(self.variables[x.index()]));
        variables
    }

    /// Number of which a node is a function, if that number is another node.
    pub(crate) fn variable(&self, node: Node) -> Option<Node> {
        match self.variables[node.index()] {
            Variables::One(variable) if variable != node => Some(variable),
            _ => None,
        }
    }

    /// Derivative of a function of a single number with respect to that number; `None` if it is 0.
    pub(crate) fn own_slope(&mut self, node: Node) -> Option<Node> {
        if let Some(slope) = self.slopes.get(&node) {
            return *slope;
        }
        let slope = match self.variables[node.index()] {
            Variables::One(variable) if variable == node => Some(self.constant(&[1.0])),
            Variables::One(_) => self.inner_slope(node),
            _ => None,
        };
        self.slopes.insert(node, slope);
        slope
    }

    fn inner_slope(&mut self, node: Node) -> Option<Node> {
        let mut read = Vec::new();
        self.operations[node.index()].reads(|x| read.push(x));
        let slopes: Vec<_> = read.into_iter().map(|x| (x, self.own_slope(x))).collect();
        self.slope(node.index(), |x| slopes.iter().find(|(own, _)| *own == x).and_then(|(_, slope)| *slope))
    }

    /// Derivative of a function of a single number, given the derivative of that number.
    pub(crate) fn chained(&mut self, node: Node, rate: Node) -> Option<Node> {
        let slope = self.own_slope(node)?;
        let rate = self.repeated(rate, self.length(node));
        Some(self.product(slope, rate))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::Function;
    use crate::operation::Layer;
    use crate::program::Program;
    use crate::row::Row;
    use crate::step::Step;

    /// For |y|², where y is a network of one of two inputs, the derivative goes forwards through the network.
    #[test]
    fn a_function_of_one_number_is_not_differentiated_backwards() {
        let mut builder = Builder::new();
        let q = builder.input(2);
        let x = builder.part(q, 1..2);
        let hidden = builder.linear(Layer::new(0, 1, 3), 1, x);
        let hidden = builder.map(Function::Sine, hidden);
        let y = builder.linear(Layer::new(6, 3, 2), 1, hidden);
        let square = builder.dot(y, y);
        let one = builder.constant(&[1.0]);
        let gradient = builder.pull_back(square, one).of(&mut builder, q);
        let axis = builder.constant(&[0.0, 1.0]);
        let rate = builder.tangents(&[square], &[(q, axis)])[0];
        let program = Program::new(&builder, &[gradient, rate], &[]);
        assert!(!program.steps.iter().any(|step| matches!(step, Step::Transposed { .. })));
        let weights: Vec<f64> = (0..14).map(|i| f64::from(i).sin()).collect();
        let mut workspace = program.workspace();
        program.run_outputs(&weights, &[&[Row::splat(0.4), Row::splat(0.7)]], &mut workspace);
        let ([zero, found], rate) = (workspace.output(0), workspace.output(1)[0].0[0]) else { panic!() };
        assert!(zero.0[0] == 0.0 && (found.0[0] - rate).abs() < 1e-14 && rate.abs() > 1e-3);
    }
}
