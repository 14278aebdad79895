//! Values that can be written in several ways.

use leastaction_core::energy::bodies::Joint;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Kind of joint between a body and its parent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// Rotation.
    #[default]
    Revolute,
    /// Translation along x.
    Prismatic,
}

impl From<JointKind> for Joint {
    fn from(kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => Self::Revolute,
            JointKind::Prismatic => Self::Prismatic,
        }
    }
}

/// A number of a body: `0.3` is known, `{ learn = 0.3 }` is learned from that start, `"learned"` from a usual value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyNumber {
    /// Known value.
    Known(f64),
    /// Learned, starting at this value or at a usual one.
    Learned(Option<f64>),
}

const WORD: &str = "learned";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Start {
    learn: f64,
}

struct NumberVisitor;

impl<'de> Visitor<'de> for NumberVisitor {
    type Value = BodyNumber;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, as 0.3, or \"learned\", or { learn = 0.3 }")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<BodyNumber, E> {
        Ok(BodyNumber::Known(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<BodyNumber, E> {
        Ok(BodyNumber::Known(value as f64))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<BodyNumber, E> {
        let learned = (word == WORD).then_some(BodyNumber::Learned(None));
        learned.ok_or_else(|| E::invalid_value(Unexpected::Str(word), &self))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<BodyNumber, A::Error> {
        let Start { learn } = Start::deserialize(MapAccessDeserializer::new(map))?;
        Ok(BodyNumber::Learned(Some(learn)))
    }
}

impl<'de> Deserialize<'de> for BodyNumber {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberVisitor)
    }
}

impl Serialize for BodyNumber {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Known(value) => to.serialize_f64(value),
            Self::Learned(None) => to.serialize_str(WORD),
            Self::Learned(Some(learn)) => Start { learn }.serialize(to),
        }
    }
}
