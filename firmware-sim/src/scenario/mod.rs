//! Runs of the loop: [`predict()`], [`track()`], [`follow()`], [`gravity()`], [`mpc()`], [`swing_up_pendulum`] and [`swing_up_cartpole`].
//!
//! Each takes a plant, a model, a plain configuration and a sink that sees every tick, and returns a summary. Plant and model may be the
//! same system. A configuration always gives the same trace, bit for bit, on every machine. [`replay()`] runs the firmware along a log
//! instead of a plant. [`run_on`] runs the firmware's part on any [`Processor`](crate::Processor), such as one at the other end of a link,
//! and [`Run`] takes its ticks one by one.

mod follow;
mod gravity;
mod mpc;
mod predict;
mod replay;
mod run;
mod setup;
mod swing_up;
mod track;

pub use follow::{FollowConfig, Followed, follow};
pub use gravity::{Floating, GravityConfig, gravity};
pub use mpc::{Decided, MpcConfig, mpc};
pub use predict::{Excitation, Predict, predict};
pub use replay::{Logged, replay};
pub use run::{Run, RunError, run_on};
pub use setup::{Push, Setup, Start};
pub use swing_up::{SwingUpConfig, swing_up_cartpole, swing_up_pendulum};
pub use track::{TrackConfig, track};
