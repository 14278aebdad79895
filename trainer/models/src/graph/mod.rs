//! Host-side shape of a graph of particles.

pub mod config;
pub mod describe;
pub mod types;

pub use types::{GraphType, NamedGraph};

use crate::family::{Family, OpenGauge, Parts};
use crate::layers::{hidden, layers, random_layers};
use crate::limits::{DEPTH, MAX_ELEMENT_UNITS};
use crate::number::{Number, known_positions};
use crate::source::{ConstantType, LoadedType};
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, GraphShape, Kinetic, MAX_NETWORKS, NodeShape, Potential, Types,
};
use leastaction_core::model::{GraphHeader, GraphLayout, Laws, MAX_GRAPHS, ModelError};
use leastaction_core::scalar::WeightFormat;
use leastaction_programs::dynamics::Rods;
use leastaction_programs::energies::{Energies, GraphEnergies};
use serde::{Deserialize, Serialize};

/// Smallest mass that training may reach, kg.
const LEAST_MASS: f64 = 1e-6;

/// Factor on the outputs of a network when it is added to a simpler law.
const CORRECTION: f64 = 1e-3;

/// Node and edge types over host weights.
pub type HostTypes<'w, W, const D: usize> = Types<'w, W, D, MAX_NETWORKS, MAX_ELEMENT_UNITS, DEPTH>;

/// Shape of a graph model: its types, its graphs, and the selected graph.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphArchitecture {
    /// Networks and types.
    pub shape: GraphShape,
    /// Names and numbers of the node types.
    pub node_types: Vec<GraphType>,
    /// Names and numbers of the edge types.
    pub edge_types: Vec<GraphType>,
    /// All graphs.
    pub graphs: Vec<NamedGraph>,
    /// Position of the selected graph, which is trained or evaluated.
    pub graph: usize,
}

impl GraphArchitecture {
    /// Returns the selected graph.
    ///
    /// # Errors
    /// An error if there is none.
    pub fn graph(&self) -> Result<&NamedGraph, ModelError> {
        self.graphs.get(self.graph).ok_or(ModelError::NoSuchGraph { graphs: self.graphs.len() })
    }

    /// Whether the selected graph has rods.
    pub fn has_rods(&self) -> bool {
        self.graph().is_ok_and(|graph| !graph.rods.is_empty())
    }

    /// Calls `read` with the shape as the model file states it.
    pub fn with_header<T>(&self, read: impl FnOnce(GraphHeader) -> T) -> T {
        let names =
            |types: &[GraphType]| types.iter().map(|kind| kind.name.as_str()).collect::<Vec<_>>().join(",");
        let edges = |graph: &NamedGraph| graph.edges.iter().flat_map(|edge| edge.to_bytes()).collect();
        // No graph that is read or configured has a rod from node 65,535.
        let rods =
            |graph: &NamedGraph| graph.rods.iter().filter_map(|rod| rod.to_bytes()).flatten().collect();
        let bytes: Vec<[Vec<u8>; 2]> = self.graphs.iter().map(|graph| [edges(graph), rods(graph)]).collect();
        let mut graphs = [GraphLayout::default(); MAX_GRAPHS];
        for ((slot, graph), [edges, rods]) in graphs.iter_mut().zip(&self.graphs).zip(&bytes) {
            *slot = GraphLayout { name: &graph.name, nodes: &graph.nodes, edges, rods };
        }
        let (node_names, edge_names) = (names(&self.node_types), names(&self.edge_types));
        let (node_names, edge_names) = (node_names.as_str(), edge_names.as_str());
        read(GraphHeader { shape: self.shape, node_names, edge_names, graphs })
    }

    /// Returns the shape described by a model file; all numbers are known, as in the file.
    pub(crate) fn from_header(header: &GraphHeader, _: Laws, weights: &[f64]) -> Self {
        let shape = header.shape;
        let numbers = weights.get(weights.len().saturating_sub(shape.all_numbers())..).unwrap_or_default();
        let (nodes, edges) = numbers.split_at(numbers.len().min(shape.numbers() * shape.nodes.len()));
        Self {
            shape,
            node_types: GraphType::known(header.node_names, nodes, shape.numbers()),
            edge_types: GraphType::known(header.edge_names, edges, EDGE_NUMBERS),
            graphs: header.graphs().map(NamedGraph::from_layout).collect(),
            graph: 0,
        }
    }

    /// Returns the shape with the graph of that name selected; `None` if there is none.
    #[must_use]
    pub fn with_graph_named(&self, name: &str) -> Option<Self> {
        let mut own = self.clone();
        own.mean_part(name).then_some(own)
    }

    /// Returns the shape with this graph in place of all others.
    #[must_use]
    pub fn with_graph(&self, graph: NamedGraph) -> Self {
        Self { graphs: vec![graph], graph: 0, ..self.clone() }
    }

