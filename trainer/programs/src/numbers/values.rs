//! Values of a program's numbers, each stored once.

use crate::function::{Function, ORDERS};
use crate::operation::Layer;
use crate::program::Program;
use crate::row::Row;
use crate::step::Step;
use std::collections::HashMap;

/// Number of a value.
pub(super) type Id = u32;

/// Definition of a number of every sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Value {
    /// A constant, as its bits.
    Constant(u64),
    Input(u32, u32),
    Parameter(u32),
    Sum(Id, Id),
    Difference(Id, Id),
    Product(Id, Id),
    /// Computes xy + z.
    ProductSum(Id, Id, Id),
    /// A derivative of the function with this number.
    Curve {
        function: u32,
        order: u8,
        x: Id,
    },
}

/// Values in an order in which each follows its operands.
#[derive(Clone, Debug, Default)]
pub(super) struct Values {
    all: Vec<Value>,
    known: HashMap<Value, Id>,
    /// Whether layers are taken apart.
    with_layers: bool,
    functions: HashMap<u32, Function>,
}

/// Results of a program: the values of its outputs, and its additions to rows of the Jacobian, each as row, position
/// and value.
#[derive(Clone, Debug, Default)]
pub(super) struct Results {
    pub outputs: Vec<Vec<Id>>,
    pub rows: Vec<(u32, u32, Id)>,
}

impl Values {
    /// Converts a program; `None` if it has steps that cannot be split into single numbers.
    pub fn of(program: &Program, with_layers: bool) -> Option<(Self, Results)> {
        let (mut values, mut results) = (Self { with_layers, ..Self::default() }, Results::default());
        let mut slots: Vec<Vec<Id>> = program.slots.iter().map(|length| vec![0; *length]).collect();
        for (slot, rows) in &program.constants {
            slots[*slot] = rows.iter().map(|row| values.constant(row.0[0])).collect();
        }
        let outputs = |slots: &[Vec<Id>]| program.outputs.iter().map(|slot| slots[*slot].clone()).collect();
        for (at, step) in program.steps.iter().enumerate() {
            if at == program.first {
                results.outputs = outputs(&slots);
            }
            values.step(step, &mut slots, &mut results)?;
        }
        if program.first == program.steps.len() {
            results.outputs = outputs(&slots);
        }
        values.fuse(&results);
        Some((values, results))
    }

    /// Merges each sum with a product that only this sum reads into one operation.
    fn fuse(&mut self, results: &Results) {
        let mut reads = vec![0; self.len()];
        let wanted = results.outputs.iter().flatten().chain(results.rows.iter().map(|(_, _, x)| x));
        wanted.for_each(|x| reads[*x as usize] += 1);
        for id in (0..self.len()).rev() {
            if reads[id] > 0 {
                self.reads(id as Id).for_each(|x| reads[x as usize] += 1);
            }
        }
        for id in 0..self.len() {
            let Value::Sum(x, y) = self.all[id] else { continue };
            let product = |x: Id| match self.get(x) {
                Value::Product(a, b) if reads[x as usize] == 1 => Some([a, b]),
                _ => None,
            };
            let fused = product(x).map(|of| (of, y)).or_else(|| product(y).map(|of| (of, x)));
            if let Some(([a, b], z)) = fused {
                self.all[id] = Value::ProductSum(a, b, z);
            }
        }
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }

    pub fn get(&self, id: Id) -> Value {
        self.all[id as usize]
    }

    pub fn is_constant(&self, id: Id) -> bool {
        matches!(self.get(id), Value::Constant(_))
    }

    /// Operands of a value.
    pub fn reads(&self, id: Id) -> impl Iterator<Item = Id> + use<> {
        let of = match self.get(id) {
            Value::Constant(_) | Value::Input(..) | Value::Parameter(_) => [None; 3],
            Value::Sum(x, y) | Value::Difference(x, y) | Value::Product(x, y) => [Some(x), Some(y), None],
            Value::ProductSum(x, y, z) => [Some(x), Some(y), Some(z)],
            Value::Curve { x, .. } => [Some(x), None, None],
        };
        of.into_iter().flatten()
    }

    /// Returns a derivative of a function, if it is already stored.
    pub fn curve(&self, function: u32, order: u8, x: Id) -> Option<Id> {
        self.known.get(&Value::Curve { function, order, x }).copied()
    }

    pub fn function(&self, number: u32) -> Function {
        self.functions[&number]
    }

