//! Lists for which a single entry may be written without brackets.

use serde::Deserialize;
use serde::Serialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use std::fmt;

/// Writes a list, or only its entry if it has exactly one.
pub(super) fn one_or_many<T: Serialize, S: Serializer>(all: &[T], to: S) -> Result<S::Ok, S::Error> {
    if let [one] = all {
        return one.serialize(to);
    }
    let mut list = to.serialize_seq(Some(all.len()))?;
    all.iter().try_for_each(|one| list.serialize_element(one))?;
    list.end()
}

/// Reads what [`one_or_many`] writes.
pub(super) struct OneOrMany<T> {
    expected: &'static str,
    of: std::marker::PhantomData<T>,
}

impl<T> OneOrMany<T> {
    pub(super) fn new(expected: &'static str) -> Self {
        Self { expected, of: std::marker::PhantomData }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrMany<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Vec<T>, E> {
        T::deserialize(serde::de::value::StrDeserializer::new(text)).map(|one| vec![one])
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Vec<T>, E> {
        T::deserialize(serde::de::value::I64Deserializer::new(number)).map(|one| vec![one])
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(|one| vec![one])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut all = Vec::new();
        while let Some(one) = list.next_element()? {
            all.push(one);
        }
        Ok(all)
    }
}
