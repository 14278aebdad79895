//! Fields whose range is checked while they are read, so that the error knows the line.

use crate::training::StateNoise;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::network::Activation;
use leastaction_models::{DEPTH, MAX_COORDINATES, MAX_ELEMENT_UNITS, MAX_HIDDEN, MAX_UNITS};
use serde::de::{Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Kinds of coordinates, written as a list of names or as letters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordinates(
    /// From the first to the last.
    pub Vec<Coordinate>,
);

/// The form of the inertia matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InertiaKind {
    /// LLᵀ + εI.
    Cholesky,
    /// diag(softplus).
    Diagonal,
    /// BᵀB + εI.
    Factor,
}

/// How the loss is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OptimiserKind {
    /// Damped Gauss–Newton.
    LevenbergMarquardt,
    /// Adam.
    Adam,
}

/// Activations by their names in lower case.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Activation", rename_all = "lowercase")]
pub(super) enum ActivationName {
    Tanh,
    Softplus,
    Squareplus,
    Isru,
    Identity,
}

const KINDS: [(&str, Coordinate); 3] =
    [("translation", Coordinate::Translation), ("angle", Coordinate::Angle), ("cyclic", Coordinate::Cyclic)];

/// The kind of a name or of a letter.
fn kind<E: Error>(name: &str) -> Result<Coordinate, E> {
    let mut letters = name.chars();
    let letter = letters.next().filter(|_| letters.next().is_none()).and_then(Coordinate::from_letter);
    let named = KINDS.iter().find(|(known, _)| *known == name).map(|(_, kind)| *kind);
    named.or(letter).ok_or_else(|| Error::unknown_variant(name, &["translation", "angle", "cyclic"]))
}

fn counted<E: Error>(kinds: Vec<Coordinate>) -> Result<Coordinates, E> {
    if (1..=MAX_COORDINATES).contains(&kinds.len()) {
        Ok(Coordinates(kinds))
    } else {
        Err(E::custom(format_args!("{} coordinates; this program takes 1 to {MAX_COORDINATES}", kinds.len())))
    }
}

struct CoordinatesVisitor;

impl<'de> Visitor<'de> for CoordinatesVisitor {
    type Value = Coordinates;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("kinds of coordinates as [\"translation\", \"angle\"] or \"ta\"")
    }

    fn visit_str<E: Error>(self, letters: &str) -> Result<Coordinates, E> {
        counted(
            letters.chars().map(|letter| kind(letter.encode_utf8(&mut [0; 4]))).collect::<Result<_, _>>()?,
        )
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut names: A) -> Result<Coordinates, A::Error> {
        let mut kinds = Vec::new();
        while let Some(name) = names.next_element::<String>()? {
            kinds.push(kind(&name)?);
        }
        counted(kinds)
    }
}

impl<'de> Deserialize<'de> for Coordinates {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(CoordinatesVisitor)
    }
}

impl Serialize for Coordinates {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(&self.0.iter().map(|kind| kind.letter()).collect::<String>())
    }
}

/// A number for which `holds`, which `range` says in words.
fn number<'de, D: Deserializer<'de>>(from: D, holds: fn(f64) -> bool, range: &str) -> Result<f64, D::Error> {
    let x = f64::deserialize(from)?;
    if holds(x) { Ok(x) } else { Err(Error::invalid_value(Unexpected::Float(x), &range)) }
}

pub(super) fn fraction<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, |x| (0.0..1.0).contains(&x), "a number from 0 to below 1")
}

pub(super) fn some_fraction<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    fraction(from).map(Some)
}

pub(super) fn factor<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, |x| x > 0.0 && x <= 1.0, "a number above 0, at most 1")
}

pub(super) fn limit<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, |x| x > 0.0 && x.is_finite(), "a finite number above 0")
}

pub(super) fn some_limit<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    limit(from).map(Some)
}

pub(super) fn epsilon<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, |x| (0.0..1e30).contains(&x), "a finite number, 0 or above").map(|x| x as f32)
}

pub(super) fn penalty<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, |x| x >= 0.0 && x.is_finite(), "a finite number, 0 or above")
}

