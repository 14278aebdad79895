//! What is left of a list of operations when what no result needs is gone, in an order to be run in.

use crate::builder::{Builder, Layer, Node};
use crate::function::{Function, ORDERS};
use crate::kernels::{self, Pair};
use crate::layout::Form;
use crate::numbers::Numbers;
use crate::picks::{PickSums, Picks};
use crate::reverse::WeightTerm;
use crate::row::Row;
use crate::schedule::Scheduler;
use std::ops::Range;
use wide::f64x8;

/// A vector's place in a workspace.
pub(crate) type Slot = usize;

/// One thing to do.
#[derive(Clone, Debug)]
pub(crate) enum Step {
    Input {
        number: usize,
        to: Slot,
    },
    Parameters {
        start: usize,
        to: Slot,
    },
    Linear {
        layer: Layer,
        columns: usize,
        bias: bool,
        x: Slot,
        to: Slot,
    },
    Transposed {
        layer: Layer,
        columns: usize,
        y: Slot,
        to: Slot,
    },
    Map {
        function: Function,
        x: Slot,
        to: [Option<Slot>; ORDERS],
    },
    /// The derivative of this order of a function, times another vector.
    MapProduct {
        function: Function,
        order: usize,
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Product {
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Sum {
        x: Slot,
        y: Slot,
        to: Slot,
    },
    Scaled {
        c: f64,
        x: Slot,
        to: Slot,
    },
    Gather {
        x: Slot,
        index: Box<[u32]>,
        to: Slot,
    },
    Scatter {
        x: Slot,
        index: Box<[u32]>,
        to: Slot,
    },
    /// Rows read from here and there.
    Pick {
        x: Slot,
        picks: Picks,
        to: Slot,
    },
    /// The same of an input.
    PickInput {
        number: usize,
        picks: Picks,
        to: Slot,
    },
    /// Sums of such rows.
    PickSums {
        x: Slot,
        sums: PickSums,
        to: Slot,
    },
    /// Parameters one after the other.
    PackedParameters {
        range: Range<usize>,
        to: Slot,
    },
    /// Adds to a row of the Jacobian.
    Outer {
        row: usize,
        layer: Layer,
        pairs: Vec<Pair<Slot>>,
    },
    Numbers {
        row: usize,
        start: usize,
        bar: Slot,
    },
}

/// Something to evaluate: vectors, and gradients in the weights, each a row of a Jacobian.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) steps: Vec<Step>,
    /// Steps that the vectors need; the gradients need the others too.
    pub(crate) first: usize,
    /// The length of every slot, and the constants that some hold from the start.
    pub(crate) slots: Vec<usize>,
    pub(crate) constants: Vec<(Slot, Vec<Row>)>,
    pub(crate) outputs: Vec<Slot>,
    pub(crate) forms: Vec<Form>,
    pub(crate) inputs: usize,
    pub(crate) rows: usize,
    /// The same number by number, where that is faster.
    pub(crate) numbers: Option<Numbers>,
}

/// The numbers of a program while it runs.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    slots: Vec<Vec<Row>>,
    registers: Vec<Row>,
    outputs: Vec<Slot>,
}

impl Workspace {
    /// A result of the last run.
    pub fn output(&self, number: usize) -> &[Row] {
        &self.slots[self.outputs[number]]
    }
}

impl Program {
    /// The program for these vectors and these gradients in the weights, each a sum of terms.
    pub fn new(builder: &Builder, outputs: &[Node], rows: &[Vec<WeightTerm>]) -> Self {
        let mut program = Scheduler::new(builder, outputs, rows).schedule(outputs, rows);
        program.numbers = Numbers::of(&program, builder.is_of_short_vectors);
        program
    }

    /// The program for these vectors of one sample: inputs and outputs are numbers one after the other in rows, and what lies side
    /// by side are the columns that layers are applied to. Many nodes or edges of one graph take the time of as many samples of a
    /// small system.
    ///
    /// The outputs of a group, vectors of one length, all lie in rows as [`Program::form`] says.
    pub(crate) fn of_one_sample(builder: &Builder, groups: &[Vec<Node>]) -> Self {
        let outputs = groups.concat();
        Scheduler::new(builder, &outputs, &[]).for_one_sample(groups).schedule(&outputs, &[])
    }

    /// How an output lies in rows.
    pub(crate) fn form(&self, output: usize) -> Form {
        self.forms[output]
    }

    /// Numbers that a workspace keeps of every sample.
    pub fn workspace_len(&self) -> usize {
        self.slots.iter().sum()
    }

