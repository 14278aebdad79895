//! Models that are a little wrong, like learned ones.
#![allow(dead_code, reason = "each test file uses its share")]

pub mod plans;

use leastaction_core::energy::trigonometric::{Trigonometric, Wave};
use leastaction_core::forces::{System, Viscous};
use leastaction_firmware_sim::devices::{Device, Stream};

pub type Exact<'a, const N: usize> = System<Trigonometric<'a, N>, Viscous<f32, N>>;

/// Inertia and potential of a mechanism whose amplitudes are wrong.
pub struct Perturbed<const N: usize> {
    inertia: Vec<(usize, usize, Wave<N>)>,
    potential: Vec<Wave<N>>,
}

impl<const N: usize> Perturbed<N> {
    /// Every amplitude larger or smaller by the fraction `size`, at random.
    pub fn new(exact: &Trigonometric<'static, N>, size: f64, seed: u64) -> Self {
        let mut stream = Stream::new(!seed, Device::Start);
        let mut wrong = |wave: Wave<N>| {
            let sign = f64::from(stream.symmetric()).signum();
            Wave { amplitude: wave.amplitude * (1.0 + size * sign), ..wave }
        };
        let inertia = exact.inertia.iter().map(|(i, j, wave)| (*i, *j, wrong(*wave))).collect();
        let potential = exact.potential.iter().map(|wave| wrong(*wave)).collect();
        Self { inertia, potential }
    }

    /// Adds a potential of the given amplitude, J, that varies with all coordinates, even with a cart's position, on
    /// which the true potential does not depend.
    #[must_use]
    pub fn with_ripple(mut self, amplitude: f64) -> Self {
        let mut wave = [1.0; N];
        wave[0] = -0.9;
        self.potential.push(Wave { amplitude, wave });
        self
    }

    pub fn system(&self) -> Exact<'_, N> {
        System::conservative(Trigonometric { inertia: &self.inertia, potential: &self.potential })
    }
}
