//! Parts of the types: known or learned numbers, and networks.

use crate::config::problem::Problem;
use crate::number::Number;
use leastaction_core::energy::NetworkShape;
use leastaction_core::model::MAX_HIDDEN;
use leastaction_core::network::Activation;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{
    DeserializeOwned, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

/// A number of a type, or several: `1.0` is known, `{ learn = 1.0 }` is learned from that start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberConfig<T = f64> {
    /// Value of the number, or its start if it is learned.
    pub value: T,
    /// Whether the number is learned.
    pub learned: bool,
}

/// Notation of a value.
trait Example {
    /// Example of a known value and of a learned one.
    const TEXT: &'static str;
}

impl Example for f64 {
    const TEXT: &'static str = "a number, as 1.0, or { learn = 1.0 }";
}

impl Example for Vec<f64> {
    const TEXT: &'static str = "numbers, as [0.0, 9.8], or { learn = [0.0, 9.8] }";
}

impl Example for [f64; 2] {
    const TEXT: &'static str = "two numbers, as [0.0, 1.0], or { learn = [0.0, 1.0] }";
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Learned<T> {
    learn: T,
}

struct NumberVisitor<T>(PhantomData<T>);

impl<'de, T: DeserializeOwned + Example> Visitor<'de> for NumberVisitor<T> {
    type Value = NumberConfig<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(T::TEXT)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        let known = T::deserialize(value.into_deserializer());
        let known = known.map_err(|_: E| E::invalid_type(Unexpected::Float(value), &self))?;
        Ok(NumberConfig { value: known, learned: false })
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        let known = T::deserialize(SeqAccessDeserializer::new(values));
        let known = known.map_err(|_| A::Error::invalid_type(Unexpected::Seq, &self))?;
        Ok(NumberConfig { value: known, learned: false })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        let Learned { learn } = Learned::deserialize(MapAccessDeserializer::new(map))?;
        Ok(NumberConfig { value: learn, learned: true })
    }
}

impl<'de, T: DeserializeOwned + Example> Deserialize<'de> for NumberConfig<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberVisitor(PhantomData))
    }
}

impl<T: Serialize> Serialize for NumberConfig<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.learned { Learned { learn: &self.value }.serialize(to) } else { self.value.serialize(to) }
    }
}

/// Range of allowed numbers, checked in single precision, in which the model file stores them.
pub(crate) struct Range {
    /// Whether a number is allowed.
    pub holds: fn(f32) -> bool,
    /// Whether a number may be infinite.
    pub infinite: bool,
    /// Condition in words.
    pub words: &'static str,
}

impl Range {
    pub const ABOVE: Self = Self::finite(|x| x > 0.0, "a finite number above 0");
    pub const NOT_BELOW: Self = Self::finite(|x| x >= 0.0, "a finite number, 0 or above");
    pub const ANY: Self = Self::finite(|_| true, "a finite number");

    /// Range of finite numbers.
    pub const fn finite(holds: fn(f32) -> bool, words: &'static str) -> Self {
        Self { holds, infinite: false, words }
    }

    /// Returns the number, if it is in the range; `key` is its key in the configuration.
    pub fn number(&self, key: &'static str, value: f64, learned: bool) -> Result<Number, Problem> {
        let single = value as f32;
        if !(single.is_finite() || self.infinite && value.is_infinite()) || !(self.holds)(single) {
            return Err(Problem::OutOfRange { key, value, range: self.words });
        }
        Ok(Number::new(value, learned))
    }
}

/// Networks, by their numbers.
#[derive(Default)]
pub(crate) struct Networks(pub Vec<NetworkShape>);

impl Networks {
    /// Adds a network and returns its number.
    pub fn add(&mut self, units: &[u16], (inputs, outputs): (usize, usize), activation: Activation) -> u8 {
        let mut widths = [0; MAX_HIDDEN];
        widths.iter_mut().zip(units).for_each(|(slot, width)| *slot = *width);
        self.0.push(NetworkShape { inputs: inputs as u8, widths, outputs: outputs as u8, activation });
        // A count beyond what the format can hold is refused later.
        u8::try_from(self.0.len() - 1).unwrap_or(u8::MAX)
    }
}
