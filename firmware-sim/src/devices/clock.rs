use super::{Device, Stream};
use crate::error::{SetupError, require};

/// Faults of the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClockConfig {
    /// Probability that a tick comes late, 0 to 1.
    pub late: f32,
    /// Largest lateness as a fraction of the tick, 0 to 1; the lateness of a late tick is uniform below it.
    pub jitter: f32,
    /// Probability that a tick is missed: the firmware does not run and the last command is repeated, 0 to 1.
    pub missed: f32,
}

impl ClockConfig {
    /// A clock with every tick on time.
    pub const fn perfect() -> Self {
        Self { late: 0.0, jitter: 0.0, missed: 0.0 }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        let fractions =
            [("late probability", self.late), ("jitter", self.jitter), ("missed probability", self.missed)];
        for (what, x) in fractions {
            require(what, x, (0.0..=1.0).contains(&x), "from 0 to 1")?;
        }
        Ok(())
    }
}

/// Arrival of a tick at the firmware.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Lateness as a fraction of the tick.
    pub lateness: f32,
    /// Whether the tick was missed.
    pub missed: bool,
}

/// The timer that wakes the firmware.
#[derive(Clone, Debug)]
pub struct Clock {
    config: ClockConfig,
    stream: Stream,
}

impl Clock {
    /// Creates a clock that draws from the seed's clock stream.
    pub fn new(config: ClockConfig, seed: u64) -> Self {
        Self { config, stream: Stream::new(seed, Device::Clock) }
    }

    /// The next tick.
    pub fn tick(&mut self) -> Arrival {
        let (late, fraction) = (self.stream.happens(self.config.late), self.stream.uniform());
        let lateness = if late { fraction * self.config.jitter } else { 0.0 };
        Arrival { lateness, missed: self.stream.happens(self.config.missed) }
    }
}