    /// Operations that a run takes.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// Gradients in the weights.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// A workspace for it.
    pub fn workspace(&self) -> Workspace {
        let mut slots: Vec<Vec<Row>> =
            self.slots.iter().map(|length| vec![Row::default(); *length]).collect();
        for (slot, constant) in &self.constants {
            slots[*slot].copy_from_slice(constant);
        }
        let registers = self.numbers.as_ref().map_or(Vec::new(), Numbers::registers);
        Workspace { slots, registers, outputs: self.outputs.clone() }
    }

    /// The program beside a workspace for it.
    pub(crate) fn with_workspace(self) -> (Self, Workspace) {
        let workspace = self.workspace();
        (self, workspace)
    }

    /// Evaluates the vectors at these weights and inputs, and adds to `rows` the gradients in the weights, as many numbers each as the
    /// weight block has.
    ///
    /// # Panics
    /// Where inputs, rows or workspace are not those of the program.
    pub fn run(&self, weights: &[f64], inputs: &[&[Row]], workspace: &mut Workspace, rows: &mut [Vec<Row>]) {
        self.run_outputs(weights, inputs, workspace);
        self.run_rows(weights, inputs, workspace, rows);
    }

    /// Evaluates the vectors alone; inputs that none of them needs may be missing.
    ///
    /// # Panics
    /// As [`Program::run`].
    pub fn run_outputs(&self, weights: &[f64], inputs: &[&[Row]], workspace: &mut Workspace) {
        if let Some(numbers) = &self.numbers {
            let Workspace { slots, registers, outputs } = workspace;
            return numbers.run_outputs(weights, inputs, registers, |output, k, row| {
                slots[outputs[output]][k] = row;
            });
        }
        for step in &self.steps[..self.first] {
            step.run(weights, inputs, &mut workspace.slots, &mut []);
        }
    }

    /// Adds the gradients after [`Program::run_outputs`] with the same weights, workspace and inputs, but for those that were missing.
    ///
    /// # Panics
    /// As [`Program::run`].
    pub fn run_rows(
        &self,
        weights: &[f64],
        inputs: &[&[Row]],
        workspace: &mut Workspace,
        rows: &mut [Vec<Row>],
    ) {
        assert!(inputs.len() >= self.inputs && rows.len() >= self.rows, "inputs or rows are missing");
        if let Some(numbers) = &self.numbers {
            return numbers.run_rows(weights, inputs, &mut workspace.registers, rows);
        }
        for step in &self.steps[self.first..] {
            step.run(weights, inputs, &mut workspace.slots, rows);
        }
    }
}

impl Step {
    fn run(&self, weights: &[f64], inputs: &[&[Row]], slots: &mut [Vec<Row>], rows: &mut [Vec<Row>]) {
        match self {
            Self::Input { number, to } => slots[*to].copy_from_slice(inputs[*number]),
            Self::Parameters { start, to } => {
                slots[*to].iter_mut().zip(&weights[*start..]).for_each(|(to, w)| *to = Row::splat(*w));
            }
            Self::Linear { layer, columns, bias, x, to } => write(slots, *to, |slots, to| {
                kernels::linear(layer, *columns, (weights, *bias), &slots[*x], to);
            }),
            Self::Transposed { layer, columns, y, to } => write(slots, *to, |slots, to| {
                kernels::transposed(layer, *columns, weights, &slots[*y], to);
            }),
            Self::Map { function, x, to } => map(*function, *x, *to, slots),
            Self::MapProduct { function, order, x, y, to } => write(slots, *to, |slots, to| {
                map_product((*function, *order), &slots[*x], &slots[*y], to);
            }),
            Self::Product { x, y, to } => pairwise(slots, [*x, *y, *to], |x, y| x * y),
            Self::Sum { x, y, to } => pairwise(slots, [*x, *y, *to], |x, y| x + y),
            Self::Scaled { c, x, to } => {
                let c = f64x8::splat(*c);
                pairwise(slots, [*x, *x, *to], |x, _| c * x);
            }
            Self::Gather { x, index, to } => write(slots, *to, |slots, to| {
                let x = &slots[*x];
                to.iter_mut().zip(index).for_each(|(to, i)| *to = x[*i as usize]);
            }),
            Self::Scatter { x, index, to } => write(slots, *to, |slots, to| {
                to.fill(Row::default());
                slots[*x].iter().zip(index).for_each(|(x, i)| to[*i as usize].add_scaled(1.0, x));
            }),
            Self::Pick { x, picks, to } => write(slots, *to, |slots, to| picks.write(&slots[*x], to)),
            Self::PickInput { number, picks, to } => picks.write(inputs[*number], &mut slots[*to]),
            Self::PickSums { x, sums, to } => write(slots, *to, |slots, to| sums.write(&slots[*x], to)),
            Self::PackedParameters { range, to } => {
                let places = slots[*to].iter_mut().flat_map(|row| &mut row.0);
                places.zip(&weights[range.clone()]).for_each(|(to, w)| *to = *w);
            }
            Self::Outer { row, layer, pairs } => {
                let pairs: Vec<_> = pairs.iter().map(|pair| pair.map(|slot| &slots[slot][..])).collect();
                kernels::outer(layer, &pairs, &mut rows[*row]);
            }
            Self::Numbers { row, start, bar } => {
                let places = &mut rows[*row][*start..];
                places.iter_mut().zip(&slots[*bar]).for_each(|(sum, bar)| sum.add_scaled(1.0, bar));
            }
        }
    }
}

