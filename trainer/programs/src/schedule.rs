//! Conversion of a list of operations into the steps of a program. Operations that no result needs are left out, and
//! slots that are no longer read are reused.

mod forms;
mod fused;

use crate::builder::Builder;
use crate::function::ORDERS;
use crate::kernels::Pair;
use crate::layout::{Form, Layout};
use crate::operation::{Layer, Node, Operation};
use crate::program::Program;
use crate::reverse::WeightTerm;
use crate::row::Row;
use crate::step::{Slot, Step};
use std::collections::{HashMap, HashSet};

/// Nodes of a gradient's terms for one layer.
type Pairs = Vec<Pair<Node>>;

/// Choice of steps and slots.
pub(crate) struct Scheduler<'b> {
    builder: &'b Builder,
    /// Nodes to compute, starting with those that outputs need.
    order: Vec<Node>,
    /// Rank of each node in that order.
    ranks: Vec<usize>,
    /// Number of nodes that outputs need.
    first: usize,
    /// Rank in the order of the last node that reads each node.
    last_read: Vec<usize>,
    places: Vec<Option<Slot>>,
    program: Program,
    /// Free slots, by length.
    free: HashMap<usize, Vec<Slot>>,
    /// Terms of the gradients, each for one layer or one range of numbers, by the rank after which their operands are
    /// available.
    gradients: HashMap<usize, Vec<Gradient>>,
    /// Nodes that are last read at a rank.
    ends: HashMap<usize, Vec<Node>>,
    /// Derivatives of one function at one vector, which are computed together.
    maps: HashMap<(u32, Node), [Option<Node>; ORDERS]>,
    /// Arrangement of the numbers of a single sample; `None` if samples lie side by side.
    layout: Option<Layout>,
    /// Functions that only one product reads, keyed by that product; both are computed together.
    factors: HashMap<Node, Node>,
    is_factor: HashSet<Node>,
    /// Copies of nodes in other forms than their own.
    rearranged: HashMap<Node, Vec<(Form, Slot)>>,
}

enum Gradient {
    Outer { row: usize, layer: Layer, pairs: Pairs },
    Numbers { row: usize, start: usize, bar: Node },
}

impl<'b> Scheduler<'b> {
    pub fn new(builder: &'b Builder, outputs: &[Node], rows: &[Vec<WeightTerm>]) -> Self {
        let count = builder.operations.len();
        let mut results = outputs.to_vec();
        let early = builder.read_by(&results, count);
        rows.iter().flatten().for_each(|term| reads_of(term, |node| results.push(node)));
        let needed = builder.read_by(&results, count);
        let (first, rest): (Vec<usize>, Vec<usize>) =
            (0..count).filter(|at| needed[*at]).partition(|at| early[*at]);
        let order: Vec<Node> = first.iter().chain(&rest).map(|at| Node::new(*at)).collect();
        let mut ranks = vec![0; count];
        order.iter().enumerate().for_each(|(rank, node)| ranks[node.index()] = rank);
        let program = Program {
            steps: Vec::new(),
            first: 0,
            slots: Vec::new(),
            constants: Vec::new(),
            outputs: Vec::new(),
            forms: Vec::new(),
            inputs: 0,
            rows: rows.len(),
            numbers: None,
        };
        Self {
            builder,
            order,
            last_read: ranks.clone(),
            ranks,
            first: first.len(),
            places: vec![None; count],
            program,
            free: HashMap::new(),
            gradients: HashMap::new(),
            ends: HashMap::new(),
            maps: HashMap::new(),
            layout: None,
            factors: HashMap::new(),
            is_factor: HashSet::new(),
            rearranged: HashMap::new(),
        }
    }

    /// Prepares the program for a single sample, whose columns lie side by side.
    ///
    /// All results of a group have the arrangement of the first one.
    pub fn for_one_sample(mut self, groups: &[Vec<Node>]) -> Self {
        let mut needed = vec![false; self.ranks.len()];
        self.order.iter().for_each(|node| needed[node.index()] = true);
        let layout = Layout::new(self.builder, &needed, &groups.concat());
        for group in groups {
            let units = group.first().map_or(1, |node| layout.form(*node).units);
            self.program.forms.extend(group.iter().map(|_| Form::of_units(units)));
        }
        self.layout = Some(layout);
        self
    }

