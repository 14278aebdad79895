//! Dependence of the entries of one vector on those of another, and sparse Jacobians computed along few directions.

use crate::builder::Builder;
use crate::operation::{Node, Operation};
use std::collections::HashMap;

/// Sets of numbers, each stored once: an entry of a vector refers to its set by the set's position.
#[derive(Debug)]
struct Sets {
    sets: Vec<Vec<usize>>,
    positions: HashMap<Vec<usize>, usize>,
    unions: HashMap<[usize; 2], usize>,
}

/// Position of the empty set.
const EMPTY: usize = 0;

impl Sets {
    fn new() -> Self {
        let empty = HashMap::from([(Vec::new(), EMPTY)]);
        Self { sets: vec![Vec::new()], positions: empty, unions: HashMap::new() }
    }

    fn position(&mut self, set: Vec<usize>) -> usize {
        let next = self.sets.len();
        let position = *self.positions.entry(set.clone()).or_insert(next);
        if position == next {
            self.sets.push(set);
        }
        position
    }

    fn union(&mut self, a: usize, b: usize) -> usize {
        let pair = [a.min(b), a.max(b)];
        if a == b || pair[0] == EMPTY {
            return pair[1];
        }
        if let Some(known) = self.unions.get(&pair) {
            return *known;
        }
        let mut set = [&self.sets[a][..], &self.sets[b]].concat();
        set.sort_unstable();
        set.dedup();
        let position = self.position(set);
        self.unions.insert(pair, position);
        position
    }

    fn union_of(&mut self, sets: &[usize]) -> usize {
        sets.iter().fold(EMPTY, |union, set| self.union(union, *set))
    }
}

impl Builder {
    /// Entries of `on`, in ascending order, on which each entry of a vector depends.
    pub(crate) fn dependence(&self, of: Node, on: Node) -> Vec<Vec<usize>> {
        let (mut sets, count) = (Sets::new(), of.index() + 1);
        let mut entries: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (at, _) in self.read_by(&[of], count).iter().enumerate().filter(|(_, read)| **read) {
            entries[at] = if at == on.index() {
                (0..self.lengths[at]).map(|i| sets.position(vec![i])).collect()
            } else {
                self.sets_of(at, &entries, &mut sets)
            };
        }
        entries[of.index()].iter().map(|set| sets.sets[*set].clone()).collect()
    }

    /// Sets of a node's entries, from those of its operands.
    fn sets_of(&self, at: usize, entries: &[Vec<usize>], sets: &mut Sets) -> Vec<usize> {
        let of = |x: &Node| &entries[x.index()];
        let length = self.lengths[at];
        match &self.operations[at] {
            Operation::Input(_) | Operation::Constant(_) | Operation::Parameters(_) => vec![EMPTY; length],
            Operation::Linear { columns, x, .. } | Operation::Transposed { columns, y: x, .. } => {
                let (inputs, outputs) = (of(x).len() / columns.max(&1), length / columns.max(&1));
                let unions: Vec<usize> = of(x).chunks(inputs.max(1)).map(|x| sets.union_of(x)).collect();
                unions.into_iter().flat_map(|union| std::iter::repeat_n(union, outputs)).collect()
            }
            Operation::Map { x, .. } | Operation::Scaled(_, x) => of(x).clone(),
            Operation::Product(x, y) | Operation::Sum(x, y) => {
                of(x).iter().zip(of(y)).map(|(a, b)| sets.union(*a, *b)).collect()
            }
            Operation::Gather { x, index } => index.iter().map(|i| of(x)[*i as usize]).collect(),
            Operation::Scatter { x, index } => {
                let mut sums = vec![EMPTY; length];
                for (x, i) in of(x).iter().zip(index) {
                    sums[*i as usize] = sets.union(sums[*i as usize], *x);
                }
                sums
            }
        }
    }
}

/// A sparse square Jacobian that is computed along few directions: columns without a common row share a direction
/// (Curtis, Powell, Reid 1974).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    /// Columns of each row, in ascending order.
    rows: Vec<Vec<usize>>,
    /// Direction of each column.
    directions: Vec<usize>,
    /// Rows and columns that are connected with each other and with no others.
    blocks: Vec<Vec<usize>>,
}

