//! Particles with energies of single nodes, of the edges between nodes and of messages along the edges (LGNN; Bhattoo, Ranu, Krishnan, MLST
//! 2023), in 2 or 3 dimensions.
//!
//! Node types and edge types are learned once and reused in any graph, of any size. With s_ab = |x_a − x_b|²,
//!
//! L = Σ_i T_i(|v_i|²) − Σ_i V_i(x_i) − Σ_edges U(s_ab) − V_messages,
//!
//! The drag on a node depends on its own velocity; [`MessageShape`] defines V_messages. Every term depends on
//! one node, or on one edge with its ends, so values and derivatives take time and memory in proportion to the
//! number of nodes and edges. L_vq = 0, and the mass matrix has one block per node.
//!
//! [`Graph`] implements [`Particles`](crate::particles::Particles) for any number of nodes; [`Fixed`] implements
//! [`Lagrangian`](crate::lagrangian::Lagrangian) for a compiled number of nodes, with all derivatives, for training and for the discrete
//! Euler–Lagrange equation.

mod cutoff;
mod error;
mod fixed;
mod messages;
mod particles;
mod radial;
mod round;
mod shape;
mod types;
mod union;

pub use cutoff::cutoff_edges;
pub use error::GraphError;
pub use fixed::Fixed;
pub use shape::{
    Drag, EDGE_NUMBERS, EdgeShape, GraphShape, Kinetic, MAX_EDGE_TYPES, MAX_EMBEDDING, MAX_NETWORKS,
    MAX_NODE_TYPES, MessageShape, NodeShape, Potential, Separation,
};
pub use types::Types;
pub use union::{Member, Union};

use crate::expected::expected;
use crate::scalar::{Scalar, WeightFormat};
use serde::{Deserialize, Serialize};

/// Maximum number of nodes of a graph: edges name nodes by 16 bits.
pub const MAX_NODES: usize = 1 << 16;

/// An edge: its type, and the two nodes that it joins, in either order. Two nodes may share several edges; each counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// Edge type, from 0.
    pub kind: u8,
    /// The nodes, from 0.
    pub ends: [u16; 2],
}

/// A graph of any size over borrowed weights, node types and edges.
///
/// Neighbouring edges of one type are evaluated side by side (see [`Packed`](crate::scalar::Packed)): sort long lists by type. Sums are
/// taken in the order of the lists.
#[derive(Clone, Copy, Debug)]
pub struct Graph<'a, W, const D: usize, const K: usize, const H: usize, const L: usize> {
    types: Types<'a, W, D, K, H, L>,
    nodes: &'a [u8],
    edges: &'a [Edge],
}

impl<'a, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>
    Graph<'a, W, D, K, H, L>
{
    /// Creates a graph from its edges and the type of every node.
    ///
    /// # Errors
    /// See [`GraphError`]: all types must exist, and every edge must join two different nodes that exist.
    pub fn new(
        types: Types<'a, W, D, K, H, L>,
        nodes: &'a [u8],
        edges: &'a [Edge],
    ) -> Result<Self, GraphError> {
        types.shape().check_graph(nodes, edges.iter().copied())?;
        Ok(Self { types, nodes, edges })
    }

    /// The node types and edge types.
    pub fn types(&self) -> &Types<'a, W, D, K, H, L> {
        &self.types
    }

    /// The type of every node.
    pub fn nodes(&self) -> &'a [u8] {
        self.nodes
    }

    /// The edges.
    pub fn edges(&self) -> &'a [Edge] {
        self.edges
    }

    #[inline(always)]
    fn kind(&self, node: usize) -> u8 {
        expected(self.nodes.get(node).copied(), 0)
    }
}

impl GraphShape {
    /// Checks a graph against the types.
    ///
    /// # Errors
    /// See [`GraphError`].
    pub fn check_graph(&self, nodes: &[u8], edges: impl IntoIterator<Item = Edge>) -> Result<(), GraphError> {
        if nodes.is_empty() {
            return Err(GraphError::Empty);
        }
        if nodes.len() > MAX_NODES {
            return Err(GraphError::TooManyNodes { found: nodes.len(), most: MAX_NODES });
        }
        let kinds = self.nodes.len();
        let unknown =
            nodes.iter().map(|kind| usize::from(*kind)).enumerate().find(|(_, kind)| *kind >= kinds);
        if let Some((node, kind)) = unknown {
            return Err(GraphError::NodeKind { node, kind, kinds });
        }
        edges.into_iter().enumerate().try_for_each(|(i, edge)| self.check_edge(i, &edge, nodes.len()))
    }

    fn check_edge(&self, edge: usize, Edge { kind, ends }: &Edge, nodes: usize) -> Result<(), GraphError> {
        let (kind, kinds, [a, b]) = (usize::from(*kind), self.edges.len(), ends.map(usize::from));
        if kind >= kinds {
            return Err(GraphError::EdgeKind { edge, kind, kinds });
        }
        if let Some(node) = [a, b].into_iter().find(|node| *node >= nodes) {
            return Err(GraphError::End { edge, node, nodes });
        }
        if a == b { Err(GraphError::Loop { edge, node: a }) } else { Ok(()) }
    }
}

/// x_a − x_b between an edge's ends; `None` if q has no such node.
#[inline(always)]
fn across<S: Scalar, const D: usize>(q: &[[S; D]], edge: &Edge) -> Option<[S; D]> {
    let [a, b] = edge.ends.map(usize::from);
    let (mut d, b) = (*q.get(a)?, q.get(b)?);
    d.iter_mut().zip(b).for_each(|(d, b)| *d -= *b);
    Some(d)
}

/// Adds `x` at the first end of an edge, and subtracts it at the second.
#[inline(always)]
fn exchange<S: Scalar, const D: usize>(of: &mut [[S; D]], edge: &Edge, x: &[S; D]) {
    let [a, b] = edge.ends.map(usize::from);
    if let Some(a) = of.get_mut(a) {
        a.iter_mut().zip(x).for_each(|(a, x)| *a += *x);
    }
    if let Some(b) = of.get_mut(b) {
        b.iter_mut().zip(x).for_each(|(b, x)| *b -= *x);
    }
}