/// Writes a slot from others.
fn write(slots: &mut [Vec<Row>], to: Slot, compute: impl FnOnce(&[Vec<Row>], &mut [Row])) {
    let mut place = std::mem::take(&mut slots[to]);
    compute(slots, &mut place);
    slots[to] = place;
}

/// Of two vectors number by number; where one of them is shorter it is repeated.
fn pairwise(slots: &mut [Vec<Row>], [x, y, to]: [Slot; 3], f: impl Fn(f64x8, f64x8) -> f64x8) {
    write(slots, to, |slots, to| {
        let (x, y) = (&slots[x], &slots[y]);
        let (of_x, of_y) = (x.len() < to.len(), y.len() < to.len());
        let part = if of_x { x.len() } else { y.len() };
        for (k, to) in to.chunks_mut(part.max(1)).enumerate() {
            let [x, y] = [(x, of_x), (y, of_y)].map(|(x, repeated)| {
                let start = if repeated { 0 } else { k * part };
                &x[start..start + to.len()]
            });
            for ((to, x), y) in to.iter_mut().zip(x).zip(y) {
                let (x, y) = (x.load(), y.load());
                *to = Row::store(std::array::from_fn(|g| f(x[g], y[g])));
            }
        }
    });
}

/// Rows of a function that are multiplied while they are in the cache.
const MAPPED: usize = 32;

/// f⁽ᵒʳᵈᵉʳ⁾(x)y; where y is shorter it is repeated.
fn map_product((function, order): (Function, usize), x: &[Row], y: &[Row], to: &mut [Row]) {
    let repeated = y.len() < to.len();
    let part = if repeated { y.len() * (MAPPED / y.len()).max(1) } else { MAPPED };
    for ((k, to), x) in to.chunks_mut(part).enumerate().zip(x.chunks(part)) {
        let mut places = [const { None }; ORDERS];
        places[order] = Some(&mut *to);
        function.write(x, places);
        let y = if repeated { y } else { &y[k * part..][..to.len()] };
        for to in to.chunks_mut(y.len()) {
            to.iter_mut().zip(y).for_each(|(to, y)| *to = to.product(y));
        }
    }
}

fn map(function: Function, x: Slot, to: [Option<Slot>; ORDERS], slots: &mut [Vec<Row>]) {
    let mut places = to.map(|to| to.map(|to| std::mem::take(&mut slots[to])));
    function.write(&slots[x], places.each_mut().map(|place| place.as_deref_mut()));
    for (to, place) in to.into_iter().zip(places) {
        if let (Some(to), Some(place)) = (to, place) {
            slots[to] = place;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::network::Activation;

    /// A function that only a product needs takes no pass of its own, and other readers still get it.
    #[test]
    fn functions_are_multiplied_where_they_are_computed() {
        let mut builder = Builder::new();
        let [x, y] = [(); 2].map(|()| builder.input(40));
        let function = builder.map(Function::Activation(Activation::Squareplus), x);
        let product = builder.product(function, y);
        let rows = [0.1, -1.0].map(|c| (0..40).map(|i| Row::splat(c * f64::from(i))).collect::<Vec<_>>());
        let results = [vec![product], vec![product, function]].map(|outputs| {
            let (program, mut workspace) = Program::new(&builder, &outputs, &[]).with_workspace();
            program.run_outputs(&[], &rows.each_ref().map(Vec::as_slice), &mut workspace);
            (program.steps(), workspace.output(0).to_vec())
        });
        assert_eq!((results[0].0, results[1].0), (3, 4));
        assert_eq!(results[0].1, results[1].1);
    }
}
