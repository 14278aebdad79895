//! `servo` of a model whose commands are positions.

use crate::config::parts::Range;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::laws::group::GroupLaws;
use crate::laws::numbers::{GroupNumber, GroupNumbers, LEARNED, Rule};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Servos whose commands u are positions: τ = k (u − q) − d v. `servo = "learned"` means that both numbers are learned.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ServoConfig {
    /// Stiffness k, N/m or N m/rad. (Default: learned, starting at force over deflection of the log.)
    pub stiffness: GroupNumbers,
    /// Damping d, N s/m or N m s/rad, which is viscous friction. (Default: that of `friction`; without it learned, starting at 0.3 of force
    /// over speed of the log.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping: Option<GroupNumbers>,
}

const STIFFNESS: Rule = rule("stiffness", (10.0, 1.0));
const DAMPING: Rule = rule("damping", (1.0, 0.3));

const fn rule(key: &'static str, (default, part): (f64, f64)) -> Rule {
    let (table, known, start) = ("servo", Range::NOT_BELOW, Rule::ABOVE);
    Rule { table, key, known, start, default, part: Some(part) }
}

impl ServoConfig {
    /// Stiffness and damping, both learned.
    pub fn learned() -> Self {
        Self { stiffness: GroupNumbers::All(GroupNumber::Learned), damping: None }
    }

    /// Adds the servos of `groups` groups of coordinates, and their damping, to the laws of friction; `what` is the word for a group.
    ///
    /// # Errors
    /// [`ShapeError`]: a number out of its range, a list of the wrong length, damping that is also given as friction, or friction that
    /// grows with the load, which positions as commands do not give.
    pub(crate) fn assemble(
        config: Option<&Self>,
        (groups, what): (usize, &'static str),
        mut laws: GroupLaws,
    ) -> Result<GroupLaws, ShapeError> {
        let Some(Self { stiffness, damping }) = config else { return Ok(laws) };
        if laws.grows() {
            return Err(STIFFNESS.at(None, Problem::LoadOfServo));
        }
        match (damping, !laws.damps()) {
            (Some(_), false) => {
                return Err(DAMPING.at(None, Problem::DampingTwice { key: "friction.viscous" }));
            }
            (None, false) => {}
            (damping, true) => {
                let learned = GroupNumbers::All(GroupNumber::Learned);
                laws.viscous = damping.as_ref().unwrap_or(&learned).assemble(&DAMPING, groups, what)?;
            }
        }
        laws.servo = stiffness.assemble(&STIFFNESS, groups, what)?;
        Ok(laws)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    stiffness: Option<GroupNumbers>,
    damping: Option<GroupNumbers>,
}

struct ConfigVisitor;

impl<'de> Visitor<'de> for ConfigVisitor {
    type Value = ServoConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\", or a table with stiffness and damping")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LEARNED {
            Ok(ServoConfig::learned())
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Table { stiffness, damping } = Table::deserialize(MapAccessDeserializer::new(map))?;
        let stiffness = stiffness.unwrap_or(GroupNumbers::All(GroupNumber::Learned));
        Ok(ServoConfig { stiffness, damping })
    }
}

impl<'de> Deserialize<'de> for ServoConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ConfigVisitor)
    }
}
