use super::{CartPump, JointPump, Pump, PumpConfig};
use crate::Mechanism;
use crate::error::SetupError;

/// A number of coordinates N, as a type.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates<const N: usize>;

/// Number of numbers in a state (q, v): D is 2N, for N up to 12. The length of an array cannot be computed from N.
pub trait States<const D: usize> {}

macro_rules! states {
    ($($n:literal)*) => { $(impl States<{ 2 * $n }> for Coordinates<$n> {})* };
}
states!(1 2 3 4 5 6 7 8 9 10 11 12);

/// Numbers of coordinates of the mechanisms that a pump brings upright, θ = 0: a pendulum, q = θ, and a cart with its pole, q = (x, θ).
pub trait SwungUp<M, const N: usize> {
    /// The pump.
    type Pump: Pump<M, N>;

    /// Creates the pump.
    ///
    /// # Errors
    /// [`SetupError::OutOfRange`], also for a model whose potential is no higher upright than hanging.
    fn pump(model: &M, config: PumpConfig) -> Result<Self::Pump, SetupError>;
}

impl<M: Mechanism<1>> SwungUp<M, 1> for Coordinates<1> {
    type Pump = JointPump;

    fn pump(model: &M, config: PumpConfig) -> Result<JointPump, SetupError> {
        JointPump::new(model, 0.0, config)
    }
}

impl<M: Mechanism<2>> SwungUp<M, 2> for Coordinates<2> {
    type Pump = CartPump;

    fn pump(model: &M, config: PumpConfig) -> Result<CartPump, SetupError> {
        CartPump::new(model, 0.0, config)
    }
}
