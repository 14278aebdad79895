use super::{Device, Stream};
use crate::angle::wrap;
use crate::error::{SetupError, require};
use core::f32::consts::TAU;

/// An encoder of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderConfig {
    /// Whether the coordinate is an angle, whose readings are wrapped to [−π, π].
    pub angle: bool,
    /// Size of one count, rad or m; 0: infinitely fine.
    pub resolution: f32,
    /// Zero, the excess of the reading over the true position, rad or m.
    pub zero: f32,
    /// Standard deviation of Gaussian noise before quantisation, rad or m, ≥ 0.
    pub noise: f32,
    /// Probability that a sample does not arrive, 0 to 1.
    pub drop: f32,
}

impl EncoderConfig {
    /// An absolute encoder on a shaft: 4,096 counts per turn, noise 1 mrad, nothing dropped.
    pub const fn rotary() -> Self {
        Self { angle: true, resolution: TAU / 4096.0, zero: 0.0, noise: 1e-3, drop: 0.0 }
    }

    /// A linear encoder: 20,000 counts per metre, noise 0.2 mm, nothing dropped.
    pub const fn linear() -> Self {
        Self { angle: false, resolution: 1.0 / 20_000.0, zero: 0.0, noise: 2e-4, drop: 0.0 }
    }

    /// The encoder without noise, quantisation or drops.
    #[must_use]
    pub const fn perfect(self) -> Self {
        Self { resolution: 0.0, noise: 0.0, drop: 0.0, ..self }
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        let amount = |x: f32| x.is_finite() && x >= 0.0;
        let Self { resolution, zero, noise, drop, .. } = *self;
        require("encoder resolution", resolution, amount(resolution), "finite and not negative")?;
        require("encoder zero", zero, zero.is_finite(), "finite")?;
        require("encoder noise", noise, amount(noise), "finite and not negative")?;
        require("encoder drop probability", drop, (0.0..=1.0).contains(&drop), "from 0 to 1")
    }

    /// Reading at x with a noise of `deviation` standard deviations.
    fn read(&self, x: f32, deviation: f32) -> f32 {
        let noisy = x + self.zero + self.noise * deviation;
        let reading = if self.resolution > 0.0 {
            libm::roundf(noisy / self.resolution) * self.resolution
        } else {
            noisy
        };
        if self.angle { wrap(reading) } else { reading }
    }
}

/// The encoders of all coordinates.
#[derive(Clone, Debug)]
pub struct Encoders<const N: usize> {
    config: [EncoderConfig; N],
    stream: Stream,
}

impl<const N: usize> Encoders<N> {
    /// Creates encoders that draw from the seed's encoder stream.
    pub fn new(config: [EncoderConfig; N], seed: u64) -> Self {
        Self { config, stream: Stream::new(seed, Device::Encoder) }
    }

    /// Samples every coordinate, rad or m; `None` for a dropped sample. Readings are finite.
    pub fn sample(&mut self, q: &[f32; N]) -> [Option<f32>; N] {
        core::array::from_fn(|i| {
            let (deviation, dropped) = (self.stream.normal(), self.stream.happens(self.config[i].drop));
            let reading = self.config[i].read(q[i], deviation);
            (!dropped && reading.is_finite()).then_some(reading)
        })
    }
}
