//! What logged torques say of an arm.
//!
//! [`Samples`] are a log, resampled, filtered and differentiated; [`linear`] fits the numbers that a log determines, [`fit`] finds bodies that are
//! physically consistent, rotors and friction near a prior, and says what samples show alone; [`excitation`] finds motions that show much.

pub mod excitation;
pub mod fit;
pub mod linear;
mod samples;
mod signal;

pub use samples::{Preparation, SampleError, Samples};
pub use signal::Butterworth;
