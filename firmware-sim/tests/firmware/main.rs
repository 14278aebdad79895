//! The control loop, its devices and scenarios, and the link.

#[path = "../common/mod.rs"]
mod common;

mod adapting;
mod determinism;
mod devices;
mod faults;
mod follow;
mod gravity;
mod guarded;
mod link;
mod mpc;
mod observer;
mod plant;
mod predict;
mod regulator;
mod replay;
mod setup;
mod steps;
mod swing_up;
mod track;
