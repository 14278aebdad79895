//! Learn the energies of a mechanical system from logged motion, on the host.
//!
//! Data flows one way: a log → [`data`] → [`training`] (directed by [`config`] and [`run`]) → [`leastaction_models::file`] → the chip;
//! [`evaluate`] measures.

pub mod checkpoint;
pub mod config;
pub mod evaluate;
pub mod import;
pub mod matrix;
pub mod report;
pub mod run;
pub mod runge_kutta;
pub mod torque;
pub mod torque_numbers;
pub mod torques;
pub mod training;
pub mod windows;

pub use leastaction_data as data;
pub use leastaction_data::{atomic, checksummed, lock};
