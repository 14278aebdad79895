//! What is in a log of which nothing is known yet: its columns, its clock, and what its columns may be.

mod clock;
mod guess;
mod motion;
mod raw;
mod signal;

pub use clock::Clock;
pub use guess::{Guess, time_unit};
pub use motion::{MotionSurvey, Outlier};
pub use raw::RawLog;
pub use signal::Signal;