pub(super) fn state_noise<'de, D: Deserializer<'de>>(from: D) -> Result<Option<StateNoise>, D::Error> {
    let noise = StateNoise::deserialize(from)?;
    let expected = "finite numbers q, v and a, 0 or above, and q or v above 0";
    if noise.is_noise() { Ok(Some(noise)) } else { Err(Error::custom(format_args!("expected {expected}"))) }
}

pub(super) fn positive<'de, D: Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
    match u64::deserialize(from)? {
        0 => Err(Error::invalid_value(Unexpected::Unsigned(0), &"a whole number, 1 or above")),
        x => Ok(x),
    }
}

pub(super) fn some_positive<'de, D: Deserializer<'de>>(from: D) -> Result<Option<usize>, D::Error> {
    positive(from).map(|x| usize::try_from(x).ok())
}

/// More threads than any machine has would only take minutes to start.
const MAX_THREADS: usize = 1024;

pub(super) fn threads<'de, D: Deserializer<'de>>(from: D) -> Result<usize, D::Error> {
    match usize::deserialize(from)? {
        threads @ 0..=MAX_THREADS => Ok(threads),
        other => {
            Err(Error::invalid_value(Unexpected::Unsigned(other as u64), &"a whole number from 0 to 1024"))
        }
    }
}

pub(super) fn order<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    match u8::deserialize(from)? {
        order @ (2 | 4) => Ok(order),
        other => Err(Error::invalid_value(Unexpected::Unsigned(other.into()), &"2 or 4")),
    }
}

pub(super) fn dimension<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    match u8::deserialize(from)? {
        dimension @ (2 | 3) => Ok(dimension),
        other => Err(Error::invalid_value(Unexpected::Unsigned(other.into()), &"2 or 3")),
    }
}

pub(super) fn widths<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u16>, D::Error> {
    let widths = Vec::<u16>::deserialize(from)?;
    let sensible = |width: &u16| (1..=MAX_UNITS).contains(&usize::from(*width));
    if (1..=MAX_HIDDEN).contains(&widths.len()) && widths.iter().all(sensible) {
        return Ok(widths);
    }
    Err(Error::custom(format_args!(
        "invalid value: {widths:?}, expected 1 to {MAX_HIDDEN} layers of 1 to {MAX_UNITS} units"
    )))
}

/// The hidden layers of a network of an element: none makes it linear.
pub(super) fn some_widths<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<u16>>, D::Error> {
    let widths = Vec::<u16>::deserialize(from)?;
    let sensible = |width: &u16| (1..=MAX_ELEMENT_UNITS).contains(&usize::from(*width));
    if widths.len() <= DEPTH && widths.iter().all(sensible) {
        return Ok(Some(widths));
    }
    Err(Error::custom(format_args!(
        "invalid value: {widths:?}, expected at most {DEPTH} layers of 1 to {MAX_ELEMENT_UNITS} units, or [] for none"
    )))
}

/// An activation that may be left out.
pub(super) mod activation_name {
    use super::{Activation, ActivationName, Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(transparent)]
    struct Named(#[serde(with = "ActivationName")] Activation);

    pub(in crate::config) fn serialize<S: Serializer>(
        activation: &Option<Activation>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        activation.map(Named).serialize(to)
    }

    pub(in crate::config) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<Activation>, D::Error> {
        Named::deserialize(from).map(|Named(activation)| Some(activation))
    }
}

/// What a control does between samples, by its name; it may be left out.
pub(super) mod control_kind {
    use super::{Deserialize, Deserializer, Error, Serializer};
    use crate::data::{control_name, control_of_name};
    use leastaction_core::forces::ControlKind;

    pub(in crate::config) fn serialize<S: Serializer>(
        kind: &Option<ControlKind>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        match kind {
            Some(kind) => to.serialize_str(control_name(*kind)),
            None => to.serialize_none(),
        }
    }

    pub(in crate::config) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<ControlKind>, D::Error> {
        let name = String::deserialize(from)?;
        control_of_name(&name).map(Some).ok_or_else(|| Error::unknown_variant(&name, &["held", "linear"]))
    }
}
