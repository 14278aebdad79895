//! Forward differentiation.

use crate::builder::Builder;
use crate::operation::{Node, Operation};

impl Builder {
    /// Derivatives of the nodes `of` when other vectors move; each pair in `along` is a vector and its direction.
    pub fn tangents(&mut self, of: &[Node], along: &[(Node, Node)]) -> Vec<Node> {
        let last = of.iter().max().map_or(0, |last| last.index() + 1);
        let mut slopes = vec![None; last];
        for (node, slope) in along {
            assert_eq!(self.length(*node), self.length(*slope), "a direction");
            if let Some(place) = slopes.get_mut(node.index()) {
                *place = Some(*slope);
            }
        }
        let read = self.read_by(of, last);
        let of_inputs =
            along.iter().all(|(node, _)| matches!(self.operations[node.index()], Operation::Input(_)));
        for at in 0..last {
            if read[at] && slopes[at].is_none() {
                slopes[at] = match self.variable(Node::new(at)).filter(|_| of_inputs) {
                    Some(variable) => {
                        slopes[variable.index()].and_then(|rate| self.chained(Node::new(at), rate))
                    }
                    None => self.slope(at, |x| slopes[x.index()]),
                };
            }
        }
        of.iter().map(|node| slopes[node.index()].unwrap_or_else(|| self.zeros(self.length(*node)))).collect()
    }

    /// Whether each of the first `count` nodes is needed to compute these nodes, which count as needed themselves.
    pub(crate) fn read_by(&self, nodes: &[Node], count: usize) -> Vec<bool> {
        let mut read = vec![false; count];
        nodes.iter().for_each(|node| read[node.index()] = true);
        for at in (0..count).rev() {
            if read[at] {
                self.operations[at].reads(|x| read[x.index()] = true);
            }
        }
        read
    }

    /// Derivative of one node, from those of its operands; `None` if it is zero.
    pub(crate) fn slope(&mut self, at: usize, of: impl Fn(Node) -> Option<Node>) -> Option<Node> {
        let node = Node::new(at);
        let slope = match self.operations[at].clone() {
            Operation::Input(_) | Operation::Constant(_) | Operation::Parameters(_) => return None,
            Operation::Linear { layer, columns, x, .. } => self.product_of(layer, columns, of(x)?, false),
            Operation::Transposed { layer, columns, y } => self.transposed(layer, columns, of(y)?),
            Operation::Map { function, order, x } => {
                let (function, dx) = (self.functions[&function], of(x)?);
                let rate = self.derivative(function, order + 1, x);
                self.product(rate, dx)
            }
            Operation::Product(x, y) => {
                let left = of(x).map(|dx| self.product(dx, y));
                let right = of(y).map(|dy| self.product(x, dy));
                self.sum_of(left, right)?
            }
            Operation::Sum(x, y) => self.sum_of(of(x), of(y))?,
            Operation::Scaled(c, x) => self.scaled(f64::from_bits(c), of(x)?),
            Operation::Gather { x, index } => self.gather(of(x)?, &widened(&index)),
            Operation::Scatter { x, index } => {
                let length = self.length(node);
                self.scatter(of(x)?, &widened(&index), length)
            }
        };
        let vanishes = self.known(slope).is_some_and(|known| known.iter().all(|x| *x == 0.0));
        if vanishes { None } else { Some(slope) }
    }

    /// Sum of the terms that are present.
    pub(crate) fn sum_of(&mut self, x: Option<Node>, y: Option<Node>) -> Option<Node> {
        match (x, y) {
            (Some(x), Some(y)) => Some(self.sum(x, y)),
            (x, y) => x.or(y),
        }
    }
}

pub(crate) fn widened(index: &[u32]) -> Vec<usize> {
    index.iter().map(|i| *i as usize).collect()
}