    pub fn schedule(mut self, outputs: &[Node], rows: &[Vec<WeightTerm>]) -> Program {
        let order = std::mem::take(&mut self.order);
        for node in &order {
            if let Operation::Map { function, order, x } = &self.builder.operations[node.index()] {
                self.maps.entry((*function, *x)).or_default()[*order] = Some(*node);
            }
        }
        self.find_factors(&order, outputs, rows);
        for (rank, node) in order.iter().enumerate() {
            self.reads(*node).into_iter().for_each(|x| self.last_read[x.index()] = rank);
        }
        self.group(rows);
        outputs.iter().for_each(|node| self.last_read[node.index()] = usize::MAX);
        for node in &order {
            self.ends.entry(self.last_read[node.index()]).or_default().push(*node);
        }
        for rank in 0..=order.len() {
            if rank == self.first {
                self.program.outputs = self.outputs(outputs);
                self.program.first = self.program.steps.len();
            }
            if let Some(node) = order.get(rank) {
                self.step(node.index());
            }
            for gradient in self.gradients.remove(&rank).unwrap_or_default() {
                self.gradient(&gradient);
            }
            for node in self.ends.remove(&rank).unwrap_or_default() {
                self.release(node);
            }
        }
        self.program
    }

    /// Combines the terms of one row and one layer into one pass over the layer's weights, as soon as all are
    /// available.
    fn group(&mut self, rows: &[Vec<WeightTerm>]) {
        for (row, terms) in rows.iter().enumerate() {
            let mut layers: Vec<(Layer, Pairs)> = Vec::new();
            for term in terms {
                match *term {
                    WeightTerm::Parameters { start, bar } => {
                        self.when_ready(&[bar], Gradient::Numbers { row, start, bar });
                    }
                    WeightTerm::Layer { layer, columns, y_bar, x, bias } => {
                        let pair = Pair { columns, y_bar, x, bias };
                        match layers.iter_mut().find(|(own, _)| *own == layer) {
                            Some((_, pairs)) => pairs.push(pair),
                            None => layers.push((layer, vec![pair])),
                        }
                    }
                }
            }
            for (layer, pairs) in layers {
                let nodes: Vec<Node> = pairs.iter().flat_map(|pair| [pair.y_bar, pair.x]).collect();
                self.when_ready(&nodes, Gradient::Outer { row, layer, pairs });
            }
        }
    }

    /// Schedules a gradient as soon as its operands are available, but not before all outputs are.
    fn when_ready(&mut self, reads: &[Node], gradient: Gradient) {
        let ready = reads.iter().map(|node| self.ranks[node.index()]).fold(self.first, usize::max);
        for node in reads {
            let last = &mut self.last_read[node.index()];
            *last = (*last).max(ready);
        }
        self.gradients.entry(ready).or_default().push(gradient);
    }

    fn place(&self, node: Node) -> Slot {
        self.places[node.index()].unwrap_or_else(|| panic!("node {node:?} is read before it is written"))
    }

    /// Number of rows that a node takes.
    fn rows(&self, node: Node) -> usize {
        let length = self.builder.length(node);
        self.layout.as_ref().map_or(length, |layout| layout.form(node).rows(length))
    }

    /// Returns a slot of `rows` rows, a free one if possible.
    fn slot(&mut self, rows: usize) -> Slot {
        self.free.get_mut(&rows).and_then(Vec::pop).unwrap_or_else(|| {
            self.program.slots.push(rows);
            self.program.slots.len() - 1
        })
    }

    fn reserve(&mut self, node: Node) -> Slot {
        let slot = self.slot(self.rows(node));
        self.places[node.index()] = Some(slot);
        slot
    }

    fn release(&mut self, node: Node) {
        if matches!(self.builder.operations[node.index()], Operation::Constant(_)) {
            return;
        }
        let rearranged = self.rearranged.remove(&node).unwrap_or_default();
        for slot in self.places[node.index()].into_iter().chain(rearranged.into_iter().map(|(_, slot)| slot))
        {
            self.free.entry(self.program.slots[slot]).or_default().push(slot);
        }
    }

    /// Returns a slot for a constant; nothing else is ever written to it.
    fn constant(&mut self, rows: Vec<Row>) -> Slot {
        self.program.slots.push(rows.len());
        let slot = self.program.slots.len() - 1;
        self.program.constants.push((slot, rows));
        slot
    }