impl Pattern {
    /// Creates the pattern of a Jacobian with these columns in its rows.
    pub(crate) fn new(rows: Vec<Vec<usize>>) -> Self {
        let (directions, blocks) = (directions(&rows), blocks(&rows));
        Self { rows, directions, blocks }
    }

    /// Number of rows, and of columns.
    pub fn size(&self) -> usize {
        self.rows.len()
    }

    /// Number of directions that give the whole Jacobian.
    pub fn directions(&self) -> usize {
        self.directions.iter().max().map_or(0, |last| last + 1)
    }

    /// Columns of a direction.
    pub(crate) fn columns(&self, direction: usize) -> impl Iterator<Item = usize> {
        let own = self.directions.iter().enumerate().filter(move |(_, own)| **own == direction);
        own.map(|(column, _)| column)
    }

    /// Direction along which entry i of the directional derivative is the Jacobian's entry (i, j); `None` if that entry
    /// is 0.
    pub fn direction(&self, i: usize, j: usize) -> Option<usize> {
        self.rows[i].binary_search(&j).ok().map(|_| self.directions[j])
    }

    /// Rows and columns that are connected with each other and with no others.
    pub fn blocks(&self) -> &[Vec<usize>] {
        &self.blocks
    }

    /// Blocks, grouped by size.
    pub(crate) fn blocks_by_size(&self) -> Vec<Vec<Vec<usize>>> {
        let mut blocks = self.blocks.clone();
        blocks.sort_by_key(Vec::len);
        blocks.chunk_by(|a, b| a.len() == b.len()).map(<[_]>::to_vec).collect()
    }
}

/// Direction of every column: the first one that is not taken by a column with a common row.
fn directions(rows: &[Vec<usize>]) -> Vec<usize> {
    let mut columns = vec![Vec::new(); rows.len()];
    for (i, row) in rows.iter().enumerate() {
        row.iter().for_each(|j| columns[*j].push(i));
    }
    let mut directions = vec![usize::MAX; rows.len()];
    for j in 0..rows.len() {
        let taken: Vec<usize> = columns[j].iter().flat_map(|i| &rows[*i]).map(|k| directions[*k]).collect();
        directions[j] = (0..).find(|own| !taken.contains(own)).unwrap_or(j);
    }
    directions
}

fn blocks(rows: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut leaders: Vec<usize> = (0..rows.len()).collect();
    for (i, row) in rows.iter().enumerate() {
        for j in row {
            let [a, b] = [i, *j].map(|k| leader(&leaders, k));
            leaders[a.max(b)] = a.min(b);
        }
    }
    let mut blocks = vec![Vec::new(); rows.len()];
    (0..rows.len()).for_each(|k| blocks[leader(&leaders, k)].push(k));
    blocks.retain(|block| !block.is_empty());
    blocks
}

fn leader(leaders: &[usize], mut k: usize) -> usize {
    while leaders[k] != k {
        k = leaders[k];
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operation::Layer;

    #[test]
    fn an_entry_depends_on_what_it_is_computed_from() {
        let mut builder = Builder::new();
        let x = builder.input(4);
        let layer = Layer::new(0, 2, 3);
        let y = builder.linear(layer, 2, x);
        let sum = builder.scatter(y, &[0, 0, 1, 1, 2, 3], 5);
        let found = builder.dependence(sum, x);
        assert_eq!(found, [vec![0, 1], vec![0, 1, 2, 3], vec![2, 3], vec![2, 3], vec![]]);
    }

    #[test]
    fn columns_without_a_common_row_share_a_direction() {
        let pattern = Pattern::new(vec![vec![0, 1], vec![0, 1], vec![2], vec![3, 4], vec![3, 4]]);
        assert_eq!(pattern.directions(), 2);
        assert_eq!(pattern.blocks(), [vec![0, 1], vec![2], vec![3, 4]]);
        assert_eq!(
            [[0, 1], [2, 2], [3, 4], [0, 2]].map(|[i, j]| pattern.direction(i, j)),
            [Some(1), Some(0), Some(1), None]
        );
        let arrow = Pattern::new(vec![vec![0, 1, 2], vec![0, 1], vec![0, 2]]);
        assert_eq!((arrow.directions(), arrow.blocks().len()), (3, 1));
    }
}