    /// Writes the values of a step; `None` for a step on layers (unless they may be split) or on a single sample.
    fn step(&mut self, step: &Step, slots: &mut [Vec<Id>], results: &mut Results) -> Option<()> {
        match step {
            Step::Input { number, to } => {
                let value = |at: usize| Value::Input(*number as u32, at as u32);
                slots[*to] = (0..slots[*to].len()).map(|at| self.value(value(at))).collect();
            }
            Step::Parameters { start, to } => {
                let value = |at: usize| Value::Parameter((start + at) as u32);
                slots[*to] = (0..slots[*to].len()).map(|at| self.value(value(at))).collect();
            }
            Step::Map { function, x, to } => {
                let x = slots[*x].clone();
                for (order, to) in to.iter().enumerate() {
                    let Some(to) = to else { continue };
                    slots[*to] = x.iter().map(|x| self.derivative(*function, order, *x)).collect();
                }
            }
            Step::MapProduct { function, order, x, y, to } => {
                let curve: Vec<Id> =
                    slots[*x].iter().map(|x| self.derivative(*function, *order, *x)).collect();
                let y = slots[*y].iter().cycle();
                slots[*to] = curve.iter().zip(y).map(|(x, y)| self.product(*x, *y)).collect();
            }
            Step::Product { x, y, to } => slots[*to] = self.pairwise(slots, [*x, *y, *to], Self::product),
            Step::Sum { x, y, to } => slots[*to] = self.pairwise(slots, [*x, *y, *to], Self::sum),
            Step::Scaled { c, x, to } => {
                let c = self.constant(*c);
                slots[*to] = slots[*x].iter().map(|x| self.product(c, *x)).collect();
            }
            Step::Gather { x, index, to } => {
                slots[*to] = index.iter().map(|i| slots[*x][*i as usize]).collect();
            }
            Step::Scatter { x, index, to } => {
                let mut sums = vec![self.constant(0.0); slots[*to].len()];
                for (x, i) in slots[*x].iter().zip(index) {
                    sums[*i as usize] = self.sum(sums[*i as usize], *x);
                }
                slots[*to] = sums;
            }
            Step::Numbers { row, start, bar } => {
                let adds = slots[*bar].iter().enumerate();
                let adds = adds.filter(|(_, x)| self.get(**x) != Value::Constant(0));
                results.rows.extend(adds.map(|(k, x)| (*row as u32, (start + k) as u32, *x)));
            }
            _ if self.with_layers => self.layer(step, slots, results)?,
            _ => return None,
        }
        Some(())
    }

    /// Writes the values of a step on a layer; `None` for a step on a single sample.
    fn layer(&mut self, step: &Step, slots: &mut [Vec<Id>], results: &mut Results) -> Option<()> {
        match step {
            Step::Linear { layer, bias, x, to, .. } => {
                let columns = slots[*x].chunks(layer.inputs.max(1)).map(<[Id]>::to_vec);
                slots[*to] = columns.flat_map(|x| self.applied(layer, *bias, &x)).collect();
            }
            Step::Transposed { layer, y, to, .. } => {
                let columns = slots[*y].chunks(layer.outputs.max(1)).map(<[Id]>::to_vec);
                slots[*to] = columns.flat_map(|y| self.applied_transposed(layer, &y)).collect();
            }
            Step::Outer { row, layer, pairs } => {
                for pair in pairs {
                    let (y, x) = (slots[pair.y_bar].clone(), slots[pair.x].clone());
                    let columns = y.chunks(layer.outputs.max(1)).zip(x.chunks(layer.inputs.max(1)));
                    for (y, x) in columns.take(pair.columns) {
                        self.outer((*row, layer, pair.bias), [y, x], results);
                    }
                }
            }
            _ => return None,
        }
        Some(())
    }

    fn weight(&mut self, layer: &Layer, i: usize, j: usize) -> Id {
        self.value(Value::Parameter(layer.weight(i, j) as u32))
    }

    /// Returns Wx, plus b if there is a bias.
    fn applied(&mut self, layer: &Layer, bias: bool, x: &[Id]) -> Vec<Id> {
        let output = |values: &mut Self, i: usize| {
            let start = match bias {
                true => values.value(Value::Parameter((layer.biases() + i) as u32)),
                false => values.constant(0.0),
            };
            x.iter().enumerate().fold(start, |sum, (j, x)| {
                let weight = values.weight(layer, i, j);
                let product = values.product(weight, *x);
                values.sum(sum, product)
            })
        };
        (0..layer.outputs).map(|i| output(self, i)).collect()
    }

