//! Host training.

pub mod atomic;
pub mod data;
