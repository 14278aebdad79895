//! Entries of gathered and added vectors, traced back to the vectors from which they come.

use crate::builder::Builder;
use crate::operation::{Node, Operation};
use crate::single::Variables;

impl Builder {
    /// Gathers entries of a gathered, added or joined vector directly from its operands; `None` if that takes more than one gather.
    pub(crate) fn gathered_before(&mut self, x: Node, index: &[usize]) -> Option<Node> {
        // A function of a single number is kept as a node of its own, unless there are many of them side by side.
        if matches!(self.variables[x.index()], Variables::Of(variable) if x == variable || self.length(variable) == 1)
        {
            return None;
        }
        if self.vanish(x, index) {
            return Some(self.zeros(index.len()));
        }
        let (x, index) = match &self.operations[x.index()] {
            Operation::Gather { x, index: own } => (*x, index.iter().map(|i| own[*i] as usize).collect()),
            Operation::Scatter { x: summands, index: own } => {
                let of_entries = only_summands(own, self.length(x));
                (*summands, index.iter().map(|k| of_entries[*k]).collect::<Option<_>>()?)
            }
            Operation::Sum(a, b) if self.vanish(*a, index) => (*b, index.to_vec()),
            Operation::Sum(a, b) if self.vanish(*b, index) => (*a, index.to_vec()),
            _ => return None,
        };
        Some(self.gather(x, &index))
    }

    /// Whether these entries are known to be 0.
    fn vanish(&self, x: Node, entries: &[usize]) -> bool {
        match &self.operations[x.index()] {
            Operation::Constant(bits) => entries.iter().all(|k| f64::from_bits(bits[*k]) == 0.0),
            Operation::Scatter { index, .. } => {
                let mut has_summands = vec![false; self.length(x)];
                index.iter().for_each(|k| has_summands[*k as usize] = true);
                entries.iter().all(|k| !has_summands[*k])
            }
            Operation::Sum(a, b) => self.vanish(*a, entries) && self.vanish(*b, entries),
            _ => false,
        }
    }
}

/// The single summand of each of `sums` sums that has exactly one; otherwise `None`.
fn only_summands(index: &[u32], sums: usize) -> Vec<Option<usize>> {
    let mut counts = vec![0; sums];
    let mut last = vec![None; sums];
    for (i, k) in index.iter().enumerate() {
        counts[*k as usize] += 1;
        last[*k as usize] = (counts[*k as usize] == 1).then_some(i);
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_joined_vectors_are_those_that_were_joined() {
        let mut builder = Builder::new();
        let [a, b] = [3, 2].map(|length| builder.input(length));
        let joined = builder.joined(&[a, b]);
        assert_eq!(builder.part(joined, 0..3), a);
        assert_eq!(builder.part(joined, 3..5), b);
        let (last, first) = (builder.gather(joined, &[4, 3]), builder.gather(b, &[1, 0]));
        assert_eq!(last, first);
        let mixed = builder.gather(joined, &[2, 3]);
        assert!(matches!(builder.operations[mixed.index()], Operation::Gather { x, .. } if x == joined));
    }

    #[test]
    fn entries_without_summands_are_zero() {
        let mut builder = Builder::new();
        let x = builder.input(2);
        let sums = builder.scatter(x, &[3, 3], 4);
        assert_eq!(builder.gather(sums, &[0, 2, 2]), builder.zeros(3));
        let sum = builder.gather(sums, &[3]);
        assert!(matches!(builder.operations[sum.index()], Operation::Gather { x, .. } if x == sums));
    }
}
