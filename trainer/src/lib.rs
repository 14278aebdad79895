//! Host training.

pub mod architecture;
pub mod atomic;
pub mod data;
pub mod ground_truth;
pub mod training;
