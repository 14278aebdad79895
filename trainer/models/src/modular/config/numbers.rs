//! Numbers of the element types.

use super::{Problem, TransformKind, TypeConfig};
use crate::config::parts::{NumberConfig, Range};
use crate::modular::TYPE_NUMBERS;
use crate::number::Number;

/// Numbers of a point mass of 1 kg at the end of its element.
pub(super) const DEFAULTS: [Number; TYPE_NUMBERS] =
    [Number::known(1.0), Number::known(0.0), Number::known(1.0), Number::known(1.0), Number::known(0.0)];

impl TypeConfig {
    /// Keys that determine the shape of networks, each with whether it is given.
    pub(super) fn shape_keys(&self) -> impl Iterator<Item = (&'static str, bool)> {
        [
            ("transform", self.transform.is_some()),
            ("position", self.position.is_some()),
            ("velocity", self.velocity.is_some()),
            ("potential", self.potential.is_some()),
            ("activation", self.activation.is_some()),
        ]
        .into_iter()
    }

    /// Mass, moment of inertia, centre, length and damping; numbers that are not given are taken from `defaults`.
    pub(super) fn numbers(
        &self,
        transform: TransformKind,
        defaults: [Number; TYPE_NUMBERS],
    ) -> Result<[Number; TYPE_NUMBERS], (&'static str, Problem)> {
        let rules: [(&'static str, bool, Range); TYPE_NUMBERS] = [
            ("mass", true, Range::ABOVE),
            ("inertia", transform.turns(), Range::NOT_BELOW),
            ("centre", true, Range::ANY),
            ("length", transform == TransformKind::Rod, Range::ABOVE),
            ("damping", true, Range::NOT_BELOW),
        ];
        let given = [self.mass, self.inertia, self.centre, self.length, self.damping];
        let mut numbers = defaults;
        for ((number, given), (key, has_meaning, range)) in numbers.iter_mut().zip(given).zip(rules) {
            let Some(NumberConfig { value, learned }) = given else { continue };
            if !has_meaning {
                return Err((key, Problem::Meaningless { key, transform: transform.name() }));
            }
            *number = range.number(key, value, learned).map_err(|problem| (key, problem))?;
        }
        Ok(numbers)
    }
}
