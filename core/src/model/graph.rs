use super::header::{are_names, check_names, require};
use super::{LawNumbers, Model, ModelError, ParsedAs};
use crate::constraints::{Constrained, ConstraintError, Holonomic};
use crate::discrete::rattle::Rattle;
use crate::energy::graph::{Edge, Graph, GraphError, GraphShape, Types};
use crate::expected::expected;
use crate::scalar::{FileWeightFormat, Real, WeightFormat};
use serde::{Deserialize, Serialize};

/// Maximum number of graphs in one file.
pub const MAX_GRAPHS: usize = 8;

/// The shape of a graph model. Types are kept apart from graphs: one set of types serves graphs of any size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphHeader<'a> {
    /// Shape of the networks, node types and edge types.
    pub shape: GraphShape,
    /// Names of the node types, separated by commas.
    pub node_names: &'a str,
    /// Names of the edge types, separated by commas; empty if there are none.
    pub edge_names: &'a str,
    /// The graphs, by name; the first graph without nodes ends the list.
    #[serde(borrow)]
    pub graphs: [GraphLayout<'a>; MAX_GRAPHS],
}

/// Nodes and edges of a graph.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GraphLayout<'a> {
    /// Name.
    pub name: &'a str,
    /// Type of every node, one byte each.
    pub nodes: &'a [u8],
    /// Five bytes per edge: its type, then the two nodes that it joins, each little-endian.
    pub edges: &'a [u8],
    /// Eight bytes per rod (rods are known, not learned): where it hangs from ([`ORIGIN`] or a node), the node at its other end, and its
    /// length (m, > 0, f32), each little-endian.
    pub rods: &'a [u8],
}

/// Node number that means the origin at a rod's first end.
pub const ORIGIN: u16 = u16::MAX;

/// A massless rod of a graph in a model file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rod {
    /// First end: a node, or `None` for the origin.
    pub from: Option<u16>,
    /// Node at the other end.
    pub to: u16,
    /// Length ℓ, m.
    pub length: f32,
}

impl Rod {
    /// Bytes of a rod in a model file.
    pub const BYTES: usize = 8;

    /// Converts the rod to its bytes in a model file; `None` for a rod from node 65,535, whose number stands for the
    /// origin.
    pub fn to_bytes(self) -> Option<[u8; Self::BYTES]> {
        if self.from == Some(ORIGIN) {
            return None;
        }
        let ([a0, a1], [b0, b1]) = (self.from.unwrap_or(ORIGIN).to_le_bytes(), self.to.to_le_bytes());
        let [l0, l1, l2, l3] = self.length.to_le_bytes();
        Some([a0, a1, b0, b1, l0, l1, l2, l3])
    }

    /// Reads a rod of a model file.
    pub fn from_bytes([a0, a1, b0, b1, length @ ..]: [u8; Self::BYTES]) -> Self {
        let from = u16::from_le_bytes([a0, a1]);
        let from = if from == ORIGIN { None } else { Some(from) };
        Self { from, to: u16::from_le_bytes([b0, b1]), length: f32::from_le_bytes(length) }
    }

    /// Converts the rod to a constraint in `D` dimensions.
    pub fn constraint<R: Real, const D: usize>(&self) -> Holonomic<R, D> {
        let (node, length) = (usize::from(self.to), R::constant(self.length.into()));
        match self.from {
            Some(from) => Holonomic::Rod { nodes: [node, from.into()], length },
            None => Holonomic::Anchor { node, to: [R::zero(); D], length },
        }
    }

    fn is_between(&self, nodes: usize) -> bool {
        let at = |node: u16| usize::from(node) < nodes;
        at(self.to) && self.from.is_none_or(|from| at(from) && from != self.to)
    }
}

impl<'a> GraphLayout<'a> {
    /// The edges in order.
    pub fn edges(&self) -> impl Iterator<Item = Edge> + use<'a> {
        let (edges, _) = self.edges.as_chunks::<{ Edge::BYTES }>();
        edges.iter().map(|bytes| Edge::from_bytes(*bytes))
    }

    /// The rods in order.
    pub fn rods(&self) -> impl Iterator<Item = Rod> + use<'a> {
        let (rods, _) = self.rods.as_chunks::<{ Rod::BYTES }>();
        rods.iter().map(|bytes| Rod::from_bytes(*bytes))
    }
}

