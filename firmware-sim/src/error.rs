use core::fmt;

/// Why a scenario cannot begin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// A number of the configuration, or one that the model gives, is out of its range.
    OutOfRange {
        /// Which.
        what: &'static str,
        /// What it was set to.
        value: f32,
        /// What it must be.
        range: Range,
    },
    /// The model's inertia matrix at the upright position cannot be inverted.
    SingularInertia,
    /// The Riccati equation has no finite solution for the model: its upright position cannot be held by this input.
    NotStabilisable,
    /// Only mechanisms of one and two coordinates are brought upright.
    NoSwingUp,
}

/// What a number of a configuration must be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Range {
    /// In words.
    Words(&'static str),
    /// One number, and why.
    Only(f32, &'static str),
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Words(words) => f.write_str(words),
            Self::Only(value, why) => write!(f, "{value}, {why}"),
        }
    }
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::OutOfRange { what, value, range } => write!(f, "{what} is {value}, but must be {range}"),
            Self::SingularInertia => {
                write!(f, "the model's inertia matrix at the upright position is singular: train it further")
            }
            Self::NotStabilisable => {
                write!(f, "no feedback holds the model upright: train it further, or check its coordinates")
            }
            Self::NoSwingUp => {
                write!(f, "only a pendulum and a pole on a cart are brought upright: choose another task")
            }
        }
    }
}

impl core::error::Error for SetupError {}

/// `value` if it satisfies the condition, which `range` says in words.
pub(crate) fn require(
    what: &'static str,
    value: f32,
    condition: bool,
    range: &'static str,
) -> Result<(), SetupError> {
    let range = Range::Words(range);
    if condition { Ok(()) } else { Err(SetupError::OutOfRange { what, value, range }) }
}

/// Whether all of them are finite.
pub(crate) fn require_finite(what: &'static str, values: &[f32]) -> Result<(), SetupError> {
    values.iter().try_for_each(|x| require(what, *x, x.is_finite(), "finite"))
}
