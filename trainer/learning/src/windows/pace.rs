//! Placement of integration steps relative to samples.

use super::logs::WindowLogs;
use std::ops::Range;

/// Largest interpolation error of positions within a step, relative to the sensor's noise.
const PART: f64 = 0.1;
/// Error of the cubic through two positions and velocities, at its middle, relative to the fourth difference of
/// positions at the same spacing.
const OF_FOURTH_DIFFERENCE: f64 = 1.0 / 384.0;

/// Ratio of steps to samples; at least one of the two numbers is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// Samples per step. Positions at samples within a step come from the cubic through positions and velocities at its ends.
    pub samples: usize,
    /// Steps per sample.
    pub substeps: usize,
}

impl Pace {
    /// The longest steps up to `longest` (s) whose cubics err negligibly relative to the noise of every sensor.
    pub(super) fn new(logs: &WindowLogs, of: Range<usize>, longest: f64, noise: &[f64]) -> Self {
        let samples = (longest / logs.h + 1e-6).floor() as usize;
        if samples < 2 {
            let substeps = (logs.h / longest - 1e-6).ceil() as usize;
            return Self { samples: 1, substeps: substeps.max(1) };
        }
        let is_smooth = |samples: &usize| {
            let error = |i: usize| OF_FOURTH_DIFFERENCE * logs.fourth_difference(of.clone(), i, *samples);
            noise.iter().enumerate().all(|(i, noise)| error(i) <= PART * noise)
        };
        Self { samples: (2..=samples).rev().find(is_smooth).unwrap_or(1), substeps: 1 }
    }

    /// One step from each sample to the next.
    pub(super) fn of_samples() -> Self {
        Self { samples: 1, substeps: 1 }
    }

    /// Steps per sample.
    pub fn steps_in_sample(self) -> f64 {
        self.substeps as f64 / self.samples as f64
    }

    /// The number of samples, rounded down to a whole number of steps (at least one step).
    pub(super) fn whole(self, samples: usize) -> usize {
        (samples / self.samples).max(1) * self.samples
    }
}

/// Hermite's cubic: weights that give the position at the fraction `part` of a step of h, for q and v at its start, and
/// for q and v at its end.
pub(super) fn cubic(part: f64, h: f64) -> [[f64; 2]; 2] {
    let rest = 1.0 - part;
    let start = [rest * rest * (1.0 + 2.0 * part), h * part * rest * rest];
    [start, [part * part * (3.0 - 2.0 * part), -h * part * part * rest]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Dataset, Rows, Trajectory};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// A swing of one radian at 1 Hz, logged at 1 kHz.
    fn logs(noise: f64) -> WindowLogs {
        let mut stream = Pcg64::seed_from_u64(1);
        let mut q = |k: usize| {
            (std::f64::consts::TAU * 1e-3 * k as f64).sin() + noise * stream.random_range(-1.0..1.0)
        };
        let q = Rows::from_flat(1, (0..2000).map(&mut q).collect()).unwrap();
        let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None };
        WindowLogs::new(&Dataset { n: 1, h: 1e-3, control: None, trajectories: vec![trajectory] })
    }

    fn pace(noise: f64, longest: f64) -> Pace {
        let logs = logs(noise);
        Pace::new(&logs, 0..1, longest, &[logs.noise(0..1, 0)])
    }

    #[test]
    fn steps_are_as_long_as_noise_hides() {
        assert_eq!(pace(1e-3, 0.005), Pace { samples: 5, substeps: 1 });
        assert_eq!(pace(1e-3, 0.0004), Pace { samples: 1, substeps: 3 });
        // The error is (2π m h)⁴/384 rad; it is compared with a tenth of the noise.
        let some = pace(1e-7, 0.02).samples;
        assert!((1..12).contains(&some), "{some}");
        assert!(pace(1e-5, 0.02).samples > some);
    }

    #[test]
    fn a_cubic_is_exact_for_cubics() {
        let (h, part) = (0.3, 0.7);
        let q = |t: f64| [1.0 - t + 2.0 * t * t - 4.0 * t * t * t, -1.0 + 4.0 * t - 12.0 * t * t];
        let [start, end] = cubic(part, h);
        let sum = |shares: [f64; 2], of: [f64; 2]| shares[0] * of[0] + shares[1] * of[1];
        let own = sum(start, q(0.0)) + sum(end, q(h));
        assert!((own - q(part * h)[0]).abs() < 1e-14);
    }
}
