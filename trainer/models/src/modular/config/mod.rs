//! `[model]` of the modular family: element types, and trees of them.

mod assemble;
mod assembled;
mod assembly;
mod numbers;
mod source;
mod values;

pub use assembled::Assembled;
pub use values::{ElementConfig, PairKind, TransformKind};

use crate::config::fields;
use crate::config::parts::NumberConfig;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::laws::corrections::config::{DissipationConfig, PotentialConfig};
use crate::laws::friction::config::FrictionConfig;
use crate::laws::stops::StopsConfig;
use leastaction_core::network::Activation;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Element types, trees of them, and the tree that the data belongs to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, tag = "family", rename = "modular")]
pub struct ModularConfig {
    /// Run or model file whose types, numbers and trees are taken, and with whose weights training begins; relative to
    /// the configuration file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<PathBuf>,
    /// Name of the tree that the data belongs to; it may be left out if there is only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tree: Option<String>,
    /// Element types.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub types: Vec<TypeConfig>,
    /// Potential that every pair of elements adds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<PairConfig>,
    /// Trees by their names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub trees: BTreeMap<String, Vec<ElementConfig>>,
    /// Friction of the coordinates of every element type, damping included.
    #[serde(default, skip_serializing_if = "FrictionConfig::is_none")]
    pub friction: FrictionConfig,
    /// End stops, which no coordinate of an element type passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stops: Option<StopsConfig>,
    /// Network that dissipates energy; its coordinates are those of the trees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipation: Option<DissipationConfig>,
    /// Network that is added to the potential.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub potential: Option<PotentialConfig>,
}

/// An element type. Keys that are left out have their defaults; for a trained type they leave the type unchanged.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TypeConfig {
    /// Name.
    pub name: String,
    /// Kind of motion by its coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformKind>,
    /// Hidden units of a learned position; an empty list makes it linear in the features. (Default: 16.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub position: Option<Vec<u16>>,
    /// Hidden units of a separate velocity network; without it the velocity is the exact derivative of the position.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub velocity: Option<Vec<u16>>,
    /// Hidden units of the element's potential; without it there is none.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub potential: Option<Vec<u16>>,
    /// Activation of all hidden layers of the type. (Default: tanh.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
    /// Mass m > 0, kg. (Default: 1.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<NumberConfig>,
    /// Moment of inertia about the centre, ≥ 0, kg m². (Default: 0.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<NumberConfig>,
    /// Position of the centre, from 0 (at the parent) to 1 (at the children). (Default: 1.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre: Option<NumberConfig>,
    /// Length of a rod, > 0, m. (Default: 1.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<NumberConfig>,
    /// Viscous damping of its coordinates, ≥ 0, N s/m or N m s/rad. (Default: 0.)
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<NumberConfig>,
}

/// The pair potential.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairConfig {
    /// Input of the network, computed from the two positions.
    #[serde(default)]
    pub input: PairKind,
    /// Hidden units. (Default: 16.)
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_widths")]
    pub hidden: Option<Vec<u16>>,
    /// Activation of the hidden layers. (Default: tanh.)
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::activation_name")]
    pub activation: Option<Activation>,
}
