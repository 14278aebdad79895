use core::fmt;

/// Why a graph was refused.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GraphError {
    /// No node.
    Empty,
    /// More nodes than an edge can name.
    TooManyNodes {
        /// Of the graph.
        found: usize,
        /// At most.
        most: usize,
    },
    /// A node is of a type that does not exist.
    NodeKind {
        /// The node, from 0.
        node: usize,
        /// The type it names.
        kind: usize,
        /// Types there are.
        kinds: usize,
    },
    /// An edge is of a type that does not exist.
    EdgeKind {
        /// The edge, from 0.
        edge: usize,
        /// The type it names.
        kind: usize,
        /// Types there are.
        kinds: usize,
    },
    /// An edge ends at a node that does not exist.
    End {
        /// The edge, from 0.
        edge: usize,
        /// The node it names.
        node: usize,
        /// Nodes there are.
        nodes: usize,
    },
    /// An edge joins a node to itself.
    Loop {
        /// The edge, from 0.
        edge: usize,
        /// The node.
        node: usize,
    },
    /// The graph does not have the number of coordinates that was compiled in.
    Coordinates {
        /// Of the graph: nodes times dimensions.
        found: usize,
        /// Compiled in.
        compiled: usize,
    },
    /// The mass of a node type is not finite or not positive.
    Mass {
        /// The node type, from 0.
        kind: usize,
    },
    /// The coefficient of viscous drag of a node type is not finite or negative.
    Drag {
        /// The node type, from 0.
        kind: usize,
    },
    /// A member of a union does not name as many nodes as it has.
    MemberNodes {
        /// The member, from 0.
        member: usize,
        /// Nodes that it names.
        found: usize,
        /// Nodes that it has.
        needed: usize,
    },
    /// The nodes that a member of a union names do not ascend, or one does not exist.
    MemberOrder {
        /// The member, from 0.
        member: usize,
        /// The node of the union that it names at the wrong place.
        node: usize,
    },
    /// No member of a union has a node.
    Ownerless {
        /// The node, from 0.
        node: usize,
    },
    /// More edges than the caller's slice holds.
    TooManyEdges {
        /// Edges that the slice holds.
        capacity: usize,
        /// Edges that there are.
        needed: usize,
    },
    /// More rods than there is room for.
    TooManyRods {
        /// Rods that there is room for.
        capacity: usize,
        /// Rods that there are.
        needed: usize,
    },
}

impl fmt::Display for GraphError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "a graph without nodes"),
            Self::TooManyNodes { found, most } => write!(f, "{found} nodes, more than {most}"),
            Self::NodeKind { node, kind, kinds } => {
                write!(f, "node {node} is of type {kind}, but there are only {kinds} node types (from 0)")
            }
            Self::EdgeKind { edge, kind, kinds } => {
                write!(f, "edge {edge} is of type {kind}, but there are only {kinds} edge types (from 0)")
            }
            Self::End { edge, node, nodes } => {
                write!(f, "edge {edge} ends at node {node}, but there are only {nodes} nodes (from 0)")
            }
            Self::Loop { edge, node } => write!(f, "edge {edge} joins node {node} to itself"),
            Self::Coordinates { found, compiled } => {
                write!(f, "a graph of {found} coordinates, but this program was compiled for {compiled}")
            }
            Self::Mass { kind } => write!(f, "the mass of node type {kind} is not a positive number"),
            Self::Drag { kind } => write!(f, "the drag of node type {kind} is not a number of at least 0"),
            Self::MemberNodes { member, found, needed } => {
                write!(f, "member {member} names {found} nodes, but its graph has {needed}")
            }
            Self::MemberOrder { member, node } => {
                write!(
                    f,
                    "member {member} names node {node} out of order or where there is none: list nodes upwards"
                )
            }
            Self::Ownerless { node } => write!(f, "no member has node {node}"),
            Self::TooManyEdges { capacity, needed } => {
                write!(f, "{needed} edges, but room for {capacity}")
            }
            Self::TooManyRods { capacity, needed } => {
                write!(f, "{needed} rods, but room for {capacity}")
            }
        }
    }
}

impl core::error::Error for GraphError {}
