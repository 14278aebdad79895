use super::{CartPump, JointPump, Pump, PumpConfig};
use crate::Mechanism;
use crate::error::SetupError;
use leastaction_core::control::Coordinates;

/// Numbers of coordinates of the mechanisms that a pump brings upright, θ = 0: a pendulum, q = θ, and a cart with its pole, q = (x, θ).
pub trait SwungUp<const N: usize> {
    /// The pump.
    type Pump: Pump<N>;

    /// Creates the pump.
    ///
    /// # Errors
    /// [`SetupError::OutOfRange`], also for a model whose potential is no higher upright than hanging.
    fn pump<M: Mechanism<N>>(model: &M, config: PumpConfig) -> Result<Self::Pump, SetupError>;
}

impl SwungUp<1> for Coordinates<1> {
    type Pump = JointPump;

    fn pump<M: Mechanism<1>>(model: &M, config: PumpConfig) -> Result<JointPump, SetupError> {
        JointPump::new(model, 0.0, config)
    }
}

impl SwungUp<2> for Coordinates<2> {
    type Pump = CartPump;

    fn pump<M: Mechanism<2>>(model: &M, config: PumpConfig) -> Result<CartPump, SetupError> {
        CartPump::new(model, 0.0, config)
    }
}
