//! The shape of a graph of particles on the host.

use super::{Constraint, DEPTH, Family, FamilySystem, HostScalar, Number, Visitor, too_many, uniform_layer};
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::{Drag, Edge, Fixed, Graph, Kinetic, MAX_NETWORKS, Shape, Types};
use leastaction_core::forces::System;
use leastaction_core::linear::dot;
use leastaction_core::model::{GraphHeader, GraphLayout, MAX_GRAPHS, ModelError, Rod};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

/// Units of a hidden layer of a network of a graph at most.
pub const MAX_WIDTH: usize = 64;
/// The smallest mass, kg, that training may reach.
const LEAST_MASS: f64 = 1e-6;

/// Node and edge types over host weights.
pub type HostTypes<'w, W, const D: usize> = Types<'w, W, D, MAX_NETWORKS, MAX_WIDTH, DEPTH>;

/// A node type's name and numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedNodes {
    /// What it is called.
    pub name: String,
    /// In the order of the weight block: mass, drag, field, kinetic embedding, embedding.
    pub numbers: Vec<Number>,
}

/// A graph by its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedGraph {
    /// What it is called.
    pub name: String,
    /// The type of every node.
    pub nodes: Vec<u8>,
    /// The edges.
    pub edges: Vec<Edge>,
    /// The rods, which are known and not learned.
    pub rods: Vec<Rod>,
}

impl NamedGraph {
    /// The rods as constraints in D dimensions.
    pub fn constraints<const D: usize>(&self) -> Vec<Holonomic<f64, D>> {
        self.rods.iter().map(Rod::constraint).collect()
    }

    fn from_layout(layout: &GraphLayout) -> Self {
        let (name, nodes) = (layout.name.to_owned(), layout.nodes.to_vec());
        Self { name, nodes, edges: layout.edges().collect(), rods: layout.rods().collect() }
    }
}

/// The shape of a graph model: its types, its graphs, and the graph that is meant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphArchitecture {
    /// Networks and types.
    pub shape: Shape,
    /// The names and numbers of the node types.
    pub types: Vec<NamedNodes>,
    /// The names of the edge types.
    pub edge_types: Vec<String>,
    /// All graphs.
    pub graphs: Vec<NamedGraph>,
    /// The graph that is trained or evaluated.
    pub graph: usize,
}

impl GraphArchitecture {
    /// The graph that is meant.
    ///
    /// # Errors
    /// Where there is none.
    pub fn graph(&self) -> Result<&NamedGraph, ModelError> {
        self.graphs.get(self.graph).ok_or(ModelError::NoSuchGraph { graphs: self.graphs.len() })
    }

    /// Calls `read` with the shape in the words of the model file.
    pub fn with_header<T>(&self, read: impl FnOnce(GraphHeader) -> T) -> T {
        let names: Vec<&str> = self.types.iter().map(|kind| kind.name.as_str()).collect();
        let edges = |graph: &NamedGraph| graph.edges.iter().flat_map(|edge| edge.to_bytes()).collect();
        let rods = |graph: &NamedGraph| graph.rods.iter().flat_map(|rod| rod.to_bytes()).collect();
        let bytes: Vec<[Vec<u8>; 2]> = self.graphs.iter().map(|graph| [edges(graph), rods(graph)]).collect();
        let mut graphs = [GraphLayout::default(); MAX_GRAPHS];
        for ((slot, graph), [edges, rods]) in graphs.iter_mut().zip(&self.graphs).zip(&bytes) {
            *slot = GraphLayout { name: &graph.name, nodes: &graph.nodes, edges, rods };
        }
        let (node_names, edge_names) = (names.join(","), self.edge_types.join(","));
        let (node_names, edge_names) = (node_names.as_str(), edge_names.as_str());
        read(GraphHeader { shape: self.shape, node_names, edge_names, graphs })
    }

    /// The shape that a model file has; all numbers are known, as in the file.
    pub fn from_header(header: &GraphHeader, weights: &[f64]) -> Self {
        let (shape, stride) = (header.shape, header.shape.numbers());
        let start = weights.len().saturating_sub(stride * shape.nodes().count());
        let numbers = weights.get(start..).unwrap_or_default().chunks_exact(stride);
        let named = |(name, numbers): (&str, &[f64])| NamedNodes {
            name: name.to_owned(),
            numbers: numbers.iter().copied().map(Number::known).collect(),
        };
        Self {
            shape,
            types: header.node_names.split(',').zip(numbers).map(named).collect(),
            edge_types: header.edge_names.split(',').filter(|n| !n.is_empty()).map(str::to_owned).collect(),
            graphs: header.graphs().map(NamedGraph::from_layout).collect(),
            graph: 0,
        }
    }

    /// The same with the graph of that name in mind; `None` where there is none.
    #[must_use]
    pub fn with_graph_named(&self, name: &str) -> Option<Self> {
        let graph = self.graphs.iter().position(|graph| graph.name == name)?;
        Some(Self { graph, ..self.clone() })
    }

    /// The same with another graph in place of all others.
    #[must_use]
    pub fn with_graph(&self, graph: NamedGraph) -> Self {
        Self { graphs: vec![graph], graph: 0, ..self.clone() }
    }

    /// Coordinates of a node, D.
    pub fn dimension(&self) -> usize {
        self.shape.dimension.into()
    }

    /// Number of coordinates n; 0 without a graph.
    pub fn n(&self) -> usize {
        self.graph().map_or(0, |graph| graph.nodes.len() * self.dimension())
    }