impl GraphLayout<'_> {
    /// Writes all rods to the front of `to`, as constraints, and returns that part.
    ///
    /// # Errors
    /// [`GraphError::TooManyRods`] if `to` is too short.
    pub fn constraints<'r, R: Real, const D: usize>(
        &self,
        to: &'r mut [Holonomic<R, D>],
    ) -> Result<&'r [Holonomic<R, D>], ModelError> {
        let (capacity, needed) = (to.len(), self.rods().count());
        let short = ModelError::Graph(GraphError::TooManyRods { capacity, needed });
        let to = to.get_mut(..needed).ok_or(short)?;
        for (slot, rod) in to.iter_mut().zip(self.rods()) {
            *slot = rod.constraint();
        }
        Ok(to)
    }
}

impl Edge {
    /// Bytes of an edge in a model file.
    pub const BYTES: usize = 5;

    /// Converts the edge to its bytes in a model file.
    pub const fn to_bytes(self) -> [u8; Self::BYTES] {
        let ([a0, a1], [b0, b1]) = (self.ends[0].to_le_bytes(), self.ends[1].to_le_bytes());
        [self.kind, a0, a1, b0, b1]
    }

    /// Reads an edge of a model file.
    pub const fn from_bytes([kind, a0, a1, b0, b1]: [u8; Self::BYTES]) -> Self {
        Self { kind, ends: [u16::from_le_bytes([a0, a1]), u16::from_le_bytes([b0, b1])] }
    }
}

/// A graph with the rods that hold it together.
#[derive(Clone, Copy, Debug)]
pub struct GraphSystem<'a, const D: usize, const K: usize, const H: usize, const L: usize, W = f32> {
    /// Energies and drag over the file's weights.
    pub graph: Graph<'a, W, D, K, H, L>,
    /// Rods of the graph.
    pub rods: &'a [Holonomic<f32, D>],
}

impl<'a, const D: usize, const K: usize, const H: usize, const L: usize, W: WeightFormat<Wide = f32>>
    GraphSystem<'a, D, K, H, L, W>
{
    /// The system that the solvers step: the graph under its rods.
    ///
    /// # Errors
    /// See [`ConstraintError`]; a loaded graph causes none.
    #[allow(clippy::type_complexity, reason = "a graph and its rods, spelled out once")]
    pub fn constrained(
        &self,
    ) -> Result<Constrained<'_, f32, Graph<'a, W, D, K, H, L>, [Holonomic<f32, D>], D>, ConstraintError<f32>>
    {
        Constrained::new(&self.graph, self.rods)
    }
}

