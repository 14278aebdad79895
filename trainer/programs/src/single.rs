//! Functions of a single number. They are differentiated once, forwards. The derivative of any result computed from
//! them, with respect to that number, is their derivative times a factor.
//!
//! For example, the displacement by an element of a tree is a network of the element's own angle. Its derivatives x′,
//! x″ are used for all coordinates, in place of a backward pass through the network for every use.
//!
//! A network of one input that is applied to many columns, such as the distances along all edges of a graph, is a function of a single
//! number column by column.

use crate::builder::Builder;
use crate::operation::{Node, Operation};

/// Variables that a node depends on, besides constants and weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variables {
    /// No variable.
    None,
    /// The numbers of a node, each in a column of its own: a vector has as many columns of equal length as that node has numbers, and every
    /// column depends on one of them. A node with one number is an input or an entry of one.
    Of(Node),
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
            return Variables::Of(own);
        }
        let mut variables = if of_input { Variables::Many } else { Variables::None };
        operation.reads(|x| variables = variables.and(self.variables[x.index()]));
        match (operation, variables) {
            (Operation::Linear { layer, columns, x, .. }, Variables::Many)
                if layer.inputs == 1 && *columns > 1 =>
            {
                Variables::Of(*x)
            }
            (_, Variables::Of(variable)) if !self.keeps_columns(operation, length, self.length(variable)) => {
                Variables::Many
            }
            _ => variables,
        }
    }

    /// Whether every one of `columns` columns of the result is computed from the same column of what the operation reads.
    fn keeps_columns(&self, operation: &Operation, length: usize, columns: usize) -> bool {
        let divides = |length: usize| length.is_multiple_of(columns);
        // Entry i and number index[i] of the other vector are in the same column, given the numbers of units of both.
        let same = |index: &[u32], entries: usize, numbers: usize| {
            let mut pairs = index.iter().enumerate();
            entries > 0 && numbers > 0 && pairs.all(|(i, k)| i / entries == *k as usize / numbers)
        };
        let units = |x: Node| self.length(x) / columns;
        let stays = match operation {
            Operation::Linear { columns: own, .. } | Operation::Transposed { columns: own, .. } => {
                divides(*own)
            }
            Operation::Gather { x, index } => {
                divides(self.length(*x)) && same(index, length / columns, units(*x))
            }
            Operation::Scatter { x, index } => {
                divides(self.length(*x)) && same(index, units(*x), length / columns)
            }
            _ => true,
        };
        columns == 1 || divides(length) && stays
    }

    /// Numbers of which a node is a function column by column, if they are those of another node.
    pub(crate) fn variable(&self, node: Node) -> Option<Node> {
        match self.variables[node.index()] {
            Variables::Of(variable) if variable != node => Some(variable),
            _ => None,
        }
    }

    /// Derivative of a function of a single number with respect to that number; `None` if it is 0.
    pub(crate) fn own_slope(&mut self, node: Node) -> Option<Node> {
        if let Some(slope) = self.slopes.get(&node) {
            return *slope;
        }
        let slope = self.variable(node).and_then(|variable| self.inner_slope(node, variable));
        self.slopes.insert(node, slope);
        slope
    }

    fn inner_slope(&mut self, node: Node, variable: Node) -> Option<Node> {
        let mut read = Vec::new();
        self.operations[node.index()].reads(|x| read.push(x));
        let mut slopes = Vec::new();
        for x in read {
            let slope = match x == variable {
                true => Some(self.constant(&vec![1.0; self.length(x)])),
                false => self.own_slope(x),
            };
            slopes.push((x, slope));
        }
        self.slope(node.index(), |x| slopes.iter().find(|(own, _)| *own == x).and_then(|(_, slope)| *slope))
    }

    /// Derivative of a function of a single number, given the derivative of that number.
    pub(crate) fn chained(&mut self, node: Node, rate: Node) -> Option<Node> {
        let slope = self.own_slope(node)?;
        let rate = self.in_columns(rate, self.length(node));
        Some(self.product(slope, rate))
    }

    /// Products x·y of `columns` columns, as a vector with one number for each.
    pub(crate) fn column_products(&mut self, x: Node, y: Node, columns: usize) -> Node {
        let product = self.product(x, y);
        let units = self.length(product) / columns;
        self.scatter(product, &owners(columns, units), columns)
    }

    /// Repeats every number for all units of its column, in a vector of this length.
    fn in_columns(&mut self, x: Node, length: usize) -> Node {
        let columns = self.length(x);
        self.gather(x, &owners(columns, length / columns))
    }
}

/// Column of every entry; each of `columns` columns has `units` entries.
fn owners(columns: usize, units: usize) -> Vec<usize> {
    (0..columns * units).map(|entry| entry / units).collect()
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
