use super::Law;
use crate::energy::SizeError;
use crate::energy::graph::GraphError;
use crate::energy::modular::TreeError;
use crate::forces::ControlKind;
use crate::frame::from_fault;
use core::fmt;

/// Reason for refusing a model file.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ModelError {
    /// Fewer bytes than the smallest file has.
    TooShort {
        /// Bytes given.
        bytes: usize,
    },
    /// The file does not begin with the magic letters.
    Magic,
    /// A format version that this build does not read.
    Version {
        /// The version in the file.
        found: u8,
    },
    /// The checksum does not match: the file was damaged.
    Checksum {
        /// Checksum in the file.
        stored: u32,
        /// Checksum computed from the bytes.
        computed: u32,
    },
    /// The header is not a postcard document of this format.
    Malformed,
    /// Bytes after the end of a shape.
    TrailingBytes {
        /// Number of excess bytes.
        bytes: usize,
    },
    /// The weight block does not begin at a multiple of 4: align the array that holds the file.
    Unaligned {
        /// Address of the block modulo 4.
        offset: u8,
    },
    /// Weights are little-endian and borrowed in place, which this processor cannot read.
    BigEndian,
    /// The weight block does not have the number of weights that the shape needs.
    WeightCount {
        /// Weights in the block.
        found: usize,
        /// Weights that the shape needs.
        needed: usize,
    },
    /// The program was compiled for weights of the other precision.
    Precision {
        /// Bits of a weight in the file: 16 or 32.
        found: u8,
        /// Bits that the program was compiled for.
        compiled: u8,
    },
    /// A weight is infinite or not a number.
    NotFinite {
        /// Index of the weight in the block.
        index: usize,
    },
    /// A number of the header is out of range.
    OutOfRange {
        /// Name of the number.
        what: &'static str,
    },
    /// The elements do not form a tree.
    Tree(TreeError),
    /// Nodes and edges do not form a graph, or a number of a node type is out of range.
    Graph(GraphError),
    /// Names are missing, empty or not unique.
    Names {
        /// Named things: element types or trees; node types, edge types or graphs.
        of: &'static str,
    },
    /// The file holds no tree with the requested name.
    NoSuchTree {
        /// Number of trees in the file.
        trees: usize,
    },
    /// The file holds no graph with the requested name.
    NoSuchGraph {
        /// Number of graphs in the file.
        graphs: usize,
    },
    /// The file holds a model of another family.
    OtherFamily {
        /// The family in the file.
        found: &'static str,
    },
    /// The file has a section that this build does not know and that may change the physics.
    Section {
        /// Number of the section.
        number: u8,
    },
    /// The file lacks a section that every file must have.
    MissingSection {
        /// Name of the section.
        what: &'static str,
    },
    /// The file has a law of force that the program was not compiled for.
    Law {
        /// Number of the law in the file.
        number: u8,
    },
    /// A number of a law of force is out of its range.
    LawNumber {
        /// The law.
        law: Law,
        /// Position among the numbers of the group ([`Law::ranges`]), from 0.
        number: u8,
        /// Group, from 0: a coordinate of an inertia network or of bodies, an element type of a modular model.
        group: u16,
        /// Value of the number.
        value: f32,
    },
    /// The file states neither a step nor an order: the model was trained without steps.
    NoStep,
    /// The model was trained with an integrator of another order.
    Order {
        /// Order in the file.
        found: u8,
        /// Order of the program's integrator.
        compiled: u8,
    },
    /// The model was trained with commands held, or linear between samples, but the program takes them the other way.
    Control {
        /// Kind of control in the file.
        found: ControlKind,
    },
    /// The file has an actuator and the program was compiled without one, or the other way round.
    Actuator {
        /// Whether the file has one.
        found: bool,
    },
    /// The file's actuator has a lag and the program was compiled without one, or the other way round.
    Lag {
        /// Whether the file has one.
        found: bool,
    },
    /// The file's shape is not the one the program was compiled for.
    Shape {
        /// Quantity: coordinates, dimensions of space, types, networks, hidden layers, hidden width, or past commands.
        what: &'static str,
        /// Size in the file.
        found: usize,
        /// Compiled size: exact for coordinates and dimensions of space, a maximum for all other quantities.
        compiled: usize,
    },
}

