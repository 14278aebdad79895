//! Motions of a model: plans from a start to a goal within the limits of drives, joints and speeds, with the gains that follow them.
//!
//! Data flows one way:
//!
//! ```text
//! PlanConfig (TOML) ─► Machine (the model, names and limits of its joints)
//!                  └─► Task (numbers, checked) ─► plan: start guesses ─► iterative LQR, several side by side ─► Plan ─► page (HTML)
//!
//! linearise (a model's step) ─► LinearSystem ─► delayed (drives that act late) ─► regulator
//! ```
//!
//! `leastaction-core` does the numerical work in [`control`](leastaction_core::control), the steps in the chip's arithmetic: the states of
//! a plan are those that the chip computes under its commands.

mod attempt;
mod check;
mod config;
mod configured;
mod delay;
mod error;
mod file;
mod follow;
mod guess;
pub mod interior;
mod linearise;
mod lqr;
mod machine;
mod page;
mod plan;
mod plant;
pub mod policy;
mod problem;
mod search;
mod task;
mod words;

pub use check::Trials;
pub use config::PlanConfig;
pub use error::PlanError;
pub use linearise::{NodeStep, linearise};
pub use lqr::{LinearRegulator, LinearSystem, LqrError, MAX_DELAY};
pub use machine::Machine;
pub use nalgebra::DMatrix;
pub use page::{Part, Scene, View, moving_picture, page};
pub use plan::{Plan, PlanNode, StartReport, Tube};
pub(crate) use problem::ACCEPTED;
pub use search::{Progress, plan};
pub use task::{Check, CostWeights, Follow, Goal, LimitsOf, PolicyNumbers, Search, Task};
