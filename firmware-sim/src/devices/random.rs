use core::f32::consts::TAU;
use leastaction_core::scalar::Scalar;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Sources of random numbers, each with a stream of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Device {
    /// The initial state.
    Start,
    /// The encoders.
    Encoder,
    /// The clock.
    Clock,
    /// A push.
    Push,
}

/// A device's own stream of random numbers: it depends only on the seed, not on the draws of other devices.
#[derive(Clone, Debug)]
pub struct Stream(Pcg32);

impl Stream {
    /// The stream of a device under a seed.
    pub fn new(seed: u64, device: Device) -> Self {
        // `seed_from_u64` hashes its argument into state and increment, so neighbouring numbers give unrelated streams.
        Self(Pcg32::seed_from_u64(seed.rotate_left(8) ^ device as u64))
    }

    /// Uniform in [0, 1), a multiple of 2⁻²⁴.
    pub fn uniform(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / 16_777_216.0
    }

    /// Uniform in [−1, 1).
    pub fn symmetric(&mut self) -> f32 {
        2.0 * self.uniform() - 1.0
    }

    /// Standard normal (Box–Muller, in single precision: at most 5.8 in size).
    pub fn normal(&mut self) -> f32 {
        // The trait's functions by name: where std is linked, `x.sin_cos()` would be the platform's, with other bits.
        let radius = Scalar::sqrt(-2.0 * Scalar::ln_1p(-self.uniform()));
        let (_, cos) = Scalar::sin_cos(TAU * self.uniform());
        radius * cos
    }

    /// True with the given probability; always draws one number.
    pub fn happens(&mut self, probability: f32) -> bool {
        self.uniform() < probability
    }
}
