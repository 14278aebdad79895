use crate::function::Function;
use crate::operation::{Layer, Node, Operation};
use crate::single::Variables;
use std::collections::HashMap;
use std::ops::Range;

/// A list of operations on vectors. Each operation is stored once: a repeated request finds the stored one. Values that
/// are known when the list is written (sums and products of constants, factors of 0 and 1) are not computed by the
/// program.
///
/// # Panics
/// All methods panic if lengths do not fit. This means that the family that writes such a list is wrong, whatever the
/// data.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    pub(crate) operations: Vec<Operation>,
    pub(crate) lengths: Vec<usize>,
    pub(crate) functions: HashMap<u32, Function>,
    /// Variables that each node depends on, besides constants and weights.
    pub(crate) variables: Vec<Variables>,
    /// Derivatives of nodes that depend on a single variable; `None` if the derivative is 0.
    pub(crate) slopes: HashMap<Node, Option<Node>>,
    known: HashMap<(Operation, usize), Node>,
    inputs: usize,
    /// Whether most vectors have two or three numbers, so that small layers are best applied entry by entry, too.
    pub(crate) is_of_short_vectors: bool,
}

impl Builder {
    /// Creates an empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Declares that most vectors have two or three numbers: small layers of networks are then applied entry by entry too.
    pub(crate) fn of_short_vectors(&mut self) {
        self.is_of_short_vectors = true;
    }

    /// Length of a vector.
    pub fn length(&self, x: Node) -> usize {
        self.lengths[x.index()]
    }

    pub(crate) fn push(&mut self, operation: Operation, length: usize) -> Node {
        let next = Node::new(self.operations.len());
        let node = *self.known.entry((operation.clone(), length)).or_insert(next);
        if node == next {
            self.variables.push(self.variables_of(&operation, length, next));
            self.operations.push(operation);
            self.lengths.push(length);
        }
        node
    }

    /// Adds the caller's next vector.
    pub fn input(&mut self, length: usize) -> Node {
        self.inputs += 1;
        self.push(Operation::Input(self.inputs - 1), length)
    }

    /// Adds a vector that is equal in every sample.
    pub fn constant(&mut self, x: &[f64]) -> Node {
        // Adding 0 turns −0 into 0, so that products with it vanish.
        let bits = x.iter().map(|x| (x + 0.0).to_bits()).collect();
        self.push(Operation::Constant(bits), x.len())
    }

    /// Adds the zero vector.
    pub fn zeros(&mut self, length: usize) -> Node {
        self.constant(&vec![0.0; length])
    }

    /// Adds the vector of these numbers of the weight block.
    pub fn parameters(&mut self, start: usize, length: usize) -> Node {
        self.push(Operation::Parameters(start), length)
    }

    /// Entries of a constant; `None` for any other node.
    pub(crate) fn known(&self, x: Node) -> Option<Vec<f64>> {
        match &self.operations[x.index()] {
            Operation::Constant(bits) => Some(bits.iter().map(|bits| f64::from_bits(*bits)).collect()),
            _ => None,
        }
    }

    /// Whether the node is a constant with this number in every entry.
    pub(crate) fn is_all(&self, x: Node, number: f64) -> bool {
        match &self.operations[x.index()] {
            Operation::Constant(bits) => bits.iter().all(|bits| f64::from_bits(*bits) == number),
            _ => false,
        }
    }

    /// Returns Wx + b for `columns` inputs x, one after the other; the outputs have the same order.
    pub fn linear(&mut self, layer: Layer, columns: usize, x: Node) -> Node {
        self.product_of(layer, columns, x, true)
    }

    /// Returns Wx for every column, plus b if there is a bias.
    pub(crate) fn product_of(&mut self, layer: Layer, columns: usize, x: Node, bias: bool) -> Node {
        assert_eq!(self.length(x), columns * layer.inputs, "inputs of a layer");
        let outputs = columns * layer.outputs;
        if !bias && self.is_all(x, 0.0) {
            return self.zeros(outputs);
        }
        self.push(Operation::Linear { layer, columns, bias, x }, outputs)
    }

    /// Returns Wᵀy for every column.
    pub(crate) fn transposed(&mut self, layer: Layer, columns: usize, y: Node) -> Node {
        assert_eq!(self.length(y), columns * layer.outputs, "outputs of a layer");
        let inputs = columns * layer.inputs;
        if self.is_all(y, 0.0) {
            return self.zeros(inputs);
        }
        self.push(Operation::Transposed { layer, columns, y }, inputs)
    }

    /// Returns f(x), entry by entry.
    pub fn map(&mut self, function: Function, x: Node) -> Node {
        self.derivative(function, 0, x)
    }

    /// Returns cos x, entry by entry, with x in rad.
    pub fn cosine(&mut self, x: Node) -> Node {
        self.derivative(Function::Sine, 1, x)
    }

