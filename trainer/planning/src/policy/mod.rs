//! Policies: from anywhere to a posture, as fast as the drives can, and hold it there.
//!
//! Data flows one way:
//!
//! ```text
//! Setting (plant of a node, plant of a tick, Aim, regulator at the goal)
//!    ├─► Reaching: start guess ─► interior point ─► fewer and fewer nodes ─► shortest motion that the regulator catches
//!    ├─► Library: motions from many starts, each found with the help of those before
//!    └─► Law: follow a motion, hold the goal, search again where neither will do
//! ```
//!
//! [`Policy`] is all of it for a model. Nothing else here knows a mechanism: states are (q, v), and a plant makes the steps.
//!
//! Sources: Atkeson and Stephens, "Random sampling of states in dynamic programming", 2008 (motions that are improved from those of their
//! neighbours); Tedrake, "LQR-trees: feedback motion planning on sparse randomized trees", 2009.

mod clock;
mod guesses;
mod law;
mod library;
mod object;
mod reach;
mod sampler;
mod setting;

pub use law::{Command, Known, Law, State};
pub use library::Library;
pub use object::{Decider, Decision, Policy};
pub use reach::Reaching;
pub use sampler::Starts;
pub use setting::{Aim, Setting};
