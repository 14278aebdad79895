use core::fmt;

/// Reason for refusing a graph.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GraphError {
    /// The graph has no nodes.
    Empty,
    /// The graph has more nodes than an edge can name.
    TooManyNodes {
        /// Nodes of the graph.
        found: usize,
        /// Maximum number of nodes.
        most: usize,
    },
    /// A node is of a type that does not exist.
    NodeKind {
        /// The node, from 0.
        node: usize,
        /// The type that the node names.
        kind: usize,
        /// Number of node types.
        kinds: usize,
    },
    /// An edge is of a type that does not exist.
    EdgeKind {
        /// The edge, from 0.
        edge: usize,
        /// The type that the edge names.
        kind: usize,
        /// Number of edge types.
        kinds: usize,
    },
    /// An edge ends at a node that does not exist.
    End {
        /// The edge, from 0.
        edge: usize,
        /// The node that the edge names.
        node: usize,
        /// Number of nodes.
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
        /// Coordinates of the graph: nodes times dimensions.
        found: usize,
        /// Coordinates compiled in.
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
    /// A member of a union names a different number of nodes than its graph has.
    MemberNodes {
        /// The member, from 0.
        member: usize,
        /// Number of nodes that the member names.
        found: usize,
        /// Number of nodes of the member's graph.
        needed: usize,
    },
    /// A member of a union does not name its nodes in ascending order, or names a node that does not exist.
    MemberOrder {
        /// The member, from 0.
        member: usize,
        /// The node of the union that the member names at the wrong place.
        node: usize,
    },
    /// A node belongs to no member of a union.
    Ownerless {
        /// The node, from 0.
        node: usize,
    },
    /// The graph has more edges than the caller's slice holds.
    TooManyEdges {
        /// Number of edges that the slice holds.
        capacity: usize,
        /// Number of edges that the graph has.
        needed: usize,
    },
    /// The graph has more rods than there is room for.
    TooManyRods {
        /// Number of rods that there is room for.
        capacity: usize,
        /// Number of rods that the graph has.
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