    /// Returns f⁽ᵒʳᵈᵉʳ⁾(x), entry by entry.
    pub(crate) fn derivative(&mut self, function: Function, order: usize, x: Node) -> Node {
        if function == Function::Sine && order >= 2 {
            // sin″ = −sin: a derivative of any order is again a sine or a cosine.
            let before = self.derivative(function, order - 2, x);
            return self.scaled(-1.0, before);
        }
        assert!(order < crate::function::ORDERS, "a derivative of order {order}");
        if let Some(c) = function.constant_derivative(order) {
            return self.constant(&vec![c; self.length(x)]);
        }
        self.functions.insert(function.number(), function);
        self.push(Operation::Map { function: function.number(), order, x }, self.length(x))
    }

    /// Returns xy, entry by entry.
    pub fn product(&mut self, x: Node, y: Node) -> Node {
        assert_eq!(self.length(x), self.length(y), "factors");
        if let (Some(a), Some(b)) = (self.known(x), self.known(y)) {
            return self.constant(&a.iter().zip(&b).map(|(a, b)| a * b).collect::<Vec<_>>());
        }
        for (x, y) in [(x, y), (y, x)] {
            if self.is_all(x, 0.0) || self.is_all(y, 1.0) {
                return x;
            }
        }
        self.push(Operation::Product(x.min(y), x.max(y)), self.length(x))
    }

    /// Returns x + y.
    pub fn sum(&mut self, x: Node, y: Node) -> Node {
        assert_eq!(self.length(x), self.length(y), "summands");
        if let (Some(a), Some(b)) = (self.known(x), self.known(y)) {
            return self.constant(&a.iter().zip(&b).map(|(a, b)| a + b).collect::<Vec<_>>());
        }
        for (x, y) in [(x, y), (y, x)] {
            if self.is_all(x, 0.0) {
                return y;
            }
        }
        self.push(Operation::Sum(x.min(y), x.max(y)), self.length(x))
    }

    /// Returns x − y.
    pub fn difference(&mut self, x: Node, y: Node) -> Node {
        let minus = self.scaled(-1.0, y);
        self.sum(x, minus)
    }

    /// Returns cx.
    pub fn scaled(&mut self, c: f64, x: Node) -> Node {
        if c == 1.0 {
            return x;
        }
        if let Some(known) = self.known(x) {
            return self.constant(&known.iter().map(|x| c * x).collect::<Vec<_>>());
        }
        match self.operations[x.index()] {
            Operation::Scaled(own, x) => self.scaled(c * f64::from_bits(own), x),
            _ => self.push(Operation::Scaled(c.to_bits(), x), self.length(x)),
        }
    }

    /// Returns the vector with entry i equal to x\[index\[i\]\].
    pub fn gather(&mut self, x: Node, index: &[usize]) -> Node {
        assert!(index.iter().all(|i| *i < self.length(x)), "entries to gather");
        if index.len() == self.length(x) && index.iter().enumerate().all(|(i, at)| i == *at) {
            return x;
        }
        if let Some(known) = self.known(x) {
            return self.constant(&index.iter().map(|i| known[*i]).collect::<Vec<_>>());
        }
        if let Some(before) = self.gathered_before(x, index) {
            return before;
        }
        let index = index.iter().map(|i| *i as u32).collect::<Box<[u32]>>();
        let length = index.len();
        self.push(Operation::Gather { x, index }, length)
    }

    /// Returns the vector of `length` entries with entry k equal to the sum of all x\[i\] with index\[i\] = k.
    pub fn scatter(&mut self, x: Node, index: &[usize], length: usize) -> Node {
        assert!(index.len() == self.length(x) && index.iter().all(|i| *i < length), "entries to add to");
        if index.len() == length && index.iter().enumerate().all(|(i, at)| i == *at) {
            return x;
        }
        if index.is_empty() {
            return self.zeros(length);
        }
        if let Some(known) = self.known(x) {
            let mut sums = vec![0.0; length];
            index.iter().zip(known).for_each(|(i, x)| sums[*i] += x);
            return self.constant(&sums);
        }
        let index = index.iter().map(|i| *i as u32).collect();
        self.push(Operation::Scatter { x, index }, length)
    }

    /// Returns x·y as a vector of one number.
    pub fn dot(&mut self, x: Node, y: Node) -> Node {
        let product = self.product(x, y);
        self.total(product)
    }

    /// Returns the sum of all entries as a vector of one number.
    pub fn total(&mut self, x: Node) -> Node {
        self.scatter(x, &vec![0; self.length(x)], 1)
    }

    /// Repeats a vector of one number `length` times.
    pub fn repeated(&mut self, x: Node, length: usize) -> Node {
        self.gather(x, &vec![0; length])
    }

    /// Joins vectors one after the other.
    pub fn joined(&mut self, parts: &[Node]) -> Node {
        let length = parts.iter().map(|part| self.length(*part)).sum();
        let mut start = 0;
        let mut sum = self.zeros(length);
        for part in parts.iter().filter(|part| self.length(**part) > 0).copied().collect::<Vec<_>>() {
            let end = start + self.length(part);
            let own = self.scatter(part, &(start..end).collect::<Vec<_>>(), length);
            sum = self.sum(sum, own);
            start = end;
        }
        sum
    }

    /// Returns the entries `range` of a vector.
    pub fn part(&mut self, x: Node, range: Range<usize>) -> Node {
        self.gather(x, &range.collect::<Vec<_>>())
    }
}
