//! Numbers of a model that follow a machine along its logs, in the chip's own arithmetic.
//!
//! ```text
//! model ─► Choice: which numbers, how far they may go ─┐
//! log of the training ─► deviations: how well the model explains it ─┴─► Followed: the Course along another log, what is attached, how sure
//! ```
//!
//! [`drift`] says from day to day whether the machine is still the one that was learned, for models of every family.

mod along;
mod choice;
mod deviations;
pub mod drift;
mod error;
mod followed;
mod names;
mod remaining;
mod saved;
mod source;
mod ticks;

pub use along::{Course, Entry, along};
pub use choice::{Choice, Request};
pub use deviations::{deviations, of_windows};
pub use error::AdaptationError;
pub use followed::Followed;
pub use leastaction_core::adapt::{Difference, Following};
pub use names::{Group, Label};
pub use remaining::remaining;
pub use saved::{Patched, PatchedNumber, patch_file};
pub use source::SETTINGS_HEAD;

use choice::with_distances;
use leastaction_models::Model;
use leastaction_replica::{ModelFile, Replica};

/// Calls a function with the model in the chip's arithmetic.
///
/// # Errors
/// [`AdaptationError`] of a model that the chip's arithmetic does not know, and those of the function.
pub fn on_chip<T>(
    model: &Model,
    of: impl FnOnce(&Replica) -> Result<T, AdaptationError>,
) -> Result<T, AdaptationError> {
    let bytes = model.to_bytes().map_err(|error| AdaptationError::Encoding(error.to_string()))?;
    let file = ModelFile::new(&bytes)?;
    of(&file.replica(model.architecture.part().map(|(_, name)| name))?)
}