    /// Numbers in the weight block.
    ///
    /// # Errors
    /// Where the shape is out of the format's range.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.shape.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    /// Random networks, the numbers as given.
    pub fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut stream = Pcg64::seed_from_u64(seed);
        let mut weights = Vec::new();
        for (inputs, outputs) in self.shape.networks().flat_map(super::layers) {
            uniform_layer(&mut weights, inputs, outputs, &mut stream);
        }
        weights.extend(self.numbers().map(|number| number.value));
        weights
    }

    /// The numbers after the networks, in the order of the weight block.
    fn numbers(&self) -> impl Iterator<Item = &Number> {
        self.types.iter().flat_map(|kind| &kind.numbers)
    }

    fn numbers_start(&self) -> usize {
        self.shape.networks().filter_map(|network| network.parameters()).sum()
    }

    /// The positions of the known numbers.
    pub fn fixed_positions(&self) -> Vec<usize> {
        let numbers = (self.numbers_start()..).zip(self.numbers());
        numbers.filter(|(_, number)| !number.learned).map(|(position, _)| position).collect()
    }

    /// Masses above 0, viscous drag not below.
    pub fn project(&self, weights: &mut [f64]) {
        let numbers = weights.get_mut(self.numbers_start()..).unwrap_or_default();
        for (numbers, node) in numbers.chunks_exact_mut(self.shape.numbers()).zip(self.shape.nodes()) {
            if let [mass, drag, ..] = numbers {
                *mass = if node.kinetic == Kinetic::Mass { mass.max(LEAST_MASS) } else { *mass };
                *drag = if node.drag == Drag::Viscous { drag.max(0.0) } else { *drag };
            }
        }
    }

    /// Node and edge types over a weight block.
    ///
    /// # Errors
    /// Where the block or the compiled sizes do not fit.
    pub fn host_types<'w, W: Copy, const D: usize>(
        &self,
        weights: &'w [W],
    ) -> Result<HostTypes<'w, W, D>, ModelError> {
        if let Some(what) = self.shape.misfit() {
            return Err(ModelError::OutOfRange { what });
        }
        self.with_header(|header| header.types(weights))
    }

    pub(super) fn dispatch<V: Visitor>(&self, visitor: V) -> Result<V::Output, ModelError> {
        let family = || self.clone();
        match (self.dimension(), self.n()) {
            (2, 2) => Ok(visitor.visit(&Compiled::<2, 2>(family()))),
            (2, 4) => Ok(visitor.visit(&Compiled::<2, 4>(family()))),
            (2, 6) => Ok(visitor.visit(&Compiled::<2, 6>(family()))),
            (2, 8) => Ok(visitor.visit(&Compiled::<2, 8>(family()))),
            (2, 10) => Ok(visitor.visit(&Compiled::<2, 10>(family()))),
            (3, 6) => Ok(visitor.visit(&Compiled::<3, 6>(family()))),
            (3, 9) => Ok(visitor.visit(&Compiled::<3, 9>(family()))),
            (2, n) => too_many("coordinates of a graph to train", n, 10),
            (_, n) => too_many("coordinates of a graph to train", n, 9),
        }
    }
}

/// A graph in N coordinates, D of each node.
#[derive(Clone)]
struct Compiled<const D: usize, const N: usize>(GraphArchitecture);

impl<const D: usize, const N: usize> Family<N> for Compiled<D, N> {
    type Lagrangian<'w, S: HostScalar> = Fixed<'w, f64, D, MAX_NETWORKS, MAX_WIDTH, DEPTH, N>;
    type Forces<'w, S: HostScalar> = Fixed<'w, f64, D, MAX_NETWORKS, MAX_WIDTH, DEPTH, N>;

    fn system<'w, S: HostScalar>(
        &'w self,
        weights: &'w [f64],
    ) -> Result<FamilySystem<'w, Self, S, N>, ModelError> {
        let graph = self.0.graph()?;
        let graph = Graph::new(self.0.host_types(weights)?, &graph.nodes, &graph.edges);
        let fixed = graph.and_then(Fixed::new).map_err(ModelError::Graph)?;
        Ok(System { lagrangian: fixed, forces: fixed })
    }

    fn constraints(&self, q: &[f64; N], v: &[f64; N]) -> Vec<([f64; N], f64)> {
        let rods = self.0.graph().map_or(&[][..], |graph| &graph.rods);
        rods.iter().map(|rod| row(rod, q.as_chunks::<D>().0, v.as_chunks::<D>().0)).collect()
    }
}

/// ∂φ/∂q and (d/dt ∂φ/∂q) v of a rod, with φ = (|d|² − ℓ²)/(2ℓ) as core has it.
fn row<const D: usize, const N: usize>(rod: &Rod, q: &[[f64; D]], v: &[[f64; D]]) -> Constraint<N> {
    let (to, from, length) = (usize::from(rod.to), rod.from.map(usize::from), f64::from(rod.length));
    let across = |x: &[[f64; D]]| -> [f64; D] {
        std::array::from_fn(|i| x[to][i] - from.map_or(0.0, |from| x[from][i]))
    };
    let (d, rate) = (across(q), across(v));
    let mut gradient = [0.0; N];
    for (i, d) in d.iter().enumerate() {
        gradient[D * to + i] = d / length;
        if let Some(from) = from {
            gradient[D * from + i] = -d / length;
        }
    }
    (gradient, dot(&rate, &rate) / length)
}
