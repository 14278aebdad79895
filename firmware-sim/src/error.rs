use core::fmt;
use leastaction_core::plan::PlanError;

/// Reason why a scenario cannot begin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// A number of the configuration, or one computed from the model, is out of its range.
    OutOfRange {
        /// Name of the number.
        what: &'static str,
        /// Value of the number.
        value: f32,
        /// Range of the number.
        range: Range,
    },
    /// The model's inertia matrix at the upright position cannot be inverted.
    SingularInertia,
    /// The model cannot be stepped from its upright position, or no gain makes the motions about it die out: this input cannot hold it.
    NotStabilisable,
    /// The task needs a swing-up, which exists only for mechanisms of one and two coordinates.
    NoSwingUp,
    /// The task decides at every tick, and the program does not, or the other way round.
    NoMpc,
    /// The task needs a plan, and there is none.
    NoPlan,
    /// The plan is refused.
    Plan(PlanError),
    /// The plan was made for ticks of another length.
    PlanTick {
        /// The plan's tick, s.
        planned: f32,
        /// The program's tick, s.
        tick: f32,
    },
    /// The plan takes a coordinate as an angle, but the coordinate's encoder does not.
    PlanAngle {
        /// The coordinate, from 0.
        coordinate: u8,
    },
}

/// Valid range of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Range {
    /// A range in words.
    Words(&'static str),
    /// A single valid number, and the reason.
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
            Self::NoMpc => {
                write!(
                    f,
                    "only the task mpc decides at every tick, in a program made for it: choose another task"
                )
            }
            Self::NoPlan => write!(f, "there is no plan to follow"),
            Self::Plan(error) => write!(f, "the plan: {error}"),
            Self::PlanTick { planned, tick } => {
                write!(f, "the plan has ticks of {planned} s, the program of {tick} s: they must be equal")
            }
            Self::PlanAngle { coordinate } => {
                write!(f, "the plan takes coordinate {coordinate} as an angle, its encoder does not")
            }
        }
    }
}

impl core::error::Error for SetupError {}

impl From<PlanError> for SetupError {
    fn from(error: PlanError) -> Self {
        Self::Plan(error)
    }
}

/// Checks a condition on `value`, which `range` expresses in words.
pub(crate) fn require(
    what: &'static str,
    value: f32,
    condition: bool,
    range: &'static str,
) -> Result<(), SetupError> {
    let range = Range::Words(range);
    if condition { Ok(()) } else { Err(SetupError::OutOfRange { what, value, range }) }
}

/// Checks that all values are finite.
pub(crate) fn require_finite(what: &'static str, values: &[f32]) -> Result<(), SetupError> {
    values.iter().try_for_each(|x| require(what, *x, x.is_finite(), "finite"))
}
