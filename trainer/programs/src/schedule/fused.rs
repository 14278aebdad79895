//! Operations that are computed together: a sum and the gathering of its summands, a product and a function that is its
//! factor.

use super::{Scheduler, reads_of};
use crate::function::Function;
use crate::operation::{Node, Operation};
use crate::reverse::WeightTerm;

impl<'b> Scheduler<'b> {
    /// Finds functions that only one product reads, and for which no other derivative is computed at the same vector.
    pub(super) fn find_factors(&mut self, order: &[Node], outputs: &[Node], rows: &[Vec<WeightTerm>]) {
        let mut readers = vec![0; self.ranks.len()];
        let mut count = |node: Node| readers[node.index()] += 1;
        outputs.iter().for_each(|node| count(*node));
        rows.iter().flatten().for_each(|term| reads_of(term, &mut count));
        order.iter().for_each(|node| self.builder.operations[node.index()].reads(&mut count));
        for node in order {
            let Operation::Product(a, b) = self.builder.operations[node.index()] else { continue };
            let factor = [a, b].into_iter().find(|x| {
                readers[x.index()] == 1 && self.is_computed_alone(*x) && self.form(*x) == self.form(*node)
            });
            self.is_factor.extend(factor);
            self.factors.extend(factor.map(|factor| (*node, factor)));
        }
    }

    /// Whether a node is a function of which no other derivative is needed.
    fn is_computed_alone(&self, node: Node) -> bool {
        match &self.builder.operations[node.index()] {
            Operation::Map { function, x, .. } => self.maps[&(*function, *x)].iter().flatten().count() == 1,
            _ => false,
        }
    }

    /// Function among the factors of a product that is computed together with it, with its order and argument, and the
    /// other factor.
    pub(super) fn factor(&self, product: Node) -> Option<(Function, usize, Node, Node)> {
        let factor = self.factors.get(&product)?;
        match (&self.builder.operations[product.index()], &self.builder.operations[factor.index()]) {
            (Operation::Product(a, b), Operation::Map { function, order, x }) => {
                let other = if a == factor { *b } else { *a };
                Some((self.builder.functions[function], *order, *x, other))
            }
            _ => None,
        }
    }

    /// Nodes read by the step that computes a node.
    pub(super) fn reads(&self, node: Node) -> Vec<Node> {
        let operation = &self.builder.operations[node.index()];
        let mut read = Vec::new();
        match operation {
            Operation::Scatter { x, .. } => read.push(self.summands(*x).0),
            Operation::Product(..) if self.factors.contains_key(&node) => {
                read.extend(self.factor(node).into_iter().flat_map(|(_, _, x, other)| [x, other]));
            }
            _ => operation.reads(|x| read.push(x)),
        }
        read
    }

    /// Vector from which summands are read, and their positions in it. If nothing else needs the gathered vector, this
    /// is the source of the gathering.
    pub(super) fn summands(&self, x: Node) -> (Node, Option<&'b [u32]>) {
        let fused = self.layout.as_ref().is_some_and(|layout| layout.is_fused(x));
        match &self.builder.operations[x.index()] {
            Operation::Gather { x, index } if fused => (*x, Some(index)),
            _ => (x, None),
        }
    }
}
