//! Survey of an unknown log: its columns, its clock, and guesses of the columns' meaning.

mod clock;
mod derivatives;
mod goals;
mod groups;
mod guess;
mod lerobot;
mod motion;
mod raw;
mod signal;
mod words;

pub use clock::Clock;
pub use goals::Goals;
pub use guess::{Guess, time_unit};
pub use motion::{MotionSurvey, Outlier};
pub use raw::RawLog;
pub use signal::Signal;
pub use words::is_of_angle;
