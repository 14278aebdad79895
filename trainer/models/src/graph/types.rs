//! Types of nodes and edges by their names, and graphs of them.

use crate::number::Number;
use leastaction_core::constraints::Holonomic;
use leastaction_core::energy::graph::Edge;
use leastaction_core::model::{GraphLayout, Rod};
use serde::{Deserialize, Serialize};

/// The name and numbers of a node type or an edge type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GraphType {
    /// Name.
    pub name: String,
    /// In the order of the weight block: mass, drag, field, kinetic embedding, embedding of a node type; c₁ and c₂ of an edge type.
    pub numbers: Vec<Number>,
}

impl GraphType {
    /// Types by their names, separated by commas, with known numbers.
    pub(super) fn known(names: &str, numbers: &[f64], stride: usize) -> Vec<Self> {
        let named = |(name, numbers): (&str, &[f64])| Self {
            name: name.to_owned(),
            numbers: numbers.iter().copied().map(Number::known).collect(),
        };
        names.split(',').zip(numbers.chunks_exact(stride)).map(named).collect()
    }
}

/// A graph by its name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedGraph {
    /// Name.
    pub name: String,
    /// The type of every node.
    pub nodes: Vec<u8>,
    /// The edges.
    pub edges: Vec<Edge>,
    /// The rods, which are known and not learned.
    pub rods: Vec<Rod>,
}

impl NamedGraph {
    /// The largest distance in the list between two rods that share a node: the band of A M⁻¹ Aᵀ.
    pub fn band(&self) -> usize {
        let ends = |rod: &Rod| [rod.from, Some(rod.to)];
        let share = |a: &Rod, b: &Rod| ends(a).iter().flatten().any(|end| ends(b).contains(&Some(*end)));
        let later = |k: usize, rod: &Rod| self.rods.iter().skip(k + 1).rposition(|other| share(rod, other));
        self.rods.iter().enumerate().filter_map(|(k, rod)| Some(later(k, rod)? + 1)).max().unwrap_or(0)
    }

    /// The rods as constraints in D dimensions.
    pub fn constraints<const D: usize>(&self) -> Vec<Holonomic<f64, D>> {
        self.rods.iter().map(Rod::constraint).collect()
    }

    pub(super) fn from_layout(layout: &GraphLayout) -> Self {
        let (name, nodes) = (layout.name.to_owned(), layout.nodes.to_vec());
        Self { name, nodes, edges: layout.edges().collect(), rods: layout.rods().collect() }
    }
}
