//! `[model.friction]` of any family whose coordinates allow it.

use crate::config::parts::Range;
use crate::config::place::ShapeError;
use crate::config::problem::Problem;
use crate::laws::group::{GroupLaws, MOST_LOAD, WIDTH_PARTS};
use crate::laws::numbers::{GroupNumber, GroupNumbers, LEARNED, NumbersVisitor, Rule};
use crate::number::Number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Friction of the coordinates, Q = −(b (1 + βt) v + (c (1 + δt) + c_load (√(τ² + τ_s²) − τ_s)) t) with t = tanh(v/ε); a part that is left
/// out is absent. `friction = "learned"` means that `viscous` and `coulomb` are learned, `friction = "sticking"` that dry friction sticks, too.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrictionConfig {
    /// Viscous damping b, N s/m or N m s/rad. (Start if learned: 0.02 of force over speed of the log.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous: Option<GroupNumbers>,
    /// Asymmetry β of damping, which is b (1 + β) forwards and b (1 − β) backwards. (Default: 0; start if learned: 0.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscous_asymmetry: Option<GroupNumbers>,
    /// Coulomb friction c, N or N m; `"sticking"` means learned, with `sticking = true`. (Start if learned: 0.03 of the log's force.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coulomb: Option<GroupNumbers>,
    /// Asymmetry δ of Coulomb friction, which is c (1 + δ) forwards and c (1 − δ) backwards. (Default: 0; start if learned: 0.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<GroupNumbers>,
    /// Growth c_load of friction with the load. (Start if learned: 0.1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<GroupNumbers>,
    /// Width ε of the change of sign, m/s or rad/s. (Default with dry friction: learned, starting at 0.05 of the log's speed; with friction that
    /// sticks known, 0.003 of it.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<GroupNumbers>,
    /// Smoothing load τ_s, N or N m. (Default with dry friction: known; 0.02 of the log's force, which is also the start if it is learned.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<GroupNumbers>,
    /// Whether dry friction sticks: it holds at rest instead of creeping, and steps solve the set-valued law. (Default: false.)
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sticking: bool,
    /// Friction at rest over friction in motion, 1 or more, where it sticks; known. (Default: 1.)
    #[serde(skip_serializing_if = "Option::is_none")]
    pub breakaway: Option<GroupNumbers>,
}

const fn rule(key: &'static str, [known, start]: [Range; 2], (default, part): (f64, Option<f64>)) -> Rule {
    Rule { table: "friction", key, known, start, default, part }
}

const VISCOUS: Rule = rule("viscous", [Range::NOT_BELOW, Rule::ABOVE], (0.01, Some(0.02)));
const COULOMB: Rule = rule("coulomb", [Range::NOT_BELOW, Rule::ABOVE], (0.1, Some(0.03)));
const SMOOTHING: Rule = rule("smoothing", [Range::ABOVE, Rule::ABOVE], (0.1, Some(0.02)));
const WIDTH: Rule = rule("width", [Range::ABOVE, Rule::ABOVE], (0.1, Some(0.05)));
/// Width of the smooth law that stands for friction that sticks in derivatives: narrow, and not seen in rollouts, so that it is not learned.
const STICKING_WIDTH: Rule = rule("width", [Range::ABOVE, Rule::ABOVE], (0.01, Some(WIDTH_PARTS[0])));
const VISCOUS_ASYMMETRY: Rule = asymmetry("viscous_asymmetry");
const ASYMMETRY: Rule = asymmetry("asymmetry");
const LOAD: Rule = {
    let known = Range::finite(|x| (0.0..1.0).contains(&x), "0 or above and below 1");
    let holds = |x| x > 0.0 && x < MOST_LOAD as f32;
    let start = Range::finite(holds, "above 0 and below 0.95 where it is learned");
    rule("load", [known, start], (0.1, None))
};
const BREAKAWAY: Rule = {
    const KNOWN: Range = Range::finite(|x| x >= 1.0, "a finite number, 1 or above");
    rule("breakaway", [KNOWN, KNOWN], (1.0, None))
};

