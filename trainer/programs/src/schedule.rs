//! From a list of operations to the steps of a program: what no result needs is left out, and what is read no more makes room.

use crate::builder::{Builder, Layer, Node, Operation};
use crate::function::ORDERS;
use crate::kernels::Pair;
use crate::program::{Program, Slot, Step};
use crate::reverse::WeightTerm;
use std::collections::HashMap;

/// Nodes of a gradient's terms for one layer.
type Pairs = Vec<Pair<Node>>;

/// Chooses steps and slots.
pub(crate) struct Scheduler<'b> {
    builder: &'b Builder,
    /// The nodes to compute, those first that outputs need, and the place of each in that order.
    order: Vec<Node>,
    ranks: Vec<usize>,
    /// Nodes that outputs need.
    first: usize,
    /// When each node is read last: a place in the order.
    last_read: Vec<usize>,
    places: Vec<Option<Slot>>,
    program: Program,
    /// Slots that are free again, by length.
    free: HashMap<usize, Vec<Slot>>,
    /// Terms of the same layer or numbers, by the place after which all is there.
    gradients: HashMap<usize, Vec<Gradient>>,
    /// The nodes that are read last at a place.
    ends: HashMap<usize, Vec<Node>>,
    /// The derivatives of one function at one vector: computed together.
    maps: HashMap<(u32, Node), [Option<Node>; ORDERS]>,
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
            inputs: 0,
            rows: rows.len(),
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
        }
    }

    pub fn schedule(mut self, outputs: &[Node], rows: &[Vec<WeightTerm>]) -> Program {
        let order = std::mem::take(&mut self.order);
        for (rank, node) in order.iter().enumerate() {
            let operation = &self.builder.operations[node.index()];
            operation.reads(|x| self.last_read[x.index()] = rank);
            if let Operation::Map { function, order, x } = operation {
                self.maps.entry((*function, *x)).or_default()[*order] = Some(*node);
            }
        }
        self.group(rows);
        outputs.iter().for_each(|node| self.last_read[node.index()] = usize::MAX);
        for node in &order {
            self.ends.entry(self.last_read[node.index()]).or_default().push(*node);
        }
        for rank in 0..=order.len() {
            if rank == self.first {
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
        self.program.outputs = outputs.iter().map(|node| self.place(*node)).collect();
        self.program
    }

    /// Terms of one row and one layer are added in one pass over its weights, as soon as all are there.
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

    /// As soon as all that it reads is there, and not before all outputs are.
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

    /// A slot for a node, of those that are free if there is one.
    fn reserve(&mut self, node: Node) -> Slot {
        let length = self.builder.length(node);
        let slot = self.free.get_mut(&length).and_then(Vec::pop).unwrap_or_else(|| {
            self.program.slots.push(length);
            self.program.slots.len() - 1
        });
        self.places[node.index()] = Some(slot);
        slot
    }

    fn release(&mut self, node: Node) {
        let constant = matches!(self.builder.operations[node.index()], Operation::Constant(_));
        if let Some(slot) = self.places[node.index()]
            && !constant
        {
            self.free.entry(self.builder.length(node)).or_default().push(slot);
        }
    }

    /// A slot of its own, that nothing else is written to.
    fn constant(&mut self, node: Node) {
        self.program.slots.push(self.builder.length(node));
        let slot = self.program.slots.len() - 1;
        self.places[node.index()] = Some(slot);
        self.program.constants.push((slot, self.builder.known(node).unwrap_or_default()));
    }

    fn step(&mut self, at: usize) {
        let node = Node::new(at);
        if self.places[at].is_some() {
            return;
        }
        let step = match self.builder.operations[at].clone() {
            Operation::Constant(_) => return self.constant(node),
            Operation::Input(number) => {
                self.program.inputs = self.program.inputs.max(number + 1);
                Step::Input { number, to: self.reserve(node) }
            }
            Operation::Parameters(start) => Step::Parameters { start, to: self.reserve(node) },
            Operation::Linear { layer, columns, bias, x } => {
                Step::Linear { layer, columns, bias, x: self.place(x), to: self.reserve(node) }
            }
            Operation::Transposed { layer, columns, y } => {
                Step::Transposed { layer, columns, y: self.place(y), to: self.reserve(node) }
            }
            Operation::Map { function, x, .. } => {
                let nodes = self.maps.get(&(function, x)).copied().unwrap_or_default();
                let to = nodes.map(|node| node.map(|node| self.reserve(node)));
                Step::Map { function: self.builder.functions[&function], x: self.place(x), to }
            }
            Operation::Product(x, y) => {
                Step::Product { x: self.place(x), y: self.place(y), to: self.reserve(node) }
            }
            Operation::Sum(x, y) => Step::Sum { x: self.place(x), y: self.place(y), to: self.reserve(node) },
            Operation::Scaled(c, x) => {
                Step::Scaled { c: f64::from_bits(c), x: self.place(x), to: self.reserve(node) }
            }
            Operation::Gather { x, index } => {
                Step::Gather { x: self.place(x), index, to: self.reserve(node) }
            }
            Operation::Scatter { x, index } => {
                Step::Scatter { x: self.place(x), index, to: self.reserve(node) }
            }
        };
        self.program.steps.push(step);
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
