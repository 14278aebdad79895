//! How mechanisms move: by the discrete Euler-Lagrange equation, and where there may be rods by RATTLE.

#[cfg(not(feature = "rods"))]
mod del;
#[cfg(feature = "rods")]
mod rattle;

#[cfg(not(feature = "rods"))]
use del as chosen;
#[cfg(feature = "rods")]
use rattle as chosen;

pub(crate) use chosen::{
    CoreState, acceleration, between, default_newton, energies, inverse_dynamics, momentum, start, step,
};

#[cfg(not(feature = "rods"))]
pub(crate) use del::{gravity_torque, mass_matrix};

use leastaction_core::discrete::Newton;

/// A step h, s, and how far Newton's method goes in it.
pub(crate) struct Step {
    pub h: f32,
    pub newton: Newton<f32>,
}
