//! `[model.friction]` of any family whose coordinates allow it.

use crate::config::parts::Range;
use crate::config::place::{ShapeError, Step};
use crate::config::problem::Problem;
use crate::laws::friction::{FrictionArchitecture, MOST_LOAD, WIDTHS};
use crate::number::Number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Friction of the coordinates, Q = −(b v + (c + c_load (√(τ² + τ_s²) − τ_s)) tanh(v/ε)); a part that is left out is absent. `friction =
/// "learned"` means that `viscous` and `coulomb` are learned.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrictionConfig {
    /// Viscous damping b, N s/m or N m s/rad. (Start if learned: 0.01.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous: Option<FrictionNumbers>,
    /// Coulomb friction c, N or N m. (Start if learned: 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<FrictionNumbers>,
    /// Growth c_load of friction with the load. (Start if learned: 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<FrictionNumbers>,
    /// Width ε of the change of sign, m/s or rad/s. (Default with dry friction: learned, starting at 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<FrictionNumbers>,
    /// Smoothing load τ_s, N or N m. (Start if learned: 0.1. Default with dry friction: known, 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<FrictionNumbers>,
}

/// One number for all coordinates, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum FrictionNumbers {
    /// One number for all of them; if it is learned, the coordinates end up with different values.
    All(FrictionNumberConfig),
    /// One number per coordinate of an inertia network or of bodies, or per element type.
    Each(Vec<FrictionNumberConfig>),
}

/// A number of friction: `"learned"`, `0.1`, or `{ learn = 0.1 }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionNumberConfig {
    /// Learned, starting at the documented default.
    Learned,
    /// Learned, starting at this value.
    LearnedFrom(f64),
    /// Known value.
    Known(f64),
}

const LEARNED: &str = "learned";

/// A key with its allowed numbers, both for known values and for starting values.
struct Rule {
    key: &'static str,
    known: Range,
    start: Range,
    /// Start of learning if none is given.
    default: f64,
}

const ABOVE_WORDS: &str = "a finite number above 0 where it is learned";

/// Rules for b, c, c_load, τ_s and ε.
const RULES: [Rule; 5] = {
    const START: Range = Range { holds: |x| x > 0.0, words: ABOVE_WORDS };
    [
        Rule { key: "viscous", known: Range::NOT_BELOW, start: START, default: 0.01 },
        Rule { key: "coulomb", known: Range::NOT_BELOW, start: START, default: 0.1 },
        Rule {
            key: "load",
            known: Range { holds: |x| (0.0..1.0).contains(&x), words: "0 or above and below 1" },
            start: Range {
                holds: |x| x > 0.0 && x < MOST_LOAD as f32,
                words: "above 0 and below 0.95 where it is learned",
            },
            default: 0.1,
        },
        Rule { key: "smoothing", known: Range::ABOVE, start: START, default: 0.1 },
        Rule {
            key: "width",
            known: Range::ABOVE,
            start: Range {
                holds: |x| x > WIDTHS[0] as f32 && x < WIDTHS[1] as f32,
                words: "above 0.02 and below 1 where it is learned",
            },
            default: 0.1,
        },
    ]
};

impl FrictionNumberConfig {
    fn number(self, rule: &Rule) -> Result<Number, Problem> {
        match self {
            Self::Learned => Ok(Number::learned(rule.default)),
            Self::LearnedFrom(start) => rule.start.number(rule.key, start, true),
            Self::Known(value) => rule.known.number(rule.key, value, false),
        }
    }
}

impl FrictionConfig {
    /// Whether there is no friction.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Damping and dry friction, both learned.
    fn learned() -> Self {
        let learned = Some(FrictionNumbers::All(FrictionNumberConfig::Learned));
        Self { viscous: learned.clone(), coulomb: learned, ..Self::default() }
    }

    /// Returns the friction of `groups` groups of coordinates; `what` is the word for a group.
    ///
    /// # Errors
    /// [`ShapeError`]: a number out of its range, a list of the wrong length, or a key without a meaning.
    pub(crate) fn assemble(
        &self,
        groups: usize,
        what: &'static str,
    ) -> Result<FrictionArchitecture, ShapeError> {
        let [viscous, coulomb, load, smoothing, width] = &RULES;
        let of = |rule: &Rule, given: &Option<FrictionNumbers>, absent: Number| match given {
            None => Ok(vec![absent; groups]),
            Some(given) => given.assemble(rule, groups, what),
        };
        let is_dry = self.coulomb.is_some() || self.load.is_some();
        for (key, given) in [("width", &self.width), ("smoothing", &self.smoothing)] {
            if given.is_some() && !is_dry {
                return Err(at(key, None, Problem::NoDryFriction { key }));
            }
        }
        let mut friction = FrictionArchitecture::default();
        if self.viscous.is_some() {
            friction.viscous = of(viscous, &self.viscous, Number::known(0.0))?;
        }
        if is_dry {
            let constant = of(coulomb, &self.coulomb, Number::known(0.0))?;
            let load = of(load, &self.load, Number::known(0.0))?;
            let smoothing = of(smoothing, &self.smoothing, Number::known(smoothing.default))?;
            let width = of(width, &self.width, Number::learned(width.default))?;
            friction.dry = (0..groups).map(|i| [constant[i], load[i], smoothing[i], width[i]]).collect();
        }
        Ok(friction)
    }

