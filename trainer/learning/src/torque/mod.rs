//! Identification of an arm from logged torques.
//!
//! [`Samples`] are a log after resampling, filtering and differentiation. [`linear`] fits the numbers in which torques
//! are linear. [`fit`] finds physically consistent bodies, rotors and friction near a prior, and estimates which
//! numbers the samples determine by themselves. [`excitation`] finds informative motions.

pub mod excitation;
pub mod fit;
pub mod linear;
mod samples;
pub mod series;
mod signal;

pub use samples::{Preparation, SampleError, Samples};
pub use signal::Butterworth;
