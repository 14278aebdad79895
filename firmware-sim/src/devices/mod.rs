//! Devices between the firmware and the mechanism: encoders, actuators and the clock, with their faults.

mod actuator;
mod clock;
mod encoder;
mod random;

pub(crate) use actuator::require_ticks;
pub use actuator::{Actuator, ActuatorConfig, DelayLine, Drive, LearnedActuator, MAX_DELAY};
pub use clock::{Arrival, Clock, ClockConfig};
pub use encoder::{EncoderConfig, Encoders};
pub use random::{Device, Stream};

use crate::error::SetupError;

/// All devices of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Devices<const N: usize> {
    /// One encoder per coordinate.
    pub encoders: [EncoderConfig; N],
    /// The actuators.
    pub actuator: ActuatorConfig<N>,
    /// The clock.
    pub clock: ClockConfig,
}

impl<const N: usize> Devices<N> {
    /// Creates realistic devices: the given encoders, actuators with the given limits (N or N m) and one tick of delay, a perfect clock.
    pub const fn new(encoders: [EncoderConfig; N], limit: [f32; N]) -> Self {
        Self { encoders, actuator: ActuatorConfig::new(limit), clock: ClockConfig::perfect() }
    }

    /// The devices made ideal: exact encoders (whose zeros stay), no delay, a perfect clock. Limits, gains and offsets of the actuators
    /// stay.
    #[must_use]
    pub fn perfect(self) -> Self {
        Self {
            encoders: self.encoders.map(EncoderConfig::perfect),
            actuator: ActuatorConfig { delay: 0.0, lag: 0.0, ..self.actuator },
            clock: ClockConfig::perfect(),
        }
    }

    /// Flags of the coordinates that are angles.
    pub fn angles(&self) -> [bool; N] {
        self.encoders.map(|encoder| encoder.angle)
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        self.encoders.iter().try_for_each(EncoderConfig::validate)?;
        self.actuator.validate()?;
        self.clock.validate()
    }
}
