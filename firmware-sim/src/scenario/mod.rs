//! Runs of the loop: [`predict()`], [`track()`], [`swing_up_pendulum`] and [`swing_up_cartpole`].
//!
//! Each takes a plant, a model, a plain configuration and a sink that sees every tick, and returns a summary. Plant and
//! model may be the same system. The same configuration gives the same trace, bit for bit, on every machine.

mod predict;
mod run;
mod setup;
mod swing_up;
mod track;

pub use predict::{Excitation, Predict, predict};
pub use setup::{Setup, Start};
pub use swing_up::{SwingUpConfig, swing_up_cartpole, swing_up_pendulum};
pub use track::{TrackConfig, track};
