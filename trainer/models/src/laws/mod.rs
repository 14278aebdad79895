//! Laws of force beside the energies.

mod actuator;
pub mod corrections;
pub mod friction;
pub(crate) mod numbers;
pub mod servo;

pub use actuator::Actuator;
pub use corrections::{CorrectionNetwork, Corrections, DissipationNetwork};
pub(crate) use friction::dry_friction;
pub use friction::{CoordinateFriction, FrictionArchitecture, MOST_LOAD, WIDTH_PARTS, WIDTHS};
pub use servo::Servo;