const fn asymmetry(key: &'static str) -> Rule {
    let known = Range::finite(|x| x.abs() <= 1.0, "between -1 and 1");
    let start = Range::finite(|x| x.abs() < 1.0, "between -1 and 1, without them, where it is learned");
    rule(key, [known, start], (0.0, None))
}

/// Numbers of every group under the keys of the table.
struct Assembled {
    viscous: Vec<Number>,
    viscous_asymmetry: Vec<Number>,
    coulomb: Vec<Number>,
    asymmetry: Vec<Number>,
    load: Vec<Number>,
    smoothing: Vec<Number>,
    width: Vec<Number>,
    breakaway: Vec<Number>,
}

/// Numbers of a law, group after group.
fn by_group<const K: usize>(numbers: [&Vec<Number>; K]) -> Vec<Number> {
    let groups = numbers.first().map_or(0, |own| own.len());
    (0..groups).flat_map(|group| numbers.map(|own| own[group])).collect()
}

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

    fn is_dry(&self) -> bool {
        self.coulomb.is_some() || self.load.is_some()
    }

    /// Refuses keys without a meaning beside the others.
    fn check(&self) -> Result<(), ShapeError> {
        let of_dry = [
            (&WIDTH, self.width.is_some()),
            (&SMOOTHING, self.smoothing.is_some()),
            (&ASYMMETRY, self.asymmetry.is_some()),
            (&BREAKAWAY, self.breakaway.is_some()),
        ];
        if let Some((rule, _)) = of_dry.iter().find(|(_, given)| *given && !self.is_dry()) {
            return Err(rule.at(None, Problem::NoDryFriction { key: rule.key }));
        }
        if self.sticking && !self.is_dry() {
            let key = "sticking";
            return Err(Problem::NoDryFriction { key }.at(["friction".into(), key.into()]));
        }
        if self.viscous_asymmetry.is_some() && self.viscous.is_none() {
            return Err(VISCOUS_ASYMMETRY.at(None, Problem::NoDamping));
        }
        match &self.breakaway {
            Some(_) if !self.sticking => Err(BREAKAWAY.at(None, Problem::BreakawayOfSmooth)),
            Some(given) if !given.are_known() => {
                Err(BREAKAWAY.at(None, Problem::NeverLearned { key: "breakaway" }))
            }
            _ => Ok(()),
        }
    }

    fn numbers(&self, groups: usize, what: &'static str) -> Result<Assembled, ShapeError> {
        let of = |rule: &Rule, given: &Option<GroupNumbers>, absent: Number| match given {
            None => Ok(vec![absent; groups]),
            Some(given) => given.assemble(rule, groups, what),
        };
        let none = Number::known(0.0);
        Ok(Assembled {
            viscous: of(&VISCOUS, &self.viscous, none)?,
            viscous_asymmetry: of(&VISCOUS_ASYMMETRY, &self.viscous_asymmetry, none)?,
            coulomb: of(&COULOMB, &self.coulomb, none)?,
            asymmetry: of(&ASYMMETRY, &self.asymmetry, none)?,
            load: of(&LOAD, &self.load, none)?,
            smoothing: of(&SMOOTHING, &self.smoothing, SMOOTHING.usual(false))?,
            width: match self.sticking {
                true => of(&STICKING_WIDTH, &self.width, STICKING_WIDTH.usual(false))?,
                false => of(&WIDTH, &self.width, WIDTH.usual(true))?,
            },
            breakaway: of(&BREAKAWAY, &self.breakaway, Number::known(1.0))?,
        })
    }

    /// Returns the friction of `groups` groups of coordinates; `what` is the word for a group.
    ///
    /// Smooth friction without asymmetries is [`Law::Viscous`](leastaction_core::model::Law) and `Coulomb`. Damping with an asymmetry is
    /// `Directional`, as is smooth dry friction with one, whose growth with the load is `Coulomb`. Dry friction that sticks is `Sticking`.
    ///
    /// # Errors
    /// [`ShapeError`]: a number out of its range, a list of the wrong length, or a key without a meaning.
    pub(crate) fn assemble(&self, groups: usize, what: &'static str) -> Result<GroupLaws, ShapeError> {
        self.check()?;
        let of = self.numbers(groups, what)?;
        let none = vec![Number::known(0.0); groups];
        let (dry, turns) = (self.is_dry() && !self.sticking, self.viscous_asymmetry.is_some());
        let mut laws = GroupLaws::default();
        if turns || (dry && self.asymmetry.is_some()) {
            let [constant, asymmetry] = if dry { [&of.coulomb, &of.asymmetry] } else { [&none, &none] };
            // Without dry friction the width is only that of the damping's change.
            laws.directional = by_group([&of.viscous, &of.viscous_asymmetry, constant, asymmetry, &of.width]);
            if dry && self.load.is_some() {
                laws.coulomb = by_group([&none, &of.load, &of.smoothing, &of.width]);
            }
        } else {
            if self.viscous.is_some() {
                laws.viscous = of.viscous;
            }
            if dry {
                laws.coulomb = by_group([&of.coulomb, &of.load, &of.smoothing, &of.width]);
            }
        }
        if self.sticking {
            let [load, smoothing] = [&of.load, &of.smoothing];
            laws.sticking = by_group([&of.coulomb, &of.asymmetry, load, smoothing, &of.breakaway, &of.width]);
        }
        Ok(laws)
    }

    /// Refuses damping that is also given by another key.
    pub(crate) fn check_damping(&self, key: &'static str, is_given: bool) -> Result<(), ShapeError> {
        if is_given && self.viscous.is_some() {
            return Err(VISCOUS.at(None, Problem::DampingTwice { key }));
        }
        Ok(())
    }
}