    /// Refuses damping that is also given by another key.
    pub(crate) fn check_damping(&self, key: &'static str, is_given: bool) -> Result<(), ShapeError> {
        if is_given && self.viscous.is_some() {
            return Err(at("viscous", None, Problem::DampingTwice { key }));
        }
        Ok(())
    }
}

impl FrictionNumbers {
    fn assemble(&self, rule: &Rule, groups: usize, what: &'static str) -> Result<Vec<Number>, ShapeError> {
        match self {
            Self::All(one) => {
                let number = one.number(rule).map_err(|problem| at(rule.key, None, problem))?;
                Ok(vec![number; groups])
            }
            Self::Each(each) if each.len() != groups => {
                let (key, found) = (rule.key, each.len());
                Err(at(key, None, Problem::FrictionCount { key, found, needed: groups, what }))
            }
            Self::Each(each) => {
                let numbers = each.iter().enumerate();
                let number = |(i, one): (usize, &FrictionNumberConfig)| {
                    one.number(rule).map_err(|problem| at(rule.key, Some(i), problem))
                };
                numbers.map(number).collect()
            }
        }
    }
}

fn at(key: &str, index: Option<usize>, problem: Problem) -> ShapeError {
    let mut place: Vec<Step> = ["model", "friction", key].map(Step::from).into();
    place.extend(index.map(Step::from));
    ShapeError { place, problem }
}

impl Serialize for FrictionNumbers {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(one) => one.serialize(to),
            Self::Each(each) => each.serialize(to),
        }
    }
}

impl Serialize for FrictionNumberConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Learned => to.serialize_str(LEARNED),
            Self::Known(value) => to.serialize_f64(*value),
            Self::LearnedFrom(start) => {
                let mut table = to.serialize_map(Some(1))?;
                table.serialize_entry("learn", start)?;
                table.end()
            }
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Start {
    learn: f64,
}

struct NumberVisitor;

impl<'de> Visitor<'de> for NumberVisitor {
    type Value = FrictionNumberConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\", a number, as 0.1, or { learn = 0.1 }")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LEARNED {
            Ok(FrictionNumberConfig::Learned)
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(FrictionNumberConfig::Known(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Start { learn } = Start::deserialize(MapAccessDeserializer::new(map))?;
        Ok(FrictionNumberConfig::LearnedFrom(learn))
    }
}

impl<'de> Deserialize<'de> for FrictionNumberConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberVisitor)
    }
}

struct NumbersVisitor;

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = FrictionNumbers;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        NumberVisitor.expecting(f)?;
        f.write_str(", or a list of them")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LEARNED {
            NumberVisitor.visit_str(word).map(FrictionNumbers::All)
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        NumberVisitor.visit_f64(value).map(FrictionNumbers::All)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        NumberVisitor.visit_i64(value).map(FrictionNumbers::All)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        NumberVisitor.visit_map(map).map(FrictionNumbers::All)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut each = Vec::new();
        while let Some(one) = list.next_element()? {
            each.push(one);
        }
        Ok(FrictionNumbers::Each(each))
    }
}

impl<'de> Deserialize<'de> for FrictionNumbers {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumbersVisitor)
    }
}

/// Contents of the table `[model.friction]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    viscous: Option<FrictionNumbers>,
    coulomb: Option<FrictionNumbers>,
    load: Option<FrictionNumbers>,
    width: Option<FrictionNumbers>,
    smoothing: Option<FrictionNumbers>,
}

struct ConfigVisitor;

impl<'de> Visitor<'de> for ConfigVisitor {
    type Value = FrictionConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\", or a table with viscous, coulomb, load, width and smoothing")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LEARNED {
            Ok(FrictionConfig::learned())
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Table { viscous, coulomb, load, width, smoothing } =
            Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(FrictionConfig { viscous, coulomb, load, width, smoothing })
    }
}

impl<'de> Deserialize<'de> for FrictionConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ConfigVisitor)
    }
}

/// `friction` of a family whose coordinates allow none; reading it gives the error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NoFriction;

impl<'de> Deserialize<'de> for NoFriction {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom("a graph has no friction of its coordinates; give its node types `drag`"))
    }
}
