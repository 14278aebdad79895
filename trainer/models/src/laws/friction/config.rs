//! `[model.friction]` of any family whose coordinates allow it.

use crate::config::parts::Range;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::laws::friction::{FrictionArchitecture, MOST_LOAD};
use crate::laws::numbers::{GroupNumber, GroupNumbers, LEARNED, Rule};
use crate::number::Number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Friction of the coordinates, Q = −(b v + (c + c_load (√(τ² + τ_s²) − τ_s)) tanh(v/ε)); a part that is left out is absent. `friction =
/// "learned"` means that `viscous` and `coulomb` are learned.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrictionConfig {
    /// Viscous damping b, N s/m or N m s/rad. (Start if learned: 0.02 of force over speed of the log.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous: Option<GroupNumbers>,
    /// Coulomb friction c, N or N m. (Start if learned: 0.03 of the log's force.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<GroupNumbers>,
    /// Growth c_load of friction with the load. (Start if learned: 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<GroupNumbers>,
    /// Width ε of the change of sign, m/s or rad/s. (Default with dry friction: learned, starting at 0.05 of the log's speed.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<GroupNumbers>,
    /// Smoothing load τ_s, N or N m. (Default with dry friction: known; 0.02 of the log's force, which is also the start if it is learned.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<GroupNumbers>,
}

/// Rules for b, c, c_load, τ_s and ε.
const RULES: [Rule; 5] = {
    const START: Range = Rule::ABOVE;
    let table = "friction";
    [
        Rule {
            table,
            key: "viscous",
            known: Range::NOT_BELOW,
            start: START,
            default: 0.01,
            part: Some(0.02),
        },
        Rule { table, key: "coulomb", known: Range::NOT_BELOW, start: START, default: 0.1, part: Some(0.03) },
        Rule {
            table,
            key: "load",
            known: Range { holds: |x| (0.0..1.0).contains(&x), words: "0 or above and below 1" },
            start: Range {
                holds: |x| x > 0.0 && x < MOST_LOAD as f32,
                words: "above 0 and below 0.95 where it is learned",
            },
            default: 0.1,
            part: None,
        },
        Rule { table, key: "smoothing", known: Range::ABOVE, start: START, default: 0.1, part: Some(0.02) },
        Rule { table, key: "width", known: Range::ABOVE, start: START, default: 0.1, part: Some(0.05) },
    ]
};

impl FrictionConfig {
    /// Whether there is no friction.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Damping and dry friction, both learned.
    fn learned() -> Self {
        let learned = Some(GroupNumbers::All(GroupNumber::Learned));
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
        let of = |rule: &Rule, given: &Option<GroupNumbers>, absent: Number| match given {
            None => Ok(vec![absent; groups]),
            Some(given) => given.assemble(rule, groups, what),
        };
        let is_dry = self.coulomb.is_some() || self.load.is_some();
        for (rule, given) in [(width, &self.width), (smoothing, &self.smoothing)] {
            if given.is_some() && !is_dry {
                return Err(rule.at(None, Problem::NoDryFriction { key: rule.key }));
            }
        }
        let mut friction = FrictionArchitecture::default();
        if self.viscous.is_some() {
            friction.viscous = of(viscous, &self.viscous, Number::known(0.0))?;
        }
        if is_dry {
            let constant = of(coulomb, &self.coulomb, Number::known(0.0))?;
            let load = of(load, &self.load, Number::known(0.0))?;
            let smoothing = of(smoothing, &self.smoothing, smoothing.usual(false))?;
            let width = of(width, &self.width, width.usual(true))?;
            friction.dry = (0..groups).map(|i| [constant[i], load[i], smoothing[i], width[i]]).collect();
        }
        Ok(friction)
    }

    /// Refuses damping that is also given by another key.
    pub(crate) fn check_damping(&self, key: &'static str, is_given: bool) -> Result<(), ShapeError> {
        if is_given && self.viscous.is_some() {
            return Err(RULES[0].at(None, Problem::DampingTwice { key }));
        }
        Ok(())
    }
}

/// Contents of the table `[model.friction]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    viscous: Option<GroupNumbers>,
    coulomb: Option<GroupNumbers>,
    load: Option<GroupNumbers>,
    width: Option<GroupNumbers>,
    smoothing: Option<GroupNumbers>,
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
