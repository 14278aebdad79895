//! Least-squares polynomials through a few equidistant samples: start states of windows, and smoothed states to learn from
//! (Savitzky and Golay 1964).

use leastaction_learning::data::Rows;
use leastaction_learning::matrix::cholesky;
use nalgebra::DMatrix;

/// Weights of the samples of a stretch in the value, the slope and the curvature in its middle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polynomial {
    weights: [Vec<f64>; 3],
}

impl Polynomial {
    /// Creates the polynomial of this degree, at least 2, through 2 · `half` + 1 samples; their number must exceed the
    /// degree. Samples are h (s) apart.
    pub fn new(half: usize, degree: usize, h: f64) -> Self {
        let count = 2 * half + 1;
        // Powers of −1 … 1 are better conditioned than those of seconds.
        let at = |k: usize| k as f64 / half as f64 - 1.0;
        let powers = DMatrix::from_fn(count, degree + 1, |k, power| at(k).powi(power as i32));
        let gram = powers.transpose() * &powers;
        let solved = cholesky(gram).map(|factor| factor.solve(&powers.transpose()));
        let scale = 1.0 / (half as f64 * h);
        let row = |power: usize, factor: f64| -> Vec<f64> {
            let of = |k: usize| solved.as_ref().map_or(f64::NAN, |solved| factor * solved[(power, k)]);
            (0..count).map(of).collect()
        };
        Self { weights: [row(0, 1.0), row(1, scale), row(2, 2.0 * scale * scale)] }
    }

    /// Number of samples of a stretch.
    pub fn samples(&self) -> usize {
        self.weights[0].len()
    }

    /// Returns value, slope and curvature of every column in the middle of the stretch from sample `start` on.
    pub fn at(&self, rows: &Rows, start: usize) -> [Vec<f64>; 3] {
        self.weights.each_ref().map(|weights| {
            let mut sum = vec![0.0; rows.width()];
            for (row, weight) in rows.iter().skip(start).zip(weights) {
                sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += weight * x);
            }
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::STEP;
    use super::*;

    #[test]
    fn a_polynomial_of_the_degree_is_found_again() {
        let x = |t: f64| [1.0 - 2.0 * t + 3.0 * t * t, 0.5 * t - t * t * t];
        let rows = Rows::from_rows(2, (0..12).map(|k| x(f64::from(k) * STEP))).unwrap();
        let cubic = Polynomial::new(4, 3, STEP);
        assert_eq!(cubic.samples(), 9);
        let [value, slope, curvature] = cubic.at(&rows, 2);
        let t = 6.0 * STEP;
        let expected = [x(t), [-2.0 + 6.0 * t, 0.5 - 3.0 * t * t], [6.0, -6.0 * t]];
        for (found, expected) in [value, slope, curvature].iter().zip(expected) {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_quadratic_smooths_noise_evenly() {
        let quadratic = Polynomial::new(3, 2, STEP);
        let spike = Rows::from_rows(1, (0..7).map(|k| [f64::from(u8::from(k == 3))])).unwrap();
        // The weight of the middle of seven samples is (3m² + 3m − 1)/((2m − 1)(2m + 1)(2m + 3)) · 3 for m = 3.
        assert!((quadratic.at(&spike, 0)[0][0] - 7.0 / 21.0).abs() < 1e-12);
    }
}
