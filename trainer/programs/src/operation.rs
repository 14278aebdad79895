//! Operations of a list, the vectors that they compute, and layers of networks in the weight block.

use std::ops::Range;

/// A vector in a list of operations; every sample has one of [`Builder::length`](crate::Builder::length) numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Node(u32);

impl Node {
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }

    pub(crate) const fn new(index: usize) -> Self {
        Self(index as u32)
    }
}

/// A fully connected layer y = Wx + b whose numbers begin at `start` in the weight block, in the order of
/// [`Dense`](leastaction_core::network::Dense).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Layer {
    start: usize,
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Number of inputs of the whole layer before these, and number of all its inputs.
    skipped: usize,
    all: usize,
}

impl Layer {
    /// Creates the layer whose first number is at `start`.
    pub const fn new(start: usize, inputs: usize, outputs: usize) -> Self {
        Self { start, inputs, outputs, skipped: 0, all: inputs }
    }

    /// Restricts the layer to some of its inputs: their columns of W, and b.
    pub(crate) const fn of_inputs(&self, inputs: Range<usize>) -> Self {
        let (skipped, count) = (self.skipped + inputs.start, inputs.end - inputs.start);
        Self { inputs: count, skipped, ..*self }
    }

    /// Range of the weights of a panel with `width` outputs, from output `first` on.
    pub(crate) const fn panel(&self, first: usize, width: usize) -> Range<usize> {
        let start = self.start + first * self.all + self.skipped * width;
        start..start + self.inputs * width
    }

    /// Position of the weight from input j to output i.
    pub(crate) const fn weight(&self, i: usize, j: usize) -> usize {
        let (eights, fours) = (self.outputs / 8 * 8, self.outputs / 4 * 4);
        let (first, width) = if i < eights {
            (i / 8 * 8, 8)
        } else if i < fours {
            (eights, 4)
        } else {
            (i, 1)
        };
        self.panel(first, width).start + j * width + i - first
    }

    /// Position of the first bias.
    pub(crate) const fn biases(&self) -> usize {
        self.start + self.all * self.outputs
    }

    /// Position of the number after the last one of the layer.
    pub(crate) const fn end(&self) -> usize {
        self.biases() + self.outputs
    }
}

/// Operation that computes a node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// The caller's vector with this number.
    Input(usize),
    /// A constant, equal in every sample, as the bits of f64.
    Constant(Box<[u64]>),
    /// Numbers of the weight block from this position on, equal in every sample.
    Parameters(usize),
    /// Wx for every column, plus b if there is a bias.
    Linear { layer: Layer, columns: usize, bias: bool, x: Node },
    /// Wᵀy for every column.
    Transposed { layer: Layer, columns: usize, y: Node },
    /// The derivative of a function of the given order, entry by entry.
    Map { function: u32, order: usize, x: Node },
    /// Product, entry by entry.
    Product(Node, Node),
    /// Sum, entry by entry.
    Sum(Node, Node),
    /// Product cx, with c as the bits of f64.
    Scaled(u64, Node),
    /// Vector with entry i equal to x\[index\[i\]\].
    Gather { x: Node, index: Box<[u32]> },
    /// Vector with entry k equal to the sum of all x\[i\] with index\[i\] = k.
    Scatter { x: Node, index: Box<[u32]> },
}

impl Operation {
    /// Calls `visit` with every node that the operation reads.
    pub(crate) fn reads(&self, mut visit: impl FnMut(Node)) {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::Parameters(_) => {}
            Self::Linear { x, .. }
            | Self::Transposed { y: x, .. }
            | Self::Map { x, .. }
            | Self::Scaled(_, x)
            | Self::Gather { x, .. }
            | Self::Scatter { x, .. } => visit(*x),
            Self::Product(a, b) | Self::Sum(a, b) => {
                visit(*a);
                visit(*b);
            }
        }
    }
}