    /// Number of coordinates of a node, D.
    pub fn dimension(&self) -> usize {
        self.shape.dimension.into()
    }

    /// Length of the weight block, in numbers.
    ///
    /// # Errors
    /// An error if the shape is outside the range of the format.
    pub fn parameters(&self) -> Result<usize, ModelError> {
        self.shape.parameters().ok_or(ModelError::OutOfRange { what: "number of weights" })
    }

    /// Returns the weights that training begins with: [`GraphArchitecture::initial_weights`], with the networks beside a learned simpler
    /// law scaled down so that they hardly affect the motion.
    pub fn beginning(&self, seed: u64) -> Vec<f64> {
        let weights = self.initial_weights(seed);
        if self.has_laws() { self.with_corrections_scaled(weights, CORRECTION) } else { weights }
    }

    /// Numbers after the networks, in the order of the weight block.
    fn numbers(&self) -> impl Iterator<Item = &Number> {
        self.node_types.iter().chain(&self.edge_types).flat_map(|kind| &kind.numbers)
    }

    fn numbers_start(&self) -> usize {
        self.shape.networks.iter().filter_map(|network| network.parameters()).sum()
    }

    /// Networks beside a simpler law: those of potentials beside a field or the law of an edge type, and those of drag beside viscous drag.
    fn corrections(&self) -> impl Iterator<Item = u8> {
        let node = |kind: &NodeShape| {
            let potential = if let Potential::Network(n) = kind.potential { Some(n) } else { None };
            let drag = if let Drag::Network(n) = kind.drag { Some(n) } else { None };
            [potential, drag]
        };
        let nodes = self.shape.nodes.iter().flat_map(node).flatten();
        nodes.chain(self.shape.edges.iter().filter_map(|kind| kind.potential))
    }

    /// Returns the weights with the outputs of the networks beside a simpler law multiplied by `c`.
    #[must_use]
    pub fn with_corrections_scaled(&self, mut weights: Vec<f64>, c: f64) -> Vec<f64> {
        let corrections: Vec<usize> = self.corrections().map(usize::from).collect();
        let mut end = 0;
        for (k, network) in self.shape.networks.iter().enumerate() {
            end += network.parameters().unwrap_or(0);
            let last = layers(network).last().map_or(0, |(inputs, outputs)| (inputs + 1) * outputs);
            if corrections.contains(&k) {
                weights.get_mut(end - last..end).unwrap_or_default().iter_mut().for_each(|w| *w *= c);
            }
        }
        weights
    }

    /// Returns the shape without the networks beside a simpler law; the weight block stays the same.
    #[must_use]
    fn without_corrections(&self) -> Self {
        let mut simple = self.clone();
        for kind in simple.shape.nodes.iter_mut() {
            let uniform = kind.potential != Potential::None;
            kind.potential = if uniform { Potential::Uniform } else { Potential::None };
            kind.drag = if kind.drag == Drag::None { Drag::None } else { Drag::Viscous };
        }
        simple.shape.edges.iter_mut().for_each(|kind| kind.potential = None);
        simple
    }

    /// Whether a parameter of a simple law (drag, a field, the law of an edge type) is learned.
    fn has_laws(&self) -> bool {
        let nodes =
            self.node_types.iter().flat_map(|kind| kind.numbers.iter().skip(1).take(1 + self.dimension()));
        nodes.chain(self.edge_types.iter().flat_map(|kind| &kind.numbers)).any(|number| number.learned)
    }

    /// Returns the shape that is learned first, with only the simple laws; `None` if there are none, or if no network
    /// stands beside them.
    #[must_use]
    pub fn laws_alone(&self) -> Option<Self> {
        let simple = self.without_corrections();
        (self.has_laws() && simple.shape != self.shape).then_some(simple)
    }

    /// Returns node and edge types over a weight block.
    ///
    /// # Errors
    /// An error if the block or the compiled sizes do not fit.
    pub fn host_types<'w, W: WeightFormat, const D: usize>(
        &self,
        weights: &'w [W],
    ) -> Result<HostTypes<'w, W, D>, ModelError> {
        if let Some(what) = self.shape.invalid_part() {
            return Err(ModelError::OutOfRange { what });
        }
        self.with_header(|header| header.types(weights))
    }
}

impl Family for GraphArchitecture {
    fn n(&self) -> usize {
        self.graph().map_or(0, |graph| graph.nodes.len() * self.dimension())
    }

    fn initial_weights(&self, seed: u64) -> Vec<f64> {
        let mut weights = random_layers(self.shape.networks.iter().flat_map(layers), seed);
        weights.extend(self.numbers().map(|number| number.value));
        weights
    }

    fn fixed_positions(&self) -> Vec<usize> {
        known_positions(self.numbers_start(), self.numbers().copied())
    }

