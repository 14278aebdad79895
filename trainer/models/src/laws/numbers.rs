//! Notation of the numbers of a law: known or learned, one for all coordinates or one for each.

use crate::config::parts::Range;
use crate::config::place::{ShapeError, Step};
use crate::config::problem::Problem;
use crate::number::Number;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// One number for all coordinates, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum GroupNumbers {
    /// One number for all of them; if it is learned, the coordinates end up with different values.
    All(GroupNumber),
    /// One number per coordinate of an inertia network or of bodies, or per element type.
    Each(Vec<GroupNumber>),
}

/// A number of a law: `"learned"`, `0.1`, or `{ learn = 0.1 }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GroupNumber {
    /// Learned, starting at the documented default.
    Learned,
    /// Learned, starting at this value.
    LearnedFrom(f64),
    /// Known value.
    Known(f64),
}

/// Value of a number that is learned from the documented default.
pub(crate) const LEARNED: &str = "learned";

/// A key with its allowed numbers, both for known values and for starting values.
pub(crate) struct Rule {
    /// Key of the law in the table of the model.
    pub table: &'static str,
    pub key: &'static str,
    pub known: Range,
    pub start: Range,
    /// Value if none is given and no log is read.
    pub default: f64,
    /// Part of the log's scale that replaces it; `None` for a number without a unit.
    pub part: Option<f64>,
}

impl Rule {
    /// Start of a learned number that stays above 0.
    pub const ABOVE: Range = Range::finite(|x| x > 0.0, "a finite number above 0 where it is learned");

    /// The documented number, learned or known, which follows the scale of the log.
    pub fn usual(&self, learned: bool) -> Number {
        Number { part: self.part, ..Number::new(self.default, learned) }
    }

    /// Error of a number, or of the entry `index` of a list.
    pub fn at(&self, index: Option<usize>, problem: Problem) -> ShapeError {
        let mut place: Vec<Step> = ["model", self.table, self.key].map(Step::from).into();
        place.extend(index.map(Step::from));
        ShapeError { place, problem }
    }
}

impl GroupNumber {
    fn number(self, rule: &Rule) -> Result<Number, Problem> {
        match self {
            Self::Learned => Ok(rule.usual(true)),
            Self::LearnedFrom(start) => rule.start.number(rule.key, start, true),
            Self::Known(value) => rule.known.number(rule.key, value, false),
        }
    }
}

impl GroupNumbers {
    /// Whether no number is learned.
    pub(crate) fn are_known(&self) -> bool {
        let is_known = |number: &GroupNumber| matches!(number, GroupNumber::Known(_));
        match self {
            Self::All(one) => is_known(one),
            Self::Each(each) => each.iter().all(is_known),
        }
    }

    /// Returns the numbers of `groups` groups; `what` is the word for a group.
    pub(crate) fn assemble(
        &self,
        rule: &Rule,
        groups: usize,
        what: &'static str,
    ) -> Result<Vec<Number>, ShapeError> {
        match self {
            Self::All(one) => {
                let number = one.number(rule).map_err(|problem| rule.at(None, problem))?;
                Ok(vec![number; groups])
            }
            Self::Each(each) if each.len() != groups => {
                let (key, found) = (rule.key, each.len());
                Err(rule.at(None, Problem::GroupCount { key, found, needed: groups, what }))
            }
            Self::Each(each) => {
                let numbers = each.iter().enumerate();
                let number = |(i, one): (usize, &GroupNumber)| {
                    one.number(rule).map_err(|problem| rule.at(Some(i), problem))
                };
                numbers.map(number).collect()
            }
        }
    }
}

impl Serialize for GroupNumbers {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(one) => one.serialize(to),
            Self::Each(each) => each.serialize(to),
        }
    }
}

impl Serialize for GroupNumber {
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
    type Value = GroupNumber;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("\"learned\", a number, as 0.1, or { learn = 0.1 }")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        if word == LEARNED {
            Ok(GroupNumber::Learned)
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(GroupNumber::Known(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Start { learn } = Start::deserialize(MapAccessDeserializer::new(map))?;
        Ok(GroupNumber::LearnedFrom(learn))
    }
}

impl<'de> Deserialize<'de> for GroupNumber {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberVisitor)
    }
}

/// Visitor of one number or a list; the result says whether it was the other word, which stands for learned numbers too.
pub(crate) struct NumbersVisitor {
    /// The other word, if there is one.
    pub word: Option<&'static str>,
}

impl<'de> Visitor<'de> for NumbersVisitor {
    type Value = (GroupNumbers, bool);

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.word.iter().try_for_each(|word| write!(f, "{word:?}, "))?;
        NumberVisitor.expecting(f)?;
        f.write_str(", or a list of them")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        let is_other = self.word == Some(word);
        if word == LEARNED || is_other {
            Ok((GroupNumbers::All(GroupNumber::Learned), is_other))
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        NumberVisitor.visit_f64(value).map(of_all)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        NumberVisitor.visit_map(map).map(of_all)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut each = Vec::new();
        while let Some(one) = list.next_element()? {
            each.push(one);
        }
        Ok((GroupNumbers::Each(each), false))
    }
}

fn of_all(number: GroupNumber) -> (GroupNumbers, bool) {
    (GroupNumbers::All(number), false)
}

impl<'de> Deserialize<'de> for GroupNumbers {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumbersVisitor { word: None }).map(|(numbers, _)| numbers)
    }
}
