//! Deserialisers that check the range of a field while it is read, so that the error knows the line.

use crate::training::StateNoise;
use leastaction_models::config::fields::number;
use serde::de::{Deserializer, Error, Unexpected};
use serde::{Deserialize, Serialize};

/// Optimiser that minimises the loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OptimiserKind {
    /// Damped Gauss–Newton.
    LevenbergMarquardt,
    /// Adam.
    Adam,
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

/// Upper bound of the thread count. More threads than any machine has processors would only take minutes to start.
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

/// Reader and writer of the optional name of a control kind.
pub(super) mod control_kind {
    use crate::data::{control_name, control_of_name};
    use leastaction_core::forces::ControlKind;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

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
