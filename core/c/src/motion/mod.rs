//! Motion of mechanisms: by the discrete Euler-Lagrange equation, or by RATTLE if there may be rods.

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

/// A step h, s, and the bounds of Newton's method in it.
pub(crate) struct Step {
    pub h: f32,
    pub newton: Newton<f32>,
}
