//! `[model]` of the graph family: node types, edge types, and graphs of them.

mod assemble;
mod values;

pub use values::{EdgeConfig, RodConfig, SeparationKind};

use crate::architecture::Architecture;
use crate::config::family::{FamilyConfig, NetworksBeside};
use crate::config::fields;
use crate::config::origin::Open;
use crate::config::parts::NumberConfig;
use crate::config::place::ShapeError;
use crate::laws::corrections::config::NoCorrections;
use crate::laws::friction::config::NoFriction;
use crate::laws::stops::NoStops;
use leastaction_core::network::Activation;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Node types, edge types, graphs of them, and the graph that the data belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "family", rename = "graph")]
pub struct GraphConfig {
    /// Dimension of space, 2 or 3.
    #[serde(default = "plane", deserialize_with = "fields::dimension")]
    pub dimension: u8,
    /// Name of the graph that the data belongs to; it may be left out if there is only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<String>,
    /// Node types.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub node_types: Vec<NodeTypeConfig>,
    /// Edge types.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edge_types: Vec<EdgeTypeConfig>,
    /// Graphs by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub graphs: BTreeMap<String, LayoutConfig>,
    /// Not accepted for graphs: their node types have drag instead.
    #[serde(default, skip_serializing)]
    friction: NoFriction,
    /// Not accepted for graphs.
    #[serde(default, skip_serializing)]
    stops: NoStops,
    /// Not accepted for graphs.
    #[serde(default, skip_serializing)]
    dissipation: NoCorrections,
    /// Not accepted for graphs.
    #[serde(default, skip_serializing)]
    potential: NoCorrections,
}

fn plane() -> u8 {
    2
}

/// A node type: T = ½m|v|², V = g·x + network(x), Q = −(c + |network(v_i)|)v_i along each axis i.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeTypeConfig {
    /// Name.
    pub name: String,
    /// Mass m > 0, kg. (Default: 1.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<NumberConfig>,
    /// Uniform field g, N, one number for each dimension; it pulls with −g. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<NumberConfig<Vec<f64>>>,
    /// Hidden units of a network for the potential, a function of the position. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub potential: Option<Vec<u16>>,
    /// Viscous drag c ≥ 0, N s/m. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drag: Option<NumberConfig>,
    /// Hidden units of a network for drag that is not proportional to the velocity. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub drag_network: Option<Vec<u16>>,
    /// Activation of all hidden layers of the type. (Default: squareplus.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
}

/// An edge type: U = c₁z + c₂z² + network(z), where z is a function of the distance between its ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EdgeTypeConfig {
    /// Name.
    pub name: String,
    /// The variable z.
    #[serde(default)]
    pub sees: SeparationKind,
    /// Coefficients c₁ and c₂. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<NumberConfig<[f64; 2]>>,
    /// Hidden units of a network for the potential, a function of z. (Default: none.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub potential: Option<Vec<u16>>,
    /// Activation of the hidden layers. (Default: squareplus.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
}

/// A graph.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutConfig {
    /// Names of the types of all nodes.
    #[serde(default)]
    pub nodes: Vec<String>,
    /// Learned interactions between two nodes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<EdgeConfig>,
    /// Known rods that keep two nodes, or a node and the origin, at a fixed distance.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rods: Vec<RodConfig>,
}

impl FamilyConfig for GraphConfig {
    fn defaults() -> &'static str {
        include_str!("../config.toml")
    }

    fn networks(&mut self) -> Option<NetworksBeside<'_>> {
        None
    }

    fn architecture(&self, _open: Open) -> Result<Architecture, ShapeError> {
        self.assemble().map(Into::into)
    }

    fn beginning(&self, seed: u64, _open: Open) -> Result<(Architecture, Vec<f64>), ShapeError> {
        let architecture = self.assemble()?;
        let weights = architecture.beginning(seed);
        Ok((architecture.into(), weights))
    }
}
