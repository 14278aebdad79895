//! Parsers for option values; their error messages say what the value must be.

use leastaction_core::forces::ControlKind;
use leastaction_learning::data::control_of_name;

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    number(text).filter(|x| *x > 0.0).ok_or_else(|| "it must be a finite number above 0".to_owned())
}

/// A finite number above 0, in single precision.
pub fn positive_f32(text: &str) -> Result<f32, String> {
    positive(text).map(|x| x as f32)
}

/// A finite number, 0 or above.
pub fn not_negative(text: &str) -> Result<f64, String> {
    number(text).filter(|x| *x >= 0.0).ok_or_else(|| "it must be a finite number, 0 or above".to_owned())
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    number(text).ok_or_else(|| "it must be a finite number".to_owned())
}

/// A number between 0 and 1, without either.
pub fn probability(text: &str) -> Result<f64, String> {
    number(text)
        .filter(|x| *x > 0.0 && *x < 1.0)
        .ok_or_else(|| "it must be a number between 0 and 1".to_owned())
}

/// Order of a discrete Euler–Lagrange step.
pub fn order(text: &str) -> Result<u8, String> {
    text.parse().ok().filter(|order| matches!(order, 2 | 4)).ok_or_else(|| "it must be 2 or 4".to_owned())
}

/// The kind of a control between samples.
pub fn control(text: &str) -> Result<ControlKind, String> {
    control_of_name(text).ok_or_else(|| "it must be held or linear".to_owned())
}

/// Seed of the random numbers.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("it must be a whole number from 0 to {}", u64::MAX))
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|x: &f64| x.is_finite())
}
