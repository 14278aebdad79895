//! `stops` of a model whose coordinates run against end stops.

use crate::config::parts::Range;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::laws::group::GroupLaws;
use crate::laws::numbers::{GroupNumber, GroupNumbers, Rule};
use crate::number::Number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// End stops that no coordinate passes; all numbers are known. `stops = "limits"` takes the limits of the robot's description.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StopsConfig {
    /// Lower stop, m or rad; -inf, with an upper one of inf, where a coordinate has none. (Default: the limit in the robot's description.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower: Option<GroupNumbers>,
    /// Upper stop, above the lower one. (Default: the limit in the robot's description.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub upper: Option<GroupNumbers>,
    /// Restitution: speed after over speed before a strike, 0 to 1. (Default: 0.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restitution: Option<GroupNumbers>,
}

/// End stops of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopNumbers {
    /// Lower position, m or rad.
    pub lower: f64,
    /// Upper position.
    pub upper: f64,
    /// Restitution, 0 to 1.
    pub restitution: f64,
}

/// Half a distance, m or rad, from which on no motion reaches the stops.
const OUT_OF_REACH: f64 = 1e30;

impl StopNumbers {
    /// Stops with these numbers of a model file; `None` if they are out of reach.
    pub(crate) fn of(numbers: &[f64]) -> Option<Self> {
        let [centre, half, restitution] = *numbers.first_chunk()?;
        (half < OUT_OF_REACH).then_some(Self { lower: centre - half, upper: centre + half, restitution })
    }
}

/// End stops that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StopsProblem {
    /// A lower stop that is not below the upper one.
    #[error("the lower stop, {lower}, is not below the upper one, {upper}")]
    Order {
        /// The lower stop, m or rad.
        lower: f64,
        /// The upper stop.
        upper: f64,
    },
    /// A stop on one side only.
    #[error(
        "a coordinate has two stops or none: put the other one, which is {given}, where the motion does not reach it"
    )]
    OneSided {
        /// The infinite position.
        given: f64,
    },
    /// A stop that neither the configuration nor a description of the robot gives.
    #[error("`{key}` is missing: this family has no description of a robot whose limits could stand for it")]
    Missing {
        /// The key.
        key: &'static str,
    },
}

const ANYWHERE: Range =
    Range { infinite: true, ..Range::finite(|x| !x.is_nan(), "a number; inf where there is no stop") };
const LOWER: Rule = rule("lower", ANYWHERE);
const UPPER: Rule = rule("upper", ANYWHERE);
const RESTITUTION: Rule = rule("restitution", Range::finite(|x| (0.0..=1.0).contains(&x), "between 0 and 1"));

const fn rule(key: &'static str, known: Range) -> Rule {
    Rule { table: "stops", key, known, start: Range::ANY, default: 0.0, part: None }
}

impl StopsConfig {
    /// Adds the stops of groups of coordinates to other laws; `what` is the word for a group, and `limits` are those in the description of a
    /// robot, if there is one.
    ///
    /// # Errors
    /// [`ShapeError`]: a number that is learned or out of its range, a list of the wrong length, or stops that cannot be.
    pub(crate) fn assemble(
        config: Option<&Self>,
        (groups, what): (usize, &'static str),
        limits: Option<&[[f64; 2]]>,
        mut laws: GroupLaws,
    ) -> Result<GroupLaws, ShapeError> {
        let Some(Self { lower, upper, restitution }) = config else { return Ok(laws) };
        let of = |rule: &Rule, given: &GroupNumbers| -> Result<Vec<f64>, ShapeError> {
            if !given.are_known() {
                return Err(rule.at(None, Problem::NeverLearned { key: rule.key }));
            }
            Ok(given.assemble(rule, groups, what)?.iter().map(|number| number.value).collect())
        };
        let stop = |rule: &Rule, given: &Option<GroupNumbers>, end: usize| match (given, limits) {
            (Some(given), _) => of(rule, given),
            (None, Some(limits)) => Ok(limits.iter().map(|limits| limits[end]).collect()),
            (None, None) => Err(rule.at(None, StopsProblem::Missing { key: rule.key }.into())),
        };
        let (lower, upper) = (stop(&LOWER, lower, 0)?, stop(&UPPER, upper, 1)?);
        let none = GroupNumbers::All(GroupNumber::Known(0.0));
        let restitution = of(&RESTITUTION, restitution.as_ref().unwrap_or(&none))?;
        for (group, restitution) in restitution.into_iter().enumerate() {
            let [centre, half] = about([lower[group], upper[group]])
                .map_err(|problem| LOWER.at((groups > 1).then_some(group), problem.into()))?;
            laws.stops.extend([centre, half, restitution].map(Number::known));
        }
        Ok(laws)
    }
}

/// Middle and half the distance of two stops; out of reach if both are infinite.
fn about([lower, upper]: [f64; 2]) -> Result<[f64; 2], StopsProblem> {
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) if (lower as f32) < upper as f32 => Ok([0.5 * (lower + upper), 0.5 * (upper - lower)]),
        (false, false) if lower < upper => Ok([0.0, f32::MAX.into()]),
        (false, true) => Err(StopsProblem::OneSided { given: lower }),
        (true, false) => Err(StopsProblem::OneSided { given: upper }),
        _ => Err(StopsProblem::Order { lower, upper }),
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    lower: Option<GroupNumbers>,
    upper: Option<GroupNumbers>,
    restitution: Option<GroupNumbers>,
}

/// Word for the limits of the robot's description.
const LIMITS: &str = "limits";

struct ConfigVisitor;

impl<'de> Visitor<'de> for ConfigVisitor {
    type Value = StopsConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table, as { lower = -0.3, upper = 0.3, restitution = 0.2 }, or \"limits\"")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LIMITS {
            Ok(StopsConfig::default())
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Table { lower, upper, restitution } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(StopsConfig { lower, upper, restitution })
    }
}

impl<'de> Deserialize<'de> for StopsConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ConfigVisitor)
    }
}

/// `stops` of a family whose coordinates have none; reading it gives the error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NoStops;

impl<'de> Deserialize<'de> for NoStops {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom("a graph has no end stops of its coordinates"))
    }
}
