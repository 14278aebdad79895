//! Optimal control: regulators, plants, and motions within limits.

#[path = "../common/mod.rs"]
mod common;

mod limits;
mod linear_plant;
mod plants;
mod receding;
mod riccati;
mod swing_up;
