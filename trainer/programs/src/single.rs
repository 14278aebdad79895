//! Functions of one number, which are differentiated forwards, once: every derivative in that number, of whatever is computed
//! from them, is theirs multiplied by a number.
//!
//! What an element of a tree adds to positions is a network of its own angle. Its derivatives x′, x″ then serve all coordinates, in
//! place of passes backwards through the network, one for every use.

use crate::builder::{Builder, Node, Operation};

/// What a node is a function of, beside constants and weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Variables {
    /// Nothing.
    None,
    /// This number alone: an input, or an entry of one.
    One(Node),
    /// More.
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
    /// Those of an operation that becomes the node `own`.
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

    /// The number that a node is a function of, where it is another node.
    pub(crate) fn variable(&self, node: Node) -> Option<Node> {
        match self.variables[node.index()] {
            Variables::One(variable) if variable != node => Some(variable),
            _ => None,
        }
    }

    /// The derivative of a function of one number in that number; none where it is 0.
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

    /// The slope of a function of one number whose slope is this one.
    pub(crate) fn chained(&mut self, node: Node, rate: Node) -> Option<Node> {
        let slope = self.own_slope(node)?;
        let rate = self.repeated(rate, self.length(node));
        Some(self.product(slope, rate))
    }
}
