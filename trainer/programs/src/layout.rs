//! Where the numbers of vectors lie in rows.
//!
//! Of several samples every number is a row. Of one sample what lies side by side are the columns of a vector, as the layer that it
//! goes through has them: nodes and edges of a graph. Each [`WIDTH`] columns are as many rows as a column has units; a vector that
//! no layer sees has columns of one unit, and so its numbers one after the other.

use crate::builder::{Builder, Node, Operation};
use crate::row::{Places, WIDTH};

/// Units of every node's columns.
#[derive(Clone, Debug)]
pub(crate) struct Layout(Vec<usize>);

impl Layout {
    /// That of the needed nodes.
    pub fn new(builder: &Builder, needed: &[bool]) -> Self {
        let wanted = wanted(builder, needed);
        let mut units = vec![1; needed.len()];
        for at in (0..needed.len()).filter(|at| needed[*at]) {
            units[at] = match &builder.operations[at] {
                Operation::Input(_) | Operation::Parameters(_) => 1,
                Operation::Linear { layer, .. } => layer.outputs.max(1),
                Operation::Transposed { layer, .. } => layer.inputs.max(1),
                Operation::Map { x, .. } | Operation::Scaled(_, x) => units[x.index()],
                Operation::Product(x, _) | Operation::Sum(x, _) => wanted[at].unwrap_or(units[x.index()]),
                Operation::Constant(_) | Operation::Gather { .. } | Operation::Scatter { .. } => {
                    wanted[at].unwrap_or(1)
                }
            };
        }
        Self(units)
    }

    /// Units of a node's columns.
    pub fn units(&self, node: Node) -> usize {
        self.0[node.index()]
    }

    /// Where the numbers of a gathered vector are read from, row by row.
    pub fn picked(&self, node: Node, x: Node, index: &[u32]) -> Box<[Places]> {
        let from = self.units(x);
        let places: Vec<u32> = index.iter().map(|i| place(from, *i as usize) as u32).collect();
        rows_of(&arranged(self.units(node), &places))
    }

    /// Where the summands of a scattered vector of this length are read from, and where those of every row end.
    pub fn summed(
        &self,
        [node, x]: [Node; 2],
        length: usize,
        index: &[u32],
    ) -> (Box<[usize]>, Box<[Places]>) {
        let [to, from] = [node, x].map(|node| self.units(node));
        let mut terms: Vec<Vec<Places>> = vec![Vec::new(); rows(to, length)];
        let mut counts = vec![0; WIDTH * terms.len()];
        for (i, k) in index.iter().enumerate() {
            let own = place(to, *k as usize);
            let (row, count) = (&mut terms[own / WIDTH], counts[own]);
            if count == row.len() {
                row.push([u32::MAX; WIDTH]);
            }
            row[count][own % WIDTH] = place(from, i) as u32;
            counts[own] += 1;
        }
        let mut end = 0;
        let ends = terms.iter().map(|terms| {
            end += terms.len();
            end
        });
        (ends.collect(), terms.concat().into())
    }
}

/// Places in rows of places.
pub(crate) fn rows_of(places: &[u32]) -> Box<[Places]> {
    places.as_chunks().0.into()
}

/// The units that the layers and functions want which read a node, the last of them.
fn wanted(builder: &Builder, needed: &[bool]) -> Vec<Option<usize>> {
    let mut wanted = vec![None; needed.len()];
    for at in (0..needed.len()).rev().filter(|at| needed[*at]) {
        let own = match &builder.operations[at] {
            Operation::Linear { layer, .. } => Some(layer.inputs.max(1)),
            Operation::Transposed { layer, .. } => Some(layer.outputs.max(1)),
            Operation::Gather { .. } | Operation::Scatter { .. } => None,
            _ => wanted[at],
        };
        if own.is_some() {
            builder.operations[at].reads(|x| wanted[x.index()] = own);
        }
    }
    wanted
}

/// Rows of so many numbers in columns of so many units.
pub(crate) fn rows(units: usize, length: usize) -> usize {
    (length / units).div_ceil(WIDTH) * units
}

/// The place of a number among those of all rows.
pub(crate) fn place(units: usize, i: usize) -> usize {
    let (column, unit) = (i / units, i % units);
    (column / WIDTH * units + unit) * WIDTH + column % WIDTH
}

/// Numbers as they lie in the rows; 0 where there is none.
pub(crate) fn arranged<T: Copy + Default>(units: usize, numbers: &[T]) -> Vec<T> {
    let mut places = vec![T::default(); WIDTH * rows(units, numbers.len())];
    numbers.iter().enumerate().for_each(|(i, x)| places[place(units, i)] = *x);
    places
}
