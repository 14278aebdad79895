use crate::error::{SetupError, require};
use crate::wire::array;
use core::f32::consts::TAU;
use leastaction_core::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Harmonics of a motion at most.
pub const HARMONICS: usize = 5;

/// A periodic motion, entered from rest: a Fourier series of the time s since it began,
///
/// q_i(s) = centre_i + Σ_k a_ik cos 2πk f_i s + b_ik sin 2πk f_i s.
///
/// Over the first `ramp` seconds r time itself sets in, s = r(x³ − x⁴/2) with x = t/r, so that velocity and acceleration begin at 0;
/// then s = t − r/2. Source: Swevers et al., "Optimal robot excitation and identification", 1997 (the series).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference<const N: usize> {
    /// When it begins, s: the observer needs a few samples before.
    pub begin: f32,
    /// r ≥ 0, s: 0 for a motion that begins at rest by itself.
    pub ramp: f32,
    /// rad or m.
    #[serde(with = "array")]
    pub centre: [f32; N],
    /// f > 0, Hz.
    #[serde(with = "array")]
    pub frequency: [f32; N],
    /// a and b of every harmonic, rad or m.
    #[serde(with = "array")]
    pub waves: [[[f32; 2]; HARMONICS]; N],
}

/// A point of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint<const N: usize> {
    /// Position.
    pub q: [f32; N],
    /// Velocity.
    pub v: [f32; N],
    /// Acceleration.
    pub a: [f32; N],
}

impl<const N: usize> Reference<N> {
    /// There and back: q_i = from + ½(to − from)(1 − cos 2πf(t − begin)), rad or m and Hz.
    pub const fn there_and_back(begin: f32, from: [f32; N], to: [f32; N], frequency: [f32; N]) -> Self {
        let (mut centre, mut waves) = (from, [[[0.0; 2]; HARMONICS]; N]);
        let mut i = 0;
        while i < N {
            let half = 0.5 * (to[i] - from[i]);
            centre[i] += half;
            waves[i][0][0] = -half;
            i += 1;
        }
        Self { begin, ramp: 0.0, centre, frequency, waves }
    }

    /// Position, velocity and acceleration at time t, s.
    pub fn at(&self, t: f32) -> Setpoint<N> {
        let t = t - self.begin;
        if t < 0.0 {
            let [q, ..] = self.series(0.0);
            return Setpoint { q, v: [0.0; N], a: [0.0; N] };
        }
        let (s, rate, growth) = self.entered(t);
        let [q, slope, curvature] = self.series(s);
        Setpoint {
            q,
            v: slope.map(|slope| slope * rate),
            a: core::array::from_fn(|i| curvature[i] * rate * rate + slope[i] * growth),
        }
    }

    /// s, ds/dt and d²s/dt² at t ≥ 0.
    fn entered(&self, t: f32) -> (f32, f32, f32) {
        let r = self.ramp;
        if t >= r {
            return (t - 0.5 * r, 1.0, 0.0);
        }
        let x = t / r;
        (r * x * x * x * (1.0 - 0.5 * x), x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) / r)
    }

    /// The series and its first two derivatives.
    fn series(&self, s: f32) -> [[f32; N]; 3] {
        let mut sums = [self.centre, [0.0; N], [0.0; N]];
        for (i, (waves, frequency)) in self.waves.iter().zip(self.frequency).enumerate() {
            for (k, [a, b]) in waves.iter().enumerate().filter(|(_, wave)| **wave != [0.0; 2]) {
                let omega = TAU * frequency * (k + 1) as f32;
                let (sin, cos) = Scalar::sin_cos(omega * s);
                let wave = a * cos + b * sin;
                let terms = [wave, omega * (b * cos - a * sin), -omega * omega * wave];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| sum[i] += term);
            }
        }
        sums
    }

    pub(crate) fn validate(&self) -> Result<(), SetupError> {
        require("reference begin", self.begin, self.begin.is_finite(), "finite")?;
        require(
            "reference ramp",
            self.ramp,
            self.ramp.is_finite() && self.ramp >= 0.0,
            "finite and not negative",
        )?;
        for x in self.centre.iter().chain(self.waves.as_flattened().as_flattened()) {
            require("reference", *x, x.is_finite(), "finite")?;
        }
        self.frequency.iter().try_for_each(|f| {
            require("reference frequency", *f, f.is_finite() && *f > 0.0, "finite and positive")
        })
    }
}