    fn project(&self, weights: &mut [f64]) {
        let numbers = weights.get_mut(self.numbers_start()..).unwrap_or_default();
        for (numbers, node) in numbers.chunks_exact_mut(self.shape.numbers()).zip(self.shape.nodes.iter()) {
            if let [mass, drag, ..] = numbers {
                *mass = if node.kinetic == Kinetic::Mass { mass.max(LEAST_MASS) } else { *mass };
                *drag = drag.max(0.0);
            }
        }
    }

    fn shows_scale(&self) -> bool {
        let Ok(graph) = self.graph() else { return false };
        let acts = |number: &Number| !number.learned && number.value != 0.0;
        let node = |kind: &u8| {
            let kind = usize::from(*kind);
            let (shape, named) = (self.shape.nodes.get(kind)?, self.node_types.get(kind)?);
            let (mass, drag) = (named.numbers.first()?, named.numbers.get(1)?);
            let mut field = named.numbers.iter().skip(2).take(self.dimension());
            Some(
                shape.kinetic == Kinetic::Mass && acts(mass)
                    || shape.drag == Drag::Viscous && acts(drag)
                    || shape.potential == Potential::Uniform && field.any(acts),
            )
        };
        let edge = |edge: &Edge| {
            let kind = usize::from(edge.kind);
            let (shape, named) = (self.shape.edges.get(kind)?, self.edge_types.get(kind)?);
            Some(shape.potential.is_none() && named.numbers.iter().any(acts))
        };
        graph.nodes.iter().any(|kind| node(kind).unwrap_or(false))
            || graph.edges.iter().any(|kind| edge(kind).unwrap_or(false))
    }

    fn coordinates(&self) -> String {
        "t".repeat(self.n())
    }

    /// All coordinates are lengths, so their unit is written once.
    fn units(&self) -> String {
        "m".to_owned()
    }

    fn energies(&self) -> Result<Box<dyn Energies>, ModelError> {
        let NamedGraph { nodes, edges, .. } = self.graph()?;
        Ok(Box::new(GraphEnergies::new(&self.shape, nodes, edges, 0)?))
    }

    /// Drag belongs to the node types; no other law is possible.
    fn groups(&self) -> usize {
        0
    }

    fn group_of_coordinates(&self) -> Vec<usize> {
        Vec::new()
    }

    fn mismatch(&self, data: usize) -> String {
        let (model, dimension) = (self.n(), self.dimension());
        let graph = self.graph().map_or("", |graph| &graph.name);
        format!(
            "[model] graph = {graph:?} has {model} coordinates, {dimension} of each node, but the data has {data}; name the graph \
             that the data is of, its nodes in the order of q"
        )
    }

    fn open_gauge(&self) -> Option<OpenGauge> {
        (!self.shows_scale()).then_some(OpenGauge::Masses { types: "node_types", of: "graph" })
    }

    fn networks(&self) -> Vec<Vec<usize>> {
        self.shape.networks.iter().map(|network| hidden(network).collect()).collect()
    }

    fn parts(&self) -> Option<Parts<'_>> {
        let names = self.graphs.iter().map(|graph| graph.name.as_str()).collect();
        Some(Parts { what: "graph", names, meant: self.graph().map_or("", |graph| &graph.name) })
    }

    fn mean_part(&mut self, name: &str) -> bool {
        let found = self.graphs.iter().position(|graph| graph.name == name);
        self.graph = found.unwrap_or(self.graph);
        found.is_some()
    }

    fn rods(&self) -> Result<Rods, ModelError> {
        Ok(Rods::new(self.dimension(), &self.graph()?.rods))
    }

    fn loaded_type(&self) -> LoadedType {
        let graph = self.graphs.get(self.graph);
        let (name, edges, rods) =
            graph.map_or(("", 0, 0), |graph| (graph.name.as_str(), graph.edges.len(), graph.rods.len()));
        let graphs: Vec<String> = self
            .graphs
            .iter()
            .map(|graph| format!("({:?}, {}, {})", graph.name, graph.nodes.len(), graph.edges.len()))
            .collect();
        let constants = format!(
            "/// Dimensions of space.\npub const DIMENSION: usize = {};\n/// Networks.\npub const K: usize = {};\n\
             /// The graph.\npub const GRAPH: &str = {name:?};\n/// Edges of the graph.\npub const EDGES: usize = {edges};\n\
             /// Rods of the graph.\npub const RODS: usize = {rods};\n/// All graphs in the file, their nodes and edges.\n\
             pub const GRAPHS: [(&str, usize, usize); {}] = [{}];\n",
            self.dimension(),
            self.shape.networks.len(),
            graphs.len(),
            graphs.join(", ")
        );
        LoadedType { constants, ..LoadedType::new("GraphModel", "DIMENSION, K, H, L") }
    }

    fn constant_type(&self) -> Result<ConstantType, &'static str> {
        Err("a graph")
    }
}
