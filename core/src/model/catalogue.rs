//! Catalogue of all reasons for refusing a model, by number: one list for this crate, its C interface and the link to a processor. Reasons for
//! refusing a plan have numbers of their own in [`plan::CATALOGUE`](crate::plan::CATALOGUE).

use super::ModelError;
use crate::energy::graph::GraphError;
use crate::energy::modular::TreeError;
use core::ffi::CStr;

/// A reason for refusing a file, in the form known to programs in other languages and on other processors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Number of the reason; it is never given another meaning.
    pub code: u8,
    /// Name, one word.
    pub name: &'static str,
    /// Message in a sentence, without numbers.
    pub message: &'static CStr,
}

pub(crate) const fn entry(code: u8, name: &'static str, message: &'static CStr) -> Entry {
    Entry { code, name, message }
}

/// All reasons, in the order of their numbers.
pub const CATALOGUE: [Entry; 44] = [
    entry(8, "no_step", c"the file does not say a step and an order"),
    entry(20, "too_short", c"not a whole model file"),
    entry(21, "not_a_model", c"not a leastaction model file (it does not begin with LACT)"),
    entry(22, "version", c"a format version that this program does not read"),
    entry(23, "checksum", c"the file is damaged: another checksum"),
    entry(24, "malformed", c"the header is malformed"),
    entry(25, "trailing_bytes", c"bytes after the end of a shape"),
    entry(26, "unaligned", c"the weights are not at a multiple of 4: align the array that holds the file"),
    entry(27, "big_endian", c"weights are little-endian and cannot be read in place here"),
    entry(28, "weight_count", c"not as many weights as the shape needs"),
    entry(29, "weight_not_finite", c"a weight is infinite or not a number"),
    entry(30, "out_of_range", c"a number of the header is out of range"),
    entry(31, "names", c"names are missing, empty or the same"),
    entry(32, "no_such_tree", c"no tree in the file has that name"),
    entry(33, "no_such_graph", c"no graph in the file has that name"),
    entry(34, "other_family", c"a model of another family than the program was built for"),
    entry(35, "shape", c"the file's shape is not the one that the program was built for"),
    entry(36, "precision", c"weights of another precision than the program was built for"),
    entry(37, "section", c"a section that this program does not know and that may change the physics"),
    entry(38, "missing_section", c"a section that every file has is missing"),
    entry(39, "other_file_error", c"the file was refused"),
    entry(40, "tree_empty", c"a tree without elements"),
    entry(41, "tree_parent", c"an element hangs from one that does not come before it"),
    entry(42, "tree_kind", c"an element is of a type that does not exist"),
    entry(43, "tree_coordinates", c"the tree has not the coordinates that the program was built for"),
    entry(44, "law", c"a law of force that the program was not built for"),
    entry(45, "order", c"the model was trained with steps of another order"),
    entry(46, "friction", c"a number of a law of force is out of range"),
    entry(49, "other_tree_error", c"the tree was refused"),
    entry(50, "graph_empty", c"a graph without nodes"),
    entry(51, "graph_too_many_nodes", c"more nodes than an edge can name"),
    entry(52, "graph_node_kind", c"a node is of a type that does not exist"),
    entry(53, "graph_edge_kind", c"an edge is of a type that does not exist"),
    entry(54, "graph_end", c"an edge ends at a node that does not exist"),
    entry(55, "graph_loop", c"an edge joins a node to itself"),
    entry(56, "graph_coordinates", c"the graph has not the coordinates that the program was built for"),
    entry(57, "graph_mass", c"the mass of a node type is not positive and finite"),
    entry(58, "graph_drag", c"the drag of a node type is negative or not finite"),
    entry(59, "graph_too_many_edges", c"more edges than the program has room for"),
    entry(60, "graph_too_many_rods", c"more rods than the program has room for"),
    entry(61, "graph_member_nodes", c"a member of a union does not name as many nodes as it has"),
    entry(62, "graph_member_order", c"a member of a union names its nodes out of order"),
    entry(63, "graph_ownerless", c"no member of a union has a node"),
    entry(69, "other_graph_error", c"the graph was refused"),
];

/// A reason with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coded {
    /// Number of the reason in its catalogue.
    pub code: u8,
    /// The numbers of the error in the order of its fields, padded with 0.
    pub numbers: [usize; 3],
    /// Subject of the error, in words.
    pub what: Option<&'static str>,
}

impl Coded {
    pub(crate) const fn bare(code: u8) -> Self {
        Self::new(code, [0; 3])
    }