/// Contents of the table `[model.friction]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    viscous: Option<GroupNumbers>,
    viscous_asymmetry: Option<GroupNumbers>,
    coulomb: Option<Coulomb>,
    asymmetry: Option<GroupNumbers>,
    load: Option<GroupNumbers>,
    width: Option<GroupNumbers>,
    smoothing: Option<GroupNumbers>,
    #[serde(default)]
    sticking: bool,
    breakaway: Option<GroupNumbers>,
}

/// Value of `coulomb`: numbers, or `"sticking"`.
struct Coulomb {
    numbers: GroupNumbers,
    sticks: bool,
}

/// Word for dry friction that sticks, with a learned c.
const STICKING: &str = "sticking";

impl<'de> Deserialize<'de> for Coulomb {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let (numbers, sticks) = from.deserialize_any(NumbersVisitor { word: Some(STICKING) })?;
        Ok(Self { numbers, sticks })
    }
}

struct ConfigVisitor;

impl<'de> Visitor<'de> for ConfigVisitor {
    type Value = FrictionConfig;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\", \"sticking\", or a table, as { viscous = \"learned\", coulomb = 0.1 }")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        match word {
            LEARNED => Ok(FrictionConfig::learned()),
            STICKING => Ok(FrictionConfig { sticking: true, ..FrictionConfig::learned() }),
            _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let of = Table::deserialize(MapAccessDeserializer::new(map))?;
        let sticks = of.coulomb.as_ref().is_some_and(|coulomb| coulomb.sticks);
        Ok(FrictionConfig {
            viscous: of.viscous,
            viscous_asymmetry: of.viscous_asymmetry,
            coulomb: of.coulomb.map(|coulomb| coulomb.numbers),
            asymmetry: of.asymmetry,
            load: of.load,
            width: of.width,
            smoothing: of.smoothing,
            sticking: of.sticking || sticks,
            breakaway: of.breakaway,
        })
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
