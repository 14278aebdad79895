//! Arrangement of the numbers of vectors in rows.
//!
//! With several samples, every number is a row. With a single sample, the columns of a vector (for nodes and edges of a
//! graph) lie side by side. The number of units of a column is that of the layer to which it is passed, or the number
//! of entries of it that are added up. Every [`WIDTH`] columns take as many rows as a column has units. A vector
//! without such columns has columns of one unit, so its numbers follow one another. If all columns are equal, only one
//! is stored.

use crate::builder::Builder;
use crate::operation::{Node, Operation};
use crate::picks::{NOWHERE, PickSums, Picks};
use crate::row::{Row, WIDTH};

/// Arrangement of the numbers of a node in its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Form {
    /// Number of units in a column.
    pub units: usize,
    /// Whether all columns are equal, in which case only the rows of one column are stored.
    pub alike: bool,
}

impl Form {
    /// Columns of `units` units, all different.
    pub const fn of_units(units: usize) -> Self {
        Self { units, alike: false }
    }

    /// Form of the vector in columns of another number of units; the columns stay equal if their repetition still fits.
    pub const fn in_units(self, units: usize) -> Self {
        Self { units, alike: self.alike && units.is_multiple_of(self.units) }
    }

    /// Number of rows that `length` numbers take.
    pub fn rows(self, length: usize) -> usize {
        let groups = (length / self.units).div_ceil(WIDTH);
        self.units * if self.alike { 1 } else { groups }
    }

    /// Position of a number among those of all rows.
    pub fn place(self, i: usize) -> usize {
        let (column, unit) = (if self.alike { 0 } else { i / self.units }, i % self.units);
        (column / WIDTH * self.units + unit) * WIDTH + column % WIDTH
    }

    /// Values at the positions of all rows; `padding` where there is no number.
    fn arranged<T: Copy>(self, length: usize, number: impl Fn(usize) -> T, padding: T) -> Vec<T> {
        let mut places = vec![padding; WIDTH * self.rows(length)];
        if self.alike {
            places.chunks_mut(WIDTH).enumerate().for_each(|(unit, row)| row.fill(number(unit)));
        } else {
            (0..length).for_each(|i| places[self.place(i)] = number(i));
        }
        places
    }

    /// Rows of known numbers.
    pub fn constant(self, numbers: &[f64]) -> Vec<Row> {
        let places = self.arranged(numbers.len(), |i| numbers[i], 0.0);
        places.as_chunks().0.iter().map(|row| Row(*row)).collect()
    }

    /// Returns how to read `length` numbers, where number i is at position `from(i)` in a vector of the given form.
    pub fn picks(self, length: usize, (form, from): (Self, impl Fn(usize) -> usize)) -> Picks {
        Picks::new(&self.arranged(length, |i| form.place(from(i)) as u32, NOWHERE))
    }
}

/// The form of every node, and the nodes that are not computed.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    forms: Vec<Form>,
    /// Flags of gathered vectors that are only added up: the sums read the source of the gathering instead.
    fused: Vec<bool>,
}

impl Layout {
    /// Creates the layout of the needed nodes, for these outputs.
    pub fn new(builder: &Builder, needed: &[bool], outputs: &[Node]) -> Self {
        let wanted = wanted(builder, needed);
        let mut forms = vec![Form::of_units(1); needed.len()];
        for at in (0..needed.len()).filter(|at| needed[*at]) {
            forms[at] = form(builder, Node::new(at), wanted[at], &forms);
        }
        Self { forms, fused: fused(builder, needed, outputs) }
    }

    /// Form of a node.
    pub fn form(&self, node: Node) -> Form {
        self.forms[node.index()]
    }

    /// Whether a node is not computed because sums read the source that it is gathered from.
    pub fn is_fused(&self, node: Node) -> bool {
        self.fused[node.index()]
    }

    /// Reads of a gathered vector, row by row.
    pub fn picked(&self, node: Node, x: Node, index: &[u32]) -> Picks {
        self.form(node).picks(index.len(), (self.form(x), |i| index[i] as usize))
    }

