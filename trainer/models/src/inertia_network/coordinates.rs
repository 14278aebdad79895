//! Kinds of coordinates in a configuration.

use crate::limits::MAX_COORDINATES;
use leastaction_core::energy::inertia_network::Coordinate;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// Kinds of coordinates, written as a list of names or as letters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordinates(
    /// Kinds from the first coordinate to the last.
    pub Vec<Coordinate>,
);

const KINDS: [(&str, Coordinate); 3] =
    [("translation", Coordinate::Translation), ("angle", Coordinate::Angle), ("cyclic", Coordinate::Cyclic)];

/// Returns the kind for a name or a letter.
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
