//! RealAIGym, the competition of ICRA 2025 on a double pendulum with one drive (DFKI): its simulator, its rules, and its three tables.
//!
//! Data flows one way: [`DoublePendulum`] ─► simulation ─► courses of runs, disturbed or imperfect ─► scores ─► [`Row`]s beside the published
//! ones. Controllers are [`Policy`]s, made by [`Controller::prepare`].

mod anywhere;
mod disturbance;
mod driven;
mod economical;
mod learned;
mod model;
mod observed;
mod plant;
mod policy;
mod published;
mod ramped;
mod robustness;
mod rows;
mod scores;
mod simulation;
mod tables;
#[cfg(test)]
mod tests;
mod tvlqr;

pub use learned::from_real;
pub use model::{Believed, Known, Model};
pub use plant::{DoublePendulum, State, UPRIGHT};
pub use policy::{ControlError, Controller, Maker, Policy, Robot, TICK, TORQUE_LIMIT};
pub use rows::{Report, Row};
pub use tables::{Table, rows};
