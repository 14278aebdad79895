//! The papers' experiments, ours beside theirs.

pub mod lgnn;
pub mod modlanet;
pub mod symo;