impl From<SizeError> for ModelError {
    fn from(SizeError { what, found, compiled }: SizeError) -> Self {
        Self::Shape { what, found, compiled }
    }
}

from_fault!(ModelError);

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooShort { bytes } => write!(f, "only {bytes} bytes: not a whole model file"),
            Self::Magic => write!(f, "not a leastaction model file (it does not begin with LACT)"),
            Self::Version { found } => {
                let hint = if *found == 1 { ": write it anew with `leastaction convert`" } else { "" };
                write!(
                    f,
                    "format version {found} is not {}, which this build reads{hint}",
                    super::FORMAT_VERSION
                )
            }
            Self::Checksum { stored, computed } => {
                write!(f, "damaged: checksum {computed:08x}, but the file says {stored:08x}")
            }
            Self::Malformed => write!(f, "the header is malformed"),
            Self::TrailingBytes { bytes } => write!(f, "{bytes} bytes after the end of a shape"),
            Self::Unaligned { offset } => {
                write!(
                    f,
                    "the weights lie {offset} bytes off a multiple of 4: align the array that holds the file"
                )
            }
            Self::BigEndian => write!(f, "weights are little-endian and cannot be read in place here"),
            Self::WeightCount { found, needed } => {
                write!(f, "{found} weights where the shape needs {needed}")
            }
            Self::Precision { found, compiled } => {
                write!(f, "weights of {found} bits, but this program was compiled for {compiled}")
            }
            Self::NotFinite { index } => write!(f, "weight {index} is infinite or not a number"),
            Self::OutOfRange { what } => write!(f, "{what} is out of range"),
            Self::Tree(error) => write!(f, "{error}"),
            Self::Graph(error) => write!(f, "{error}"),
            Self::Names { of } => {
                write!(f, "the {of} must each have a name of its own, and not an empty one")
            }
            Self::NoSuchTree { trees } => write!(f, "none of the {trees} trees in the file has that name"),
            Self::NoSuchGraph { graphs } => {
                write!(f, "none of the {graphs} graphs in the file has that name")
            }
            Self::OtherFamily { found } => {
                write!(f, "a model of the family {found}, which is not the one asked for")
            }
            Self::Section { number } => {
                write!(f, "section {number} is not known to this build, and may change the physics")
            }
            Self::MissingSection { what } => write!(f, "the section {what} is missing"),
            Self::Law { number } => match Law::ALL.into_iter().find(|law| *law as u8 == *number) {
                Some(law) => {
                    write!(f, "the law {} is not among those that this program was compiled for", law.name())
                }
                None => write!(f, "law of force {number} is not known to this build"),
            },
            Self::LawNumber { law, number, group, value } => {
                let number = usize::from(*number);
                let symbol = law.symbols().get(number).copied().unwrap_or_default();
                let range = law.ranges().get(number).map_or("", |range| range.words());
                write!(
                    f,
                    "{symbol} of the law {} of group {group} is {value}: it must be {range}",
                    law.name()
                )
            }
            Self::NoStep => write!(f, "the file does not say a step: the model was not trained for one"),
            Self::Order { found, compiled } => {
                write!(
                    f,
                    "the model was trained with steps of order {found}, but this program takes steps of order {compiled}"
                )
            }
            Self::Control { found } => {
                let (found, compiled) = match found {
                    ControlKind::Held => ("held", "linear between samples"),
                    ControlKind::Linear => ("linear between samples", "held"),
                };
                write!(
                    f,
                    "the model was trained with commands {found}, but this program takes them as {compiled}"
                )
            }
            Self::Actuator { found: true } => {
                write!(f, "the file has an actuator, but this program was compiled without one")
            }
            Self::Actuator { found: false } => {
                write!(f, "the file has no actuator, but this program was compiled for one")
            }
            Self::Lag { found: true } => {
                write!(f, "the file's actuator has a lag, but this program was compiled without one")
            }
            Self::Lag { found: false } => {
                write!(f, "the file's actuator has no lag, but this program was compiled for one")
            }
            Self::Shape { what, found, compiled } => {
                write!(f, "{found} {what}, but this program was compiled for {compiled}")
            }
        }
    }
}

impl core::error::Error for ModelError {}
