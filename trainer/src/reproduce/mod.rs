//! The papers' experiments, ours beside theirs.

pub mod symo;
