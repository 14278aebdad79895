//! Maximum sizes of models.

/// Maximum number of coordinates of a learned inertia matrix, as in a model file.
pub const MAX_COORDINATES: usize = 16;
/// Maximum number of units in a hidden layer.
pub const MAX_UNITS: usize = 1024;
/// Maximum number of units in a hidden layer of a network of an element, a node or an edge.
pub const MAX_ELEMENT_UNITS: usize = 64;
/// Maximum number of coordinates of a tree, as in a model file.
pub const MAX_TREE_COORDINATES: usize = 64;
/// Maximum number of coordinates of a trained graph: the mass matrix of a sample is dense, and needs a pass over the
/// graph per coordinate.
pub const MAX_GRAPH_COORDINATES: usize = 192;
/// Maximum number of hidden layers, as in a model file.
pub use leastaction_core::energy::MAX_HIDDEN;

/// Maximum number of hidden layers in code compiled for fixed sizes: the firmware loop on this machine, and the counting of operations.
pub const DEPTH: usize = 3;
/// Maximum number of units in a hidden layer of a learned inertia matrix in code compiled for fixed sizes.
pub const MAX_WIDTH: usize = 256;
