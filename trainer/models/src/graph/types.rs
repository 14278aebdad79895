//! Types of nodes and edges by their names, and graphs of them.

use crate::number::Number;
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::Edge;
use leastaction_core::model::{GraphLayout, Rod};
use serde::{Deserialize, Serialize};

/// Name and numbers of a node type or an edge type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphType {
    /// Name.
    pub name: String,
    /// Numbers in the order of the weight block. For a node type: mass, drag, field, kinetic embedding, embedding. For
    /// an edge type: c₁ and c₂.
    pub numbers: Vec<Number>,
}

impl GraphType {
    /// Returns the types of a comma-separated list of names, with known numbers.
    pub(super) fn known(names: &str, numbers: &[f64], stride: usize) -> Vec<Self> {
        let named = |(name, numbers): (&str, &[f64])| Self {
            name: name.to_owned(),
            numbers: numbers.iter().copied().map(Number::known).collect(),
        };
        names.split(',').zip(numbers.chunks_exact(stride)).map(named).collect()
    }
}

/// A graph with its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedGraph {
    /// Name.
    pub name: String,
    /// Numbers of the types of all nodes.
    pub nodes: Vec<u8>,
    /// Edges of the graph.
    pub edges: Vec<Edge>,
    /// Rods of the graph, which are known and not learned.
    pub rods: Vec<Rod>,
}

impl NamedGraph {
    /// Largest distance, in the list of rods, between two rods that share a node: the bandwidth of A M⁻¹ Aᵀ.
    pub fn band(&self) -> usize {
        let ends = |rod: &Rod| [rod.from, Some(rod.to)];
        let share = |a: &Rod, b: &Rod| ends(a).iter().flatten().any(|end| ends(b).contains(&Some(*end)));
        let later = |k: usize, rod: &Rod| self.rods.iter().skip(k + 1).rposition(|other| share(rod, other));
        self.rods.iter().enumerate().filter_map(|(k, rod)| Some(later(k, rod)? + 1)).max().unwrap_or(0)
    }

    /// Rods as constraints in D dimensions.
    pub fn constraints<const D: usize>(&self) -> Vec<Holonomic<f64, D>> {
        self.rods.iter().map(Rod::constraint).collect()
    }

    pub(super) fn from_layout(layout: &GraphLayout) -> Self {
        let (name, nodes) = (layout.name.to_owned(), layout.nodes.to_vec());
        Self { name, nodes, edges: layout.edges().collect(), rods: layout.rods().collect() }
    }
}
