//! Fields whose range is checked while they are read, so that an error can name the line.

use crate::limits::{DEPTH, MAX_ELEMENT_UNITS, MAX_HIDDEN, MAX_UNITS};
use leastaction_core::network::Activation;
use serde::de::{Deserializer, Error, Unexpected};
use serde::{Deserialize, Serialize, Serializer};

/// Activations, by their names in lower case.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Activation", rename_all = "lowercase")]
pub(crate) enum ActivationName {
    Tanh,
    Softplus,
    Squareplus,
    Isru,
    Identity,
}

/// Reads a number for which `holds` is true; `range` is the condition in words.
pub fn number<'de, D: Deserializer<'de>>(
    from: D,
    holds: fn(f64) -> bool,
    range: &str,
) -> Result<f64, D::Error> {
    let x = f64::deserialize(from)?;
    if holds(x) { Ok(x) } else { Err(Error::invalid_value(Unexpected::Float(x), &range)) }
}

pub(crate) fn epsilon<'de, D: Deserializer<'de>>(from: D) -> Result<f32, D::Error> {
    number(from, |x| (0.0..1e30).contains(&x), "a finite number, 0 or above").map(|x| x as f32)
}

pub(crate) fn dimension<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    match u8::deserialize(from)? {
        dimension @ (2 | 3) => Ok(dimension),
        other => Err(Error::invalid_value(Unexpected::Unsigned(other.into()), &"2 or 3")),
    }
}

pub(crate) fn widths<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u16>, D::Error> {
    let widths = Vec::<u16>::deserialize(from)?;
    let sensible = |width: &u16| (1..=MAX_UNITS).contains(&usize::from(*width));
    if (1..=MAX_HIDDEN).contains(&widths.len()) && widths.iter().all(sensible) {
        return Ok(widths);
    }
    Err(Error::custom(format_args!(
        "invalid value: {widths:?}, expected 1 to {MAX_HIDDEN} layers of 1 to {MAX_UNITS} units"
    )))
}

/// Reads the hidden layers of an element's network; an empty list makes the network linear.
pub(crate) fn some_widths<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<u16>>, D::Error> {
    let widths = Vec::<u16>::deserialize(from)?;
    let sensible = |width: &u16| (1..=MAX_ELEMENT_UNITS).contains(&usize::from(*width));
    if widths.len() <= DEPTH && widths.iter().all(sensible) {
        return Ok(Some(widths));
    }
    Err(Error::custom(format_args!(
        "invalid value: {widths:?}, expected at most {DEPTH} layers of 1 to {MAX_ELEMENT_UNITS} units, or [] for none"
    )))
}

/// Reads and writes an activation that may be left out.
pub(crate) mod activation_name {
    use super::{Activation, ActivationName, Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Serialize, Deserialize)]
    #[serde(transparent)]
    struct Named(#[serde(with = "ActivationName")] Activation);

    pub(crate) fn serialize<S: Serializer>(
        activation: &Option<Activation>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        activation.map(Named).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Activation>, D::Error> {
        Named::deserialize(from).map(|Named(activation)| Some(activation))
    }
}
