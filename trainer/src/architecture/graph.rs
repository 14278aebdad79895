//! The shape of a graph of particles on the host.

use super::{DEPTH, Family, FamilySystem, HostScalar, Number, Visitor, too_many, uniform_layer};
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::{Drag, Edge, Fixed, Graph, Kinetic, MAX_NETWORKS, Shape, Types};
use leastaction_core::forces::System;
use leastaction_core::linear::dot;
use leastaction_core::model::ModelError;
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

/// A massless rod of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Strut {
    /// What it hangs from: a node, or `None` for the origin.
    pub from: Option<u16>,
    /// The node at its other end.
    pub to: u16,
    /// Its length, m.
    pub length: f64,
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
    pub struts: Vec<Strut>,
}

impl NamedGraph {
    /// The rods as constraints in D dimensions.
    pub fn constraints<const D: usize>(&self) -> Vec<Holonomic<f64, D>> {
        self.struts.iter().map(constraint).collect()
    }
}

fn constraint<const D: usize>(strut: &Strut) -> Holonomic<f64, D> {
    let (node, length) = (usize::from(strut.to), strut.length);
    match strut.from {
        Some(from) => Holonomic::Rod { nodes: [node, from.into()], length },
        None => Holonomic::Anchor { node, to: [0.0; D], length },
    }
}

/// The shape of a graph model: its types, its graphs, and the graph that is meant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphArchitecture {
    /// Networks and types.
    pub shape: Shape,
    /// The names and numbers of the node types.
    pub types: Vec<NamedNodes>,
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
        self.graphs.get(self.graph).ok_or(ModelError::NoSuchTree { trees: self.graphs.len() })
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
        let widest = self.shape.networks().flat_map(|network| network.widths().0).max().unwrap_or(0);
        let deepest = self.shape.networks().map(|network| network.widths().1).max().unwrap_or(0);
        if widest > MAX_WIDTH {
            return too_many("units in a hidden layer", widest, MAX_WIDTH);
        }
        if deepest > DEPTH {
            return too_many("hidden layers", deepest, DEPTH);
        }
        if let Some(what) = self.shape.misfit() {
            return Err(ModelError::OutOfRange { what });
        }
        let short = ModelError::WeightCount { found: weights.len(), needed: self.parameters()? };
        Types::take(&mut { weights }, &self.shape).ok_or(short)
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
        let struts = self.0.graph().map_or(&[][..], |graph| &graph.struts);
        struts.iter().map(|strut| row(strut, q.as_chunks::<D>().0, v.as_chunks::<D>().0)).collect()
    }
}

/// ∂φ/∂q and (d/dt ∂φ/∂q) v of a rod, with φ = (|d|² − ℓ²)/(2ℓ) as core has it.
fn row<const D: usize, const N: usize>(strut: &Strut, q: &[[f64; D]], v: &[[f64; D]]) -> ([f64; N], f64) {
    let (to, from) = (usize::from(strut.to), strut.from.map(usize::from));
    let across = |x: &[[f64; D]]| -> [f64; D] {
        std::array::from_fn(|i| x[to][i] - from.map_or(0.0, |from| x[from][i]))
    };
    let (d, rate) = (across(q), across(v));
    let mut gradient = [0.0; N];
    for (i, d) in d.iter().enumerate() {
        gradient[D * to + i] = d / strut.length;
        if let Some(from) = from {
            gradient[D * from + i] = -d / strut.length;
        }
    }
    (gradient, dot(&rate, &rate) / strut.length)
}
