use super::{CartPump, JointPump, Pump, PumpConfig};
use crate::Mechanism;
use crate::error::SetupError;
use leastaction_core::control::Coordinates;

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