impl<'a> GraphHeader<'a> {
    /// The graphs in order.
    pub fn graphs(&self) -> impl Iterator<Item = &GraphLayout<'a>> + Clone {
        self.graphs.iter().take_while(|graph| !graph.nodes.is_empty())
    }

    /// Returns the graph with the given name.
    ///
    /// # Errors
    /// [`ModelError::NoSuchGraph`] if there is none.
    pub fn layout(&self, name: &str) -> Result<&GraphLayout<'a>, ModelError> {
        let none = || ModelError::NoSuchGraph { graphs: self.graphs().count() };
        self.graphs().find(|graph| graph.name == name).ok_or_else(none)
    }

    /// Number of groups of coordinates, one per node type.
    pub(super) fn groups(&self) -> usize {
        self.shape.nodes.len()
    }

    /// Number of coordinates that every mechanism of a file has and that laws may therefore name: 0, since no law of
    /// graphs names coordinates.
    pub(super) fn common_coordinates(&self) -> usize {
        0
    }

    /// Length of the weight block, in numbers.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.shape.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    /// Returns the types over a weight block of any format: f32 as shipped, f64 on the host.
    ///
    /// # Errors
    /// [`ModelError::Shape`] if the types do not fit the compiled sizes.
    pub fn types<'w, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>(
        &self,
        weights: &'w [W],
    ) -> Result<Types<'w, W, D, K, H, L>, ModelError> {
        self.shape.check_size::<D, K, H, L>()?;
        let (mut block, needed) = (weights, self.parameters()?);
        let short = ModelError::WeightCount { found: weights.len(), needed };
        Types::take(&mut block, &self.shape).ok_or(short)
    }

    /// Returns a graph over a weight block; its edges are read into `edges`.
    ///
    /// # Errors
    /// The errors of [`GraphHeader::types`]; [`ModelError::Graph`] if the layout is no graph or `edges` is too short.
    pub fn graph<'w, W: WeightFormat, const D: usize, const K: usize, const H: usize, const L: usize>(
        &self,
        layout: &GraphLayout<'w>,
        weights: &'w [W],
        edges: &'w mut [Edge],
    ) -> Result<Graph<'w, W, D, K, H, L>, ModelError> {
        let (types, capacity, needed) = (self.types(weights)?, edges.len(), layout.edges().count());
        let workspace = edges.get_mut(..needed);
        let edges = workspace.ok_or(ModelError::Graph(GraphError::TooManyEdges { capacity, needed }))?;
        for (slot, edge) in edges.iter_mut().zip(layout.edges()) {
            *slot = edge;
        }
        Graph::new(types, layout.nodes, edges).map_err(ModelError::Graph)
    }

    pub(super) fn validate<W: FileWeightFormat>(&self, weights: &[W]) -> Result<(), ModelError> {
        if let Some(what) = self.shape.invalid_part() {
            return Err(ModelError::OutOfRange { what });
        }
        check_names(self.node_names, self.shape.nodes.len(), "node types")?;
        check_names(self.edge_names, self.shape.edges.len(), "edge types")?;
        self.check_graphs()?;
        let start = weights.len().saturating_sub(self.shape.all_numbers());
        self.shape.check_numbers(expected(weights.get(start..), &[])).map_err(ModelError::Graph)
    }

    fn check_graphs(&self) -> Result<(), ModelError> {
        let written = self.graphs.iter().filter(|graph| **graph != GraphLayout::default()).count();
        require(self.graphs().next().is_some(), "number of graphs")?;
        require(self.graphs().count() == written, "list of graphs")?;
        if !are_names(self.graphs().map(|graph| graph.name.as_bytes())) {
            return Err(ModelError::Names { of: "graphs" });
        }
        self.graphs().try_for_each(|graph| {
            require(graph.edges.len().is_multiple_of(Edge::BYTES), "length of a list of edges")?;
            require(graph.rods.len().is_multiple_of(Rod::BYTES), "length of a list of rods")?;
            require(graph.rods().all(|rod| rod.is_between(graph.nodes.len())), "end of a rod")?;
            let length = |rod: Rod| rod.length.is_finite() && rod.length > 0.0;
            require(graph.rods().all(length), "length of a rod")?;
            self.shape.check_graph(graph.nodes, graph.edges()).map_err(ModelError::Graph)
        })
    }
}

/// A graph in `D` dimensions with its rods: at most `K` networks of at most `L` hidden layers of at most `H` units.
///
/// `W` is as in [`InertiaNetworkModel`](super::InertiaNetworkModel).
pub type GraphModel<'a, const D: usize, const K: usize, const H: usize, const L: usize, W = f32> =
    Model<'a, GraphSystem<'a, D, K, H, L, W>>;

impl<'a, const D: usize, const K: usize, const H: usize, const L: usize, W: FileWeightFormat>
    GraphModel<'a, D, K, H, L, W>
{
    /// Reads, validates and borrows a model file, and takes the graph called `name`; its edges and rods are read into `edges` and `rods`.
    /// `bytes` must be 4-aligned.
    ///
    /// # Errors
    /// See [`ModelError`]; [`GraphError::TooManyEdges`](crate::energy::graph::GraphError) and `TooManyRods` if a list is too short.
    pub fn load(
        bytes: &'a [u8],
        name: &str,
        edges: &'a mut [Edge],
        rods: &'a mut [Holonomic<f32, D>],
    ) -> Result<Self, ModelError> {
        Self::read(
            bytes,
            |_| false,
            |parsed: &ParsedAs<GraphHeader, W>| {
                let header = parsed.shape;
                // Graphs have their drag in their node types; no other law exists for them yet.
                LawNumbers::new(parsed.laws, parsed.weights, 0).finish()?;
                let layout = header.layout(name)?;
                let first = header.graphs().next().is_some_and(|first| first.name == name);
                let graph = header.graph(layout, parsed.weights, edges)?;
                Ok((GraphSystem { graph, rods: layout.constraints(rods)? }, first))
            },
        )
    }

    /// Returns RATTLE with the step and the order that the model was trained with.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] if the model was trained without steps.
    pub fn rattle<R: Real>(&self) -> Result<Rattle<R>, ModelError> {
        let step = self.step()?;
        Ok(Rattle::new(R::constant(step.h.into()), step.order))
    }
}
