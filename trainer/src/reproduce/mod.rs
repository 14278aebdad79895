//! The papers' experiments, ours beside theirs.

pub mod modlanet;
pub mod symo;
