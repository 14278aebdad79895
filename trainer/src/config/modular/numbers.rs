//! The numbers of element types.

use super::{NumberConfig, Problem, TransformKind, TypeConfig};
use crate::architecture::Number;
use leastaction_core::energy::modular::NUMBERS;

/// A point of 1 kg at the end of whatever carries it.
pub(super) const DEFAULTS: [Number; NUMBERS] =
    [Number::known(1.0), Number::known(0.0), Number::known(1.0), Number::known(1.0), Number::known(0.0)];

impl TypeConfig {
    /// What shapes networks, and whether it is given.
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

    /// Mass, moment of inertia, centre, length and damping, `defaults` where they are left out.
    pub(super) fn numbers(
        &self,
        transform: TransformKind,
        defaults: [Number; NUMBERS],
    ) -> Result<[Number; NUMBERS], (&'static str, Problem)> {
        type Rule = (&'static str, bool, fn(f32) -> bool, &'static str);
        const ABOVE: &str = "a finite number above 0";
        const NOT_BELOW: &str = "a finite number, 0 or above";
        let rules: [Rule; NUMBERS] = [
            ("mass", true, |x| x > 0.0, ABOVE),
            ("inertia", transform.turns(), |x| x >= 0.0, NOT_BELOW),
            ("centre", true, |_| true, "a finite number"),
            ("length", transform == TransformKind::Rod, |x| x > 0.0, ABOVE),
            ("damping", true, |x| x >= 0.0, NOT_BELOW),
        ];
        let given = [self.mass, self.inertia, self.centre, self.length, self.damping];
        let mut numbers = defaults;
        for ((number, given), (key, has_meaning, good, range)) in numbers.iter_mut().zip(given).zip(rules) {
            let Some(NumberConfig { value, learned }) = given else { continue };
            if !has_meaning {
                return Err((key, Problem::Meaningless { key, transform: transform.name() }));
            }
            // As the model file will have it.
            let single = value as f32;
            if !single.is_finite() || !good(single) {
                return Err((key, Problem::OutOfRange { key, value, range }));
            }
            *number = Number { value, learned };
        }
        Ok(numbers)
    }
}
