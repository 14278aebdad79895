//! Values that can be written in several ways.

use leastaction_core::energy::modular::{Input, PairInput};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Kind of motion that the coordinates of a type give its elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TransformKind {
    /// Learned, from (cos q, sin q).
    Angle,
    /// Learned, from q.
    Translation,
    /// Learned, from q wrapped to [0, 2π).
    WrappedAngle,
    /// Known: on a rod that turns about a pivot.
    Rod,
    /// Known: along the horizontal.
    Slide,
    /// Known: anywhere in the plane; two coordinates.
    Free,
}

impl TransformKind {
    /// Word for it in a configuration.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Translation => "translation",
            Self::WrappedAngle => "wrapped-angle",
            Self::Rod => "rod",
            Self::Slide => "slide",
            Self::Free => "free",
        }
    }

    /// Input of the network, if the motion is learned.
    pub(super) const fn input(self) -> Option<Input> {
        match self {
            Self::Angle => Some(Input::Angle),
            Self::Translation => Some(Input::Translation),
            Self::WrappedAngle => Some(Input::WrappedAngle),
            Self::Rod | Self::Slide | Self::Free => None,
        }
    }

    /// Whether its elements turn.
    pub(super) const fn turns(self) -> bool {
        matches!(self, Self::Angle | Self::WrappedAngle | Self::Rod)
    }
}

/// Input of the pair potential.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairKind {
    /// Both positions.
    Concat,
    /// Difference of the positions.
    Difference,
    /// Distance of the positions.
    #[default]
    Distance,
    /// Reciprocal of the distance.
    InverseDistance,
}

impl From<PairKind> for PairInput {
    fn from(kind: PairKind) -> Self {
        match kind {
            PairKind::Concat => Self::Concat,
            PairKind::Difference => Self::Difference,
            PairKind::Distance => Self::Distance,
            PairKind::InverseDistance => Self::InverseDistance,
        }
    }
}

/// An element of a tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ElementConfig {
    /// `"bob"`: hangs from the element before it, or from the ground if it is a free point.
    Next(
        /// Name of the type.
        String,
    ),
    /// `{ type = "bob", on = 0 }`.
    On {
        /// Name of the type.
        kind: String,
        /// Number of the element that it hangs from, from 0; `None` for the ground.
        on: Option<u64>,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(rename = "type")]
    kind: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    on: Option<u64>,
}

struct ElementVisitor;

impl<'de> Visitor<'de> for ElementVisitor {
    type Value = ElementConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a type, as \"bob\", or { type = \"bob\", on = 0 }")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<ElementConfig, E> {
        Ok(ElementConfig::Next(name.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ElementConfig, A::Error> {
        let Table { kind, on } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(ElementConfig::On { kind, on })
    }
}

impl<'de> Deserialize<'de> for ElementConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ElementVisitor)
    }
}

impl Serialize for ElementConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Next(name) => to.serialize_str(name),
            Self::On { kind, on } => Table { kind: kind.clone(), on: *on }.serialize(to),
        }
    }
}