    /// Reads of the summands of a scattered vector of this length. Summand i, which belongs to entry `index[i]` of the
    /// sum, is number `from(i)` of x.
    pub fn summed(
        &self,
        [node, x]: [Node; 2],
        length: usize,
        index: &[u32],
        from: impl Fn(usize) -> usize,
    ) -> PickSums {
        let [to, form] = [node, x].map(|node| self.form(node));
        let mut terms: Vec<Vec<u32>> = vec![Vec::new(); to.rows(length)];
        let mut counts = vec![0; WIDTH * terms.len()];
        for (i, k) in index.iter().enumerate() {
            let own = to.place(*k as usize);
            let (row, at) = (&mut terms[own / WIDTH], WIDTH * counts[own] + own % WIDTH);
            row.resize(row.len().max(WIDTH * (counts[own] + 1)), NOWHERE);
            row[at] = form.place(from(i)) as u32;
            counts[own] += 1;
        }
        let mut end = 0;
        let ends = terms.iter().map(|terms| {
            end += terms.len() / WIDTH;
            end
        });
        PickSums::new(&terms.concat(), ends.collect())
    }
}

/// Form of a node whose readers want columns of `wanted` units.
fn form(builder: &Builder, node: Node, wanted: Option<usize>, forms: &[Form]) -> Form {
    let of = |x: Node| forms[x.index()];
    match &builder.operations[node.index()] {
        Operation::Input(_) => Form::of_units(wanted.unwrap_or(1)),
        Operation::Parameters(_) => Form::of_units(1),
        Operation::Linear { layer, x, .. } => through(of(*x), layer.inputs, layer.outputs),
        Operation::Transposed { layer, y, .. } => through(of(*y), layer.outputs, layer.inputs),
        Operation::Map { x, .. } | Operation::Scaled(_, x) => of(*x),
        Operation::Product(x, y) | Operation::Sum(x, y) => {
            let units = wanted.unwrap_or(of(*x).units.max(of(*y).units));
            Form { units, alike: [*x, *y].iter().all(|x| of(*x).in_units(units).alike) }
        }
        Operation::Constant(numbers) => {
            let units = wanted.unwrap_or(1);
            Form { units, alike: repeat(numbers.len(), units, |i| numbers[i]) }
        }
        Operation::Gather { x, index } => {
            let repeats = repeated_units(index).filter(|units| *units > 1);
            let kept = Some(of(*x).units).filter(|units| is_of_columns(index, *units));
            let units = wanted.or(repeats).or(kept).unwrap_or(1);
            Form { units, alike: repeat(index.len(), units, |i| of(*x).place(index[i] as usize)) }
        }
        Operation::Scatter { x, index } => {
            let own =
                |units: &usize| is_of_columns(index, *units) && builder.length(node).is_multiple_of(*units);
            Form::of_units(wanted.or(Some(of(*x).units).filter(own)).unwrap_or(1))
        }
    }
}

/// Form of a vector after a layer is applied to it.
fn through(x: Form, inputs: usize, outputs: usize) -> Form {
    Form { units: outputs.max(1), alike: x.in_units(inputs.max(1)).alike }
}

/// Whether there are several columns of `units` units and all are equal.
fn repeat<T: PartialEq>(length: usize, units: usize, number: impl Fn(usize) -> T) -> bool {
    length > units && (units..length).all(|i| number(i) == number(i % units))
}

/// Number of times that each number is repeated before the next one follows, if all are repeated equally often.
fn repeated_units(index: &[u32]) -> Option<usize> {
    let units = index.iter().take_while(|i| **i == 0).count();
    let several = (1..index.len()).contains(&units) && index.len().is_multiple_of(units);
    (several && (0..index.len()).all(|i| index[i] as usize == i / units)).then_some(units)
}

/// Whether columns of `units` units remain columns.
fn is_of_columns(index: &[u32], units: usize) -> bool {
    let is_column = |column: &[u32]| {
        (column[0] as usize).is_multiple_of(units) && (0..units).all(|k| column[k] == column[0] + k as u32)
    };
    index.len().is_multiple_of(units) && index.chunks(units).all(is_column)
}