    /// Schedules the computation of a node, unless another step computes it.
    fn step(&mut self, at: usize) {
        let node = Node::new(at);
        if self.places[at].is_some() {
            return;
        }
        let step = match self.builder.operations[at].clone() {
            Operation::Constant(_) => return self.known(node),
            Operation::Input(number) => self.input(node, number),
            Operation::Parameters(start) => self.parameters(node, start),
            Operation::Linear { layer, columns, bias, x } => {
                let columns = self.columns(columns, x, layer.inputs.max(1));
                let x = self.in_columns(x, layer.inputs.max(1));
                Step::Linear { layer, columns, bias, x, to: self.reserve(node) }
            }
            Operation::Transposed { layer, columns, y } => {
                let columns = self.columns(columns, y, layer.outputs.max(1));
                let y = self.in_columns(y, layer.outputs.max(1));
                Step::Transposed { layer, columns, y, to: self.reserve(node) }
            }
            Operation::Map { .. } if self.is_factor.contains(&node) => return,
            Operation::Map { function, x, .. } => {
                let nodes = self.maps.get(&(function, x)).copied().unwrap_or_default();
                let to = nodes.map(|node| node.map(|node| self.reserve(node)));
                Step::Map { function: self.builder.functions[&function], x: self.place(x), to }
            }
            Operation::Product(x, y) => self.product(node, [x, y]),
            Operation::Sum(x, y) => {
                let [x, y] = self.alike(node, [x, y]);
                Step::Sum { x, y, to: self.reserve(node) }
            }
            Operation::Scaled(c, x) => {
                Step::Scaled { c: f64::from_bits(c), x: self.place(x), to: self.reserve(node) }
            }
            Operation::Gather { x, .. } if self.summands(node).0 == x => return,
            Operation::Gather { x, index } => self.gather(node, x, index),
            Operation::Scatter { x, index } => self.scatter(node, x, index),
        };
        self.program.steps.push(step);
    }

    /// Stores a constant in a slot.
    fn known(&mut self, node: Node) {
        let known = self.builder.known(node).unwrap_or_default();
        let rows = match &self.layout {
            None => known.into_iter().map(Row::splat).collect(),
            Some(layout) => layout.form(node).constant(&known),
        };
        self.places[node.index()] = Some(self.constant(rows));
    }

    fn input(&mut self, node: Node, number: usize) -> Step {
        self.program.inputs = self.program.inputs.max(number + 1);
        let (to, given, form) = (self.reserve(node), Form::of_units(1), self.form(node));
        if form == given {
            return Step::Input { number, to };
        }
        Step::PickInput { number, picks: form.picks(self.builder.length(node), (given, |i| i)), to }
    }

    fn parameters(&mut self, node: Node, start: usize) -> Step {
        let (range, to) = (start..start + self.builder.length(node), self.reserve(node));
        match self.layout {
            None => Step::Parameters { start, to },
            Some(_) => Step::PackedParameters { range, to },
        }
    }

    fn product(&mut self, node: Node, factors: [Node; 2]) -> Step {
        let Some((function, order, x, y)) = self.factor(node) else {
            let [x, y] = self.alike(node, factors);
            return Step::Product { x, y, to: self.reserve(node) };
        };
        let [x, y] = self.alike(node, [x, y]);
        Step::MapProduct { function, order, x, y, to: self.reserve(node) }
    }

    fn gather(&mut self, node: Node, x: Node, index: Box<[u32]>) -> Step {
        let (from, to) = (self.place(x), self.reserve(node));
        match &self.layout {
            None => Step::Gather { x: from, index, to },
            Some(layout) => Step::Pick { x: from, picks: layout.picked(node, x, &index), to },
        }
    }

    fn scatter(&mut self, node: Node, x: Node, index: Box<[u32]>) -> Step {
        let (x, from) = self.summands(x);
        let (slot, to, length) = (self.place(x), self.reserve(node), self.builder.length(node));
        match &self.layout {
            None => Step::Scatter { x: slot, index, to },
            Some(layout) => {
                let place = |i: usize| from.map_or(i, |from| from[i] as usize);
                Step::PickSums { x: slot, sums: layout.summed([node, x], length, &index, place), to }
            }
        }
    }

    fn gradient(&mut self, gradient: &Gradient) {
        let step = match gradient {
            Gradient::Outer { row, layer, pairs } => {
                let slots = pairs.iter().map(|pair| pair.map(|node| self.place(node)));
                Step::Outer { row: *row, layer: *layer, pairs: slots.collect() }
            }
            Gradient::Numbers { row, start, bar } => {
                Step::Numbers { row: *row, start: *start, bar: self.place(*bar) }
            }
        };
        self.program.steps.push(step);
    }
}

fn reads_of(term: &WeightTerm, mut visit: impl FnMut(Node)) {
    match *term {
        WeightTerm::Layer { y_bar, x, .. } => {
            visit(y_bar);
            visit(x);
        }
        WeightTerm::Parameters { bar, .. } => visit(bar),
    }
}
