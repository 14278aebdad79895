//! Learning the weights of a model from motion: the losses and the optimisers.
//!
//! These optimisers also train models of other kinds, if they are given as an [`Objective`]: either through a loss over
//! programs ([`objective_of`]), or through the model's [`Residuals`].

mod adam;
mod balance;
mod blocks;
#[cfg(test)]
mod bounds_tests;
mod free_states;
mod gauge;
mod levenberg;
mod limits;
mod linear_start;
mod network_start;
mod normal;
mod objective;
mod residuals;
mod samples;
mod shown;

pub use adam::{Adam, AdamSettings, Schedule};
pub use free_states::{StateNoise, free_states_objective};
pub use gauge::Combination;
pub(crate) use gauge::{Free, FreeDirections, RANK, size, with_unit_diagonal};
pub use leastaction_models::bounds::{Bounds, LEAST, MARGIN, Range};
pub use levenberg::{Levenberg, Progress};
pub use linear_start::{LinearStart, linear_start};
pub use network_start::{Covered, inverse_dynamics, network_start};
pub use normal::NormalEquations;
pub use objective::{
    LossKind, Objective, Offsets, Solved, TorqueTerms, objective, objective_of, torque_objective,
};
pub(crate) use residuals::normal_equations_of;
pub use residuals::{ChunkRows, Failed, Residuals};
pub use samples::{SampleError, Samples};
pub(crate) use shown::Directions;
pub use shown::{Shown, student};