    /// Returns Wᵀy.
    fn applied_transposed(&mut self, layer: &Layer, y: &[Id]) -> Vec<Id> {
        let input = |values: &mut Self, j: usize| {
            let start = values.constant(0.0);
            y.iter().enumerate().fold(start, |sum, (i, y)| {
                let weight = values.weight(layer, i, j);
                let product = values.product(weight, *y);
                values.sum(sum, product)
            })
        };
        (0..layer.inputs).map(|j| input(self, j)).collect()
    }

    /// Adds ȳxᵀ to a row, and ȳ for the biases if `bias` is set.
    fn outer(
        &mut self,
        (row, layer, bias): (usize, &Layer, bool),
        [y, x]: [&[Id]; 2],
        results: &mut Results,
    ) {
        let is_there = |values: &Self, x: Id| values.get(x) != Value::Constant(0);
        for (i, y) in y.iter().enumerate() {
            for (j, x) in x.iter().enumerate() {
                let product = self.product(*y, *x);
                if is_there(self, product) {
                    results.rows.push((row as u32, layer.weight(i, j) as u32, product));
                }
            }
            if bias && is_there(self, *y) {
                results.rows.push((row as u32, (layer.biases() + i) as u32, *y));
            }
        }
    }

    /// Applies `f` to two slots entry by entry; the shorter slot is repeated.
    fn pairwise(
        &mut self,
        slots: &[Vec<Id>],
        [x, y, to]: [usize; 3],
        f: fn(&mut Self, Id, Id) -> Id,
    ) -> Vec<Id> {
        let both = slots[x].iter().cycle().zip(slots[y].iter().cycle());
        both.take(slots[to].len()).map(|(x, y)| f(self, *x, *y)).collect()
    }

    fn value(&mut self, value: Value) -> Id {
        *self.known.entry(value).or_insert_with(|| {
            self.all.push(value);
            (self.all.len() - 1) as Id
        })
    }

    fn constant(&mut self, c: f64) -> Id {
        // Adding 0 turns −0 into 0: sums and products with either are equal numbers.
        self.value(Value::Constant((c + 0.0).to_bits()))
    }

    fn known(&self, id: Id) -> Option<f64> {
        match self.get(id) {
            Value::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Returns the number of which this number is the negative, if it is stored as a negative.
    fn negated(&self, id: Id) -> Option<Id> {
        match self.get(id) {
            Value::Product(x, y) if self.known(x) == Some(-1.0) => Some(y),
            Value::Product(x, y) if self.known(y) == Some(-1.0) => Some(x),
            _ => None,
        }
    }

    fn sum(&mut self, x: Id, y: Id) -> Id {
        match (self.known(x), self.known(y)) {
            (Some(a), Some(b)) => return self.constant(a + b),
            (Some(0.0), _) => return y,
            (_, Some(0.0)) => return x,
            _ => {}
        }
        match (self.negated(x), self.negated(y)) {
            (_, Some(y)) => self.value(Value::Difference(x, y)),
            (Some(x), None) => self.value(Value::Difference(y, x)),
            (None, None) => self.value(Value::Sum(x.min(y), x.max(y))),
        }
    }

    fn product(&mut self, x: Id, y: Id) -> Id {
        match (self.known(x), self.known(y)) {
            (Some(a), Some(b)) => return self.constant(a * b),
            (Some(0.0), _) | (_, Some(0.0)) => return self.constant(0.0),
            (Some(1.0), _) => return y,
            (_, Some(1.0)) => return x,
            (Some(-1.0), _) => {
                if let Some(own) = self.negated(y) {
                    return own;
                }
            }
            (_, Some(-1.0)) => {
                if let Some(own) = self.negated(x) {
                    return own;
                }
            }
            _ => {}
        }
        self.value(Value::Product(x.min(y), x.max(y)))
    }

    /// Returns a derivative of a function of a number.
    fn derivative(&mut self, function: Function, order: usize, x: Id) -> Id {
        if let Some(known) = self.known(x) {
            let curve = function.curve(&Row::splat(known), [true; ORDERS]);
            return self.constant(curve[order].0[0]);
        }
        self.functions.insert(function.number(), function);
        self.value(Value::Curve { function: function.number(), order: order as u8, x })
    }
}
