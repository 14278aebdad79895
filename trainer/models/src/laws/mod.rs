//! Laws of force beside the energies.

mod actuator;
mod corrections;
mod friction;

pub use actuator::Actuator;
pub use corrections::{CorrectionNetwork, Corrections, DissipationNetwork};
pub(crate) use friction::dry_friction;
pub use friction::{CoordinateFriction, FrictionArchitecture, MOST_LOAD, WIDTHS};