    pub(crate) const fn new(code: u8, numbers: [usize; 3]) -> Self {
        Self { code, numbers, what: None }
    }

    pub(crate) const fn about(self, what: &'static str) -> Self {
        Self { what: Some(what), ..self }
    }
}

impl ModelError {
    /// Returns the reason as numbers.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::NoStep => Coded::bare(8),
            Self::TooShort { bytes } => Coded::new(20, [bytes, 0, 0]),
            Self::Magic => Coded::bare(21),
            Self::Version { found } => Coded::new(22, [found.into(), 0, 0]),
            Self::Checksum { stored, computed } => Coded::new(23, [stored as usize, computed as usize, 0]),
            Self::Malformed => Coded::bare(24),
            Self::TrailingBytes { bytes } => Coded::new(25, [bytes, 0, 0]),
            Self::Unaligned { offset } => Coded::new(26, [offset.into(), 0, 0]),
            Self::BigEndian => Coded::bare(27),
            Self::WeightCount { found, needed } => Coded::new(28, [found, needed, 0]),
            Self::NotFinite { index } => Coded::new(29, [index, 0, 0]),
            Self::OutOfRange { what } => Coded::bare(30).about(what),
            Self::Names { of } => Coded::bare(31).about(of),
            Self::NoSuchTree { trees } => Coded::new(32, [trees, 0, 0]),
            Self::NoSuchGraph { graphs } => Coded::new(33, [graphs, 0, 0]),
            Self::OtherFamily { found } => Coded::bare(34).about(found),
            Self::Shape { what, found, compiled } => Coded::new(35, [found, compiled, 0]).about(what),
            Self::Control { .. } => Coded::bare(35).about("kind of control"),
            Self::Actuator { found } => Coded::new(35, [found.into(), (!found).into(), 0]).about("actuators"),
            Self::Lag { found } => {
                Coded::new(35, [found.into(), (!found).into(), 0]).about("lags of the actuator")
            }
            Self::Precision { found, compiled } => Coded::new(36, [found.into(), compiled.into(), 0]),
            Self::Section { number } => Coded::new(37, [number.into(), 0, 0]),
            Self::MissingSection { what } => Coded::bare(38).about(what),
            Self::Law { number } => Coded::new(44, [number.into(), 0, 0]),
            Self::Order { found, compiled } => Coded::new(45, [found.into(), compiled.into(), 0]),
            Self::LawNumber { law, number, group, value } => {
                let symbol = law.symbols().get(usize::from(number)).copied();
                let numbers = [group.into(), number.into(), value.to_bits() as usize];
                Coded::new(46, numbers).about(symbol.unwrap_or(law.name()))
            }
            Self::Tree(error) => error.coded(),
            Self::Graph(error) => error.coded(),
        }
    }
}

impl TreeError {
    /// Returns the reason as numbers.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::Empty => Coded::bare(40),
            Self::Parent { element, parent } => Coded::new(41, [element, parent, 0]),
            Self::Kind { element, kind, kinds } => Coded::new(42, [element, kind, kinds]),
            Self::Coordinates { found, compiled } => Coded::new(43, [found, compiled, 0]),
        }
    }
}

impl GraphError {
    /// Returns the reason as numbers.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::Empty => Coded::bare(50),
            Self::TooManyNodes { found, most } => Coded::new(51, [found, most, 0]),
            Self::NodeKind { node, kind, kinds } => Coded::new(52, [node, kind, kinds]),
            Self::EdgeKind { edge, kind, kinds } => Coded::new(53, [edge, kind, kinds]),
            Self::End { edge, node, nodes } => Coded::new(54, [edge, node, nodes]),
            Self::Loop { edge, node } => Coded::new(55, [edge, node, 0]),
            Self::Coordinates { found, compiled } => Coded::new(56, [found, compiled, 0]),
            Self::Mass { kind } => Coded::new(57, [kind, 0, 0]),
            Self::Drag { kind } => Coded::new(58, [kind, 0, 0]),
            Self::TooManyEdges { capacity, needed } => Coded::new(59, [capacity, needed, 0]),
            Self::TooManyRods { capacity, needed } => Coded::new(60, [capacity, needed, 0]),
            Self::MemberNodes { member, found, needed } => Coded::new(61, [member, found, needed]),
            Self::MemberOrder { member, node } => Coded::new(62, [member, node, 0]),
            Self::Ownerless { node } => Coded::new(63, [node, 0, 0]),
        }
    }
}

/// Returns the entry with the given number, if it exists.
pub fn entry_of(code: u8) -> Option<&'static Entry> {
    CATALOGUE.iter().find(|entry| entry.code == code)
}
