use super::number::{Number, bodies};
use crate::energy::arm::INERTIAL_PARAMETERS;
use crate::energy::bodies::PLANAR_INERTIAL_PARAMETERS;
use core::fmt;

/// Reason why numbers cannot follow a machine together.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// A coordinate, a body or a column of dissipation that the model does not have.
    NoSuch {
        /// The coordinate, body or column, from 0.
        found: u8,
        /// How many there are.
        count: u8,
    },
    /// A body without some of its numbers, or with numbers that do not follow each other.
    PartOfBody {
        /// The body, from 0.
        body: u8,
    },
    /// A gain beside the inertias of all bodies: one scale fits all, so neither is known.
    Gauge {
        /// The coordinate of the gain.
        coordinate: u8,
    },
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NoSuch { found, count } => {
                write!(f, "coordinate, body or column {found} of a model that has {count}, counted from 0")
            }
            Self::PartOfBody { body } => {
                write!(
                    f,
                    "the numbers of body {body} must all be there, one after the other, since they are possible only together"
                )
            }
            Self::Gauge { coordinate } => {
                write!(
                    f,
                    "the gain of coordinate {coordinate} cannot be told from the inertias if all of them may change: leave out a body or the gain"
                )
            }
        }
    }
}

impl core::error::Error for Unfit {}

/// Checks that numbers can follow a machine with n coordinates together.
pub(super) fn check<const P: usize>(numbers: &[Number; P], n: usize) -> Result<(), Unfit> {
    numbers.iter().try_for_each(|number| in_model(*number, n))?;
    let mut before = Number::None;
    for number in numbers {
        in_order(*number, before)?;
        before = *number;
    }
    let mut seen = 0;
    for (k, (first, count)) in bodies(numbers).enumerate() {
        let complete = count == PLANAR_INERTIAL_PARAMETERS || count == INERTIAL_PARAMETERS;
        let body = body_of(numbers.get(first).copied().unwrap_or_default()).unwrap_or_default();
        let again = bodies(numbers).take(k).any(|(other, _)| numbers.get(other) == numbers.get(first));
        if !complete || again {
            return Err(Unfit::PartOfBody { body });
        }
        seen = k + 1;
    }
    let gain = numbers.iter().find_map(|number| match number {
        Number::Gain(coordinate) => Some(*coordinate),
        _ => None,
    });
    gain.filter(|_| seen >= n).map_or(Ok(()), |coordinate| Err(Unfit::Gauge { coordinate }))
}

fn body_of(number: Number) -> Option<u8> {
    match number {
        Number::Inertia { body, .. } => Some(body),
        _ => None,
    }
}

fn in_model(number: Number, n: usize) -> Result<(), Unfit> {
    let found = match number {
        // Only the model says how many units it has.
        Number::None | Number::Potential(_) => return Ok(()),
        Number::Inertia { body, .. } => body,
        Number::Rotor(i)
        | Number::Friction(_, i)
        | Number::Offset(i)
        | Number::Gain(i)
        | Number::Dissipation(i) => i,
    };
    if usize::from(found) < n { Ok(()) } else { Err(Unfit::NoSuch { found, count: n as u8 }) }
}

/// Checks that an inertial number is the first of its body, or follows the one before it.
fn in_order(number: Number, before: Number) -> Result<(), Unfit> {
    match number {
        Number::Inertia { body, index: index @ 1.. } => {
            let follows = before == Number::Inertia { body, index: index - 1 };
            if follows { Ok(()) } else { Err(Unfit::PartOfBody { body }) }
        }
        _ => Ok(()),
    }
}
