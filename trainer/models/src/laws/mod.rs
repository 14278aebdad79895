//! Laws of force beside the energies.

mod actuator;
pub mod corrections;
pub mod friction;
pub mod group;
pub(crate) mod numbers;
pub mod servo;
pub mod stops;

pub use actuator::{Actuator, LaggingCommands};
pub use corrections::{CorrectionNetwork, Corrections, DissipationNetwork};
pub use friction::{CoordinateFriction, DryNumbers};
pub use group::{GroupLaws, LawEntry, MOST_LOAD, NumberKind, WIDTH_PARTS, WIDTHS};
pub use stops::StopNumbers;
