//! Detection of noise in a log.

use super::scales::robust_deviation;
use crate::data::Dataset;

/// Noise of a coordinate relative to its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The coordinate.
    pub coordinate: usize,
    /// Robust standard deviation of the noise, m or rad.
    pub deviation: f64,
    /// Fraction of the second differences of positions, which stand for accelerations, that is due to noise.
    pub part: f64,
}

/// Fraction of second differences below which noise does not matter; a log of exact motion in single precision is below
/// it.
const PART: f64 = 0.02;
/// Growth per order of differences, from third to fifth, that distinguishes noise from motion. White noise grows by
/// (252/20)^¼ ≈ 1.88. Exact motion grows less: by 1.5 under a held control that changes at every sample, and under a
/// smooth control by less, the shorter the step is.
const RATIO: f64 = 1.66;
/// Least number of differences: with fewer of them the ratio is unreliable.
const FEWEST: usize = 100;

/// The noisiest coordinate, if any coordinate is noisy, judged by the growth of differences of high order.
pub fn noise_of(data: &Dataset) -> Option<Noise> {
    let each = (0..data.n).filter_map(|coordinate| {
        let [second, third, fifth] = [2, 3, 5].map(|order| difference(data, coordinate, order));
        let deviation = fifth / 252_f64.sqrt();
        let part = 6_f64.sqrt() * deviation / second;
        let is_noise = (fifth / third).sqrt() > RATIO && part > PART;
        is_noise.then_some(Noise { coordinate, deviation, part })
    });
    each.max_by(|a, b| a.part.total_cmp(&b.part))
}

/// The robust standard deviation of a coordinate's differences of the given order.
fn difference(data: &Dataset, coordinate: usize, order: usize) -> f64 {
    let mut all = Vec::new();
    for trajectory in &data.trajectories {
        let mut q: Vec<f64> = trajectory.q.iter().filter_map(|row| row.get(coordinate)).copied().collect();
        for _ in 0..order {
            q = q.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        all.extend(q.into_iter().map(f64::abs));
    }
    if all.len() < FEWEST { 0.0 } else { robust_deviation(all) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Rows, Trajectory};
    use rand::{RngExt, SeedableRng};

    fn data(noise: f64) -> Dataset {
        let mut stream = rand_pcg::Pcg64::seed_from_u64(7);
        let q = |k: usize, i: usize| (0.05 * k as f64 * (1.0 + i as f64)).sin();
        let mut noisy = |i: usize| if i == 1 { noise * stream.random_range(-1.0..1.0) } else { 0.0 };
        let rows: Vec<f64> =
            (0..400).flat_map(|k| [0, 1].map(|i| (k, i))).map(|(k, i)| q(k, i) + noisy(i)).collect();
        let q = Rows::from_flat(2, rows).unwrap();
        let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None };
        Dataset { n: 2, h: 0.01, control: None, trajectories: vec![trajectory] }
    }

    /// A mass under a force that changes at every step.
    #[test]
    fn a_control_that_jumps_is_no_noise() {
        let mut stream = rand_pcg::Pcg64::seed_from_u64(3);
        let (mut q, mut v, mut rows) = (0.0, 0.0, Vec::new());
        for _ in 0..400 {
            rows.extend([q, 0.0]);
            let a: f64 = stream.random_range(-1.0..1.0);
            (q, v) = (q + 0.01 * v + 0.5e-4 * a, v + 0.01 * a);
        }
        let mut data = data(0.0);
        data.trajectories[0].q = Rows::from_flat(2, rows).unwrap();
        assert_eq!(noise_of(&data), None);
    }

    #[test]
    fn noise_is_told_from_motion_and_from_rounding() {
        assert_eq!(noise_of(&data(0.0)), None);
        assert_eq!(noise_of(&data(1e-8)), None);
        for noise in [1e-3, 3e-2] {
            let found = noise_of(&data(noise)).unwrap();
            assert_eq!(found.coordinate, 1);
            let deviation = noise / 3_f64.sqrt();
            assert!((found.deviation / deviation - 1.0).abs() < 0.3, "{found:?}");
        }
    }
}
