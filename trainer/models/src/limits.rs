//! Sizes of models at most.

/// Coordinates of a learned inertia matrix at most, as in a model file.
pub const MAX_COORDINATES: usize = 16;
/// Units of a hidden layer at most.
pub const MAX_UNITS: usize = 1024;
/// Units of a hidden layer of a network of an element, a node or an edge at most.
pub const MAX_ELEMENT_UNITS: usize = 64;
/// Coordinates of a tree at most, as in a model file.
pub const MAX_TREE_COORDINATES: usize = 64;
/// Coordinates at most of a graph to train: the mass matrix of a sample is dense, and takes a pass over the graph for each of them.
pub const MAX_GRAPH_COORDINATES: usize = 192;
/// Hidden layers at most, as in a model file.
pub use leastaction_core::energy::MAX_HIDDEN;

/// Hidden layers at most of what is compiled for its sizes: the firmware loop of this machine, and the counting of operations.
pub const DEPTH: usize = 3;
/// Units of a hidden layer of a learned inertia matrix at most that is compiled for its sizes.
pub const MAX_WIDTH: usize = 256;
