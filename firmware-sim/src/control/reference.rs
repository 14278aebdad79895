use crate::error::{SetupError, require, require_finite};
use crate::wire::array;
use core::f32::consts::TAU;
use leastaction_core::scalar::Scalar;
use serde::{Deserialize, Serialize};

/// Maximum number of harmonics of a motion.
pub const HARMONICS: usize = 5;

/// A periodic motion, entered from rest ([`enter`]): a Fourier series in the time s since its beginning,
///
/// q_i(s) = centre_i + Σ_k a_ik cos 2πk f_i s + b_ik sin 2πk f_i s.
///
/// Source: Swevers et al., "Optimal robot excitation and identification", 1997 (the series).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<const N: usize> {
    /// Time at which the motion begins, s: the observer needs a few samples before.
    pub begin: f32,
    /// Duration r ≥ 0 of the entry, s; 0 for a motion that begins at rest by itself.
    pub ramp: f32,
    /// Centre, rad or m.
    pub centre: [f32; N],
    /// Frequency f > 0, Hz.
    pub frequency: [f32; N],
    /// Coefficients a and b of every harmonic, rad or m.
    pub waves: [[[f32; 2]; HARMONICS]; N],
}

/// A point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setpoint<const N: usize> {
    /// Position, rad or m.
    #[serde(with = "array")]
    pub q: [f32; N],
    /// Velocity, rad/s or m/s.
    #[serde(with = "array")]
    pub v: [f32; N],
    /// Acceleration, rad/s² or m/s².
    #[serde(with = "array")]
    pub a: [f32; N],
}

/// Desired motion of a mechanism over time.
pub trait Trajectory<const N: usize> {
    /// Position, velocity and acceleration at time t, s.
    fn at(&self, t: f32) -> Setpoint<N>;
    /// Whether t counts from the time when the controller's first command takes effect (until then it is negative), not from the beginning
    /// of the run.
    fn begins_with_command(&self) -> bool {
        false
    }
    /// Checks that the numbers of the trajectory are in their ranges.
    ///
    /// # Errors
    /// The first number that is out of range.
    fn validate(&self) -> Result<(), SetupError> {
        require_finite("trajectory", &self.at(0.0).q)
    }
}

/// Trajectory at rest at a position, rad or m.
impl<const N: usize> Trajectory<N> for [f32; N] {
    fn at(&self, _: f32) -> Setpoint<N> {
        Setpoint { q: *self, v: [0.0; N], a: [0.0; N] }
    }
}

impl<T: Trajectory<N>, const N: usize> Trajectory<N> for &T {
    fn at(&self, t: f32) -> Setpoint<N> {
        (**self).at(t)
    }

    fn begins_with_command(&self) -> bool {
        (**self).begins_with_command()
    }

    fn validate(&self) -> Result<(), SetupError> {
        (**self).validate()
    }
}

/// Target of a command: the desired motion when it takes effect, and while it acts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target<const N: usize> {
    /// Position when the command takes effect, rad or m.
    #[serde(with = "array")]
    pub q: [f32; N],
    /// Velocity when the command takes effect, rad/s or m/s.
    #[serde(with = "array")]
    pub v: [f32; N],
    /// Setpoint in the middle of the tick over which the command is held.
    pub middle: Setpoint<N>,
}

impl<const N: usize> Target<N> {
    /// Target on a trajectory for a command that acts from time `effect` on, over a tick of h, s.
    pub fn of(trajectory: &impl Trajectory<N>, effect: f32, h: f32) -> Self {
        let Setpoint { q, v, .. } = trajectory.at(effect);
        Self { q, v, middle: trajectory.at(effect + 0.5 * h) }
    }
}

impl<const N: usize> Trajectory<N> for Reference<N> {
    fn at(&self, t: f32) -> Setpoint<N> {
        enter(t - self.begin, self.ramp, |s| self.series(s))
    }

    fn validate(&self) -> Result<(), SetupError> {
        require("reference begin", self.begin, self.begin.is_finite(), "finite")?;
        require(
            "reference ramp",
            self.ramp,
            self.ramp.is_finite() && self.ramp >= 0.0,
            "finite and not negative",
        )?;
        require_finite("reference", &self.centre)?;
        require_finite("reference", self.waves.as_flattened().as_flattened())?;
        self.frequency.iter().try_for_each(|f| {
            require("reference frequency", *f, f.is_finite() && *f > 0.0, "finite and positive")
        })
    }
}

/// Computes the setpoint at time t, s, after the beginning of a motion that is entered from rest. `motion` returns
/// the position and its first two derivatives as functions of the motion's own time s. Before the beginning, the
/// setpoint rests at the motion's first point. Over the first r seconds s = r(x³ − x⁴/2) with x = t/r, then s = t −
/// r/2.
pub fn enter<const N: usize>(t: f32, r: f32, motion: impl Fn(f32) -> [[f32; N]; 3]) -> Setpoint<N> {
    if t < 0.0 {
        let [q, ..] = motion(0.0);
        return q.at(0.0);
    }
    let (s, rate, growth) = entered(t, r);
    let [q, slope, curvature] = motion(s);
    Setpoint {
        q,
        v: slope.map(|slope| slope * rate),
        a: core::array::from_fn(|i| curvature[i] * rate * rate + slope[i] * growth),
    }
}

/// s, ds/dt and d²s/dt² at t ≥ 0.
fn entered(t: f32, r: f32) -> (f32, f32, f32) {
    if t >= r {
        return (t - 0.5 * r, 1.0, 0.0);
    }
    let x = t / r;
    (r * x * x * x * (1.0 - 0.5 * x), x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) / r)
}

impl<const N: usize> Reference<N> {
    /// A motion there and back: q_i = from + ½(to − from)(1 − cos 2πf(t − begin)), rad or m and Hz.
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
}
