//! Values that can be written in several ways.

use leastaction_core::energy::graph::Separation;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Variable of an edge's potential.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SeparationKind {
    /// Distance r = |x_a − x_b|, m.
    #[default]
    Distance,
    /// Squared distance r², m²: smooth where the two ends meet.
    Squared,
}

impl From<SeparationKind> for Separation {
    fn from(kind: SeparationKind) -> Self {
        match kind {
            SeparationKind::Distance => Self::Distance,
            SeparationKind::Squared => Self::Squared,
        }
    }
}

/// An edge of a graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdgeConfig {
    /// Name of its type; `None` for the only type, in an edge written as a pair of nodes.
    pub kind: Option<String>,
    /// Numbers of the nodes that it joins, from 0.
    pub between: [u16; 2],
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    between: [u16; 2],
}

struct EdgeVisitor;

impl<'de> Visitor<'de> for EdgeVisitor {
    type Value = EdgeConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("two nodes, as [0, 1], or { type = \"spring\", between = [0, 1] }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, nodes: A) -> Result<EdgeConfig, A::Error> {
        Ok(EdgeConfig { kind: None, between: <[u16; 2]>::deserialize(SeqAccessDeserializer::new(nodes))? })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<EdgeConfig, A::Error> {
        let Table { kind, between } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(EdgeConfig { kind, between })
    }
}

impl<'de> Deserialize<'de> for EdgeConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(EdgeVisitor)
    }
}

impl Serialize for EdgeConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match &self.kind {
            None => self.between.serialize(to),
            Some(kind) => Table { kind: Some(kind.clone()), between: self.between }.serialize(to),
        }
    }
}

/// A massless rod.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RodConfig {
    /// Number of the node that it hangs from, from 0; `None` for the origin, written `"origin"`.
    #[serde(with = "origin")]
    pub from: Option<u16>,
    /// Number of the node at its other end.
    pub to: u16,
    /// Length ℓ > 0, m.
    pub length: f64,
}

/// Reader and writer of `"origin"` or the number of a node.
mod origin {
    use super::{Deserializer, Error, Serialize, Serializer, Unexpected, Visitor, fmt};

    const ORIGIN: &str = "origin";

    struct EndVisitor;

    impl Visitor<'_> for EndVisitor {
        type Value = Option<u16>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("\"origin\" or the number of a node, from 0")
        }

        fn visit_str<E: Error>(self, name: &str) -> Result<Option<u16>, E> {
            if name == ORIGIN { Ok(None) } else { Err(E::invalid_value(Unexpected::Str(name), &self)) }
        }

        fn visit_i64<E: Error>(self, node: i64) -> Result<Option<u16>, E> {
            let number = u16::try_from(node).map_err(|_| E::invalid_value(Unexpected::Signed(node), &self));
            number.map(Some)
        }
    }

    pub fn serialize<S: Serializer>(from: &Option<u16>, to: S) -> Result<S::Ok, S::Error> {
        match from {
            None => to.serialize_str(ORIGIN),
            Some(node) => node.serialize(to),
        }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u16>, D::Error> {
        from.deserialize_any(EndVisitor)
    }
}