/// Number of units per column that the readers of each node want: layers, and sums of neighbours.
fn wanted(builder: &Builder, needed: &[bool]) -> Vec<Option<usize>> {
    let mut wanted = vec![None; needed.len()];
    for at in (0..needed.len()).rev().filter(|at| needed[*at]) {
        let own = match &builder.operations[at] {
            Operation::Linear { layer, .. } => Some(layer.inputs.max(1)),
            Operation::Transposed { layer, .. } => Some(layer.outputs.max(1)),
            Operation::Gather { x, index } => wanted[at]
                .filter(|units| builder.length(*x).is_multiple_of(*units) && is_of_columns(index, *units)),
            Operation::Scatter { index, .. } => repeated_units(index).filter(|units| *units > 1),
            _ => wanted[at],
        };
        if own.is_some() {
            builder.operations[at].reads(|x| wanted[x.index()] = own);
        }
    }
    wanted
}

/// Marks of the gathered vectors that are only read by sums.
fn fused(builder: &Builder, needed: &[bool], outputs: &[Node]) -> Vec<bool> {
    let is_gather = |at: usize| matches!(builder.operations[at], Operation::Gather { .. });
    let mut fused: Vec<bool> = (0..needed.len()).map(|at| needed[at] && is_gather(at)).collect();
    for at in (0..needed.len()).filter(|at| needed[*at]) {
        if !matches!(builder.operations[at], Operation::Scatter { .. }) {
            builder.operations[at].reads(|x| fused[x.index()] = false);
        }
    }
    outputs.iter().for_each(|node| fused[node.index()] = false);
    fused
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operation::Layer;
    use crate::program::Program;
    use crate::step::Step;

    /// A layer that is applied to many equal columns is computed for only one of them.
    #[test]
    fn columns_that_are_alike_are_kept_once() {
        let mut builder = Builder::new();
        let [own, x] = [1, 80].map(|length| builder.input(length));
        let columns = builder.repeated(own, 40);
        let same = builder.linear(Layer::new(0, 1, 2), 40, columns);
        let sum = builder.sum(same, x);
        let program = Program::of_one_sample(&builder, &[vec![sum]]);
        assert!(program.steps.iter().any(|step| matches!(step, Step::Linear { columns: 1, .. })));
        let mut workspace = program.workspace();
        let numbers = |r: usize| Row(std::array::from_fn(|k| (WIDTH * r + k) as f64));
        let inputs: Vec<Row> = (0..5).map(numbers).collect();
        program.run_outputs(&[2.0, 3.0, 0.5, -0.5], &[&[Row::splat(7.0)], &inputs], &mut workspace);
        let form = program.form(0);
        for i in 0..80 {
            let (place, own) = (form.place(i), if i % 2 == 0 { 14.5 } else { 20.5 });
            assert_eq!(workspace.output(0)[place / WIDTH].0[place % WIDTH], own + i as f64);
        }
    }

    /// Coordinates that are squared and added up per node are arranged in columns of one node each, so that whole rows
    /// are added.
    #[test]
    fn sums_of_neighbours_want_them_in_columns() {
        let mut builder = Builder::new();
        let x = builder.input(60);
        let squares = builder.product(x, x);
        let sums = builder.scatter(squares, &(0..60).map(|i| i / 3).collect::<Vec<_>>(), 20);
        let layout = Layout::new(&builder, &[true; 3], &[sums]);
        assert_eq!([x, squares, sums].map(|node| layout.form(node).units), [3, 3, 1]);
    }

    /// A vector that is only read by sums is not gathered.
    #[test]
    fn sums_read_what_is_gathered_for_them() {
        let mut builder = Builder::new();
        let x = builder.input(3);
        let gathered = builder.gather(x, &[2, 0, 1, 1]);
        let sums = builder.scatter(gathered, &[0, 0, 1, 0], 2);
        let layout = |outputs: &[Node]| Layout::new(&builder, &[true; 3], outputs);
        assert!(layout(&[sums]).is_fused(gathered) && !layout(&[sums, gathered]).is_fused(gathered));
        let program = Program::of_one_sample(&builder, &[vec![sums]]);
        assert_eq!(program.steps(), 2);
        let (mut workspace, mut x) = (program.workspace(), Row::default());
        x.0[..3].copy_from_slice(&[1.0, 10.0, 100.0]);
        program.run_outputs(&[], &[&[x]], &mut workspace);
        assert_eq!(workspace.output(0)[0].0[..2], [111.0, 10.0]);
    }
}
