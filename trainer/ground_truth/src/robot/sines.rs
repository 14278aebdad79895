use super::settings::Excitation;
use rand::{Rng, RngExt};
use std::f64::consts::TAU;

/// A sum of sines, Σ a sin(2πft + φ).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sines(Vec<Sine>);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sine {
    amplitude: f64,
    frequency: f64,
    phase: f64,
}

impl Sines {
    /// Draws the sines: amplitudes and frequencies uniform in their ranges, phases uniform in a turn.
    pub fn draw(excitation: &Excitation, stream: &mut impl Rng) -> Self {
        let Excitation { sines, frequency, amplitude } = *excitation;
        let mut uniform = |[least, greatest]: [f64; 2]| least + (greatest - least) * stream.random::<f64>();
        let mut one = || Sine {
            amplitude: uniform(amplitude),
            frequency: uniform(frequency),
            phase: uniform([0.0, TAU]),
        };
        Self((0..sines).map(|_| one()).collect())
    }

    /// The sum at time t, s.
    pub fn at(&self, t: f64) -> f64 {
        self.0.iter().map(|sine| sine.amplitude * (TAU * sine.frequency * t + sine.phase).sin()).sum()
    }
}
