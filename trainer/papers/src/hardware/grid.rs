//! Resampling of uneven samples onto a grid of 10 ms.

use super::error::HardwareError;
use leastaction_learning::data::{Measured, Rows};
use std::path::Path;

/// Step of the grid, s.
pub const STEP: f64 = 0.01;

/// Maximum number of grid samples per sample of the file: a log with more was not sampled at a meaningful rate.
const SPARSEST: usize = 100;

/// The grid t₀, t₀ + 10 ms, … over the stamps of a log.
pub(super) struct Grid<'m> {
    measured: &'m Measured,
    samples: usize,
}

impl<'m> Grid<'m> {
    /// Creates the grid from the first stamp to the last.
    pub fn new(file: &Path, measured: &'m Measured) -> Result<Self, HardwareError> {
        let t = &measured.t[..];
        let span = t.last().zip(t.first()).map_or(0.0, |(last, first)| last - first);
        // The tolerance keeps the last sample in spite of rounding.
        let steps = span / STEP + 1e-6;
        if steps > (SPARSEST * t.len()) as f64 {
            return Err(HardwareError::Sparse { file: file.to_owned(), span, samples: t.len() });
        }
        Ok(Self { measured, samples: steps as usize + 1 })
    }

    /// Linear interpolation between samples, at every time of the grid.
    pub fn straight(&self, field: &Rows) -> Rows {
        let times: Vec<f64> = (0..self.samples).map(|k| self.at(k)).collect();
        self.measured.straight(field, &times)
    }

    /// Mean over every step of the grid of the linear interpolation between samples; the value of the last sample is
    /// kept after it.
    pub fn averaged(&self, field: &Rows) -> Rows {
        let mut place = Place::new(&self.measured.t, field);
        let steps = (0..self.samples).map(|k| [self.at(k), self.at(k + 1)]);
        let values = steps.flat_map(|step| place.mean(step)).collect();
        Rows::from_flat(field.width(), values).unwrap_or_else(|| field.slice(0..0))
    }

    fn at(&self, k: usize) -> f64 {
        self.measured.t.first().copied().unwrap_or_default() + k as f64 * STEP
    }
}

/// A place between two samples that only moves forward.
struct Place<'m> {
    t: &'m [f64],
    field: &'m Rows,
    /// Number of the sample before.
    before: usize,
}

impl<'m> Place<'m> {
    fn new(t: &'m [f64], field: &'m Rows) -> Self {
        Self { t, field, before: 0 }
    }

    fn go_to(&mut self, now: f64) {
        while self.t.get(self.before + 1).is_some_and(|next| *next <= now) {
            self.before += 1;
        }
    }

    fn value(&mut self, now: f64) -> Vec<f64> {
        self.go_to(now);
        let sample = |k: usize| self.field.get(k).unwrap_or_default();
        let from = sample(self.before);
        let Some(next) = self.t.get(self.before + 1) else { return from.to_vec() };
        let part = (now - self.t[self.before]) / (next - self.t[self.before]);
        from.iter().zip(sample(self.before + 1)).map(|(from, to)| from + part * (to - from)).collect()
    }

    /// Mean ∫ dt/(b − a) from a to b, computed exactly by trapezia between samples.
    fn mean(&mut self, [from, to]: [f64; 2]) -> Vec<f64> {
        let mut sum = vec![0.0; self.field.width()];
        let (mut begin, mut value) = (from, self.value(from));
        while begin < to {
            let end = self.t.get(self.before + 1).map_or(to, |next| next.min(to));
            let next = self.value(end);
            for ((sum, value), next) in sum.iter_mut().zip(&value).zip(&next) {
                *sum += 0.5 * (end - begin) / (to - from) * (value + next);
            }
            (begin, value) = (end, next);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of 3t − 1 and t² with jitter.
    fn measured() -> Measured {
        let t: Vec<f64> = (0..500).map(|k| 2e-3 * f64::from(k) + 3e-4 * f64::from(k * 7 % 11)).collect();
        let rows = t.iter().flat_map(|t| [3.0 * t - 1.0, t * t]).collect();
        let rows = Rows::from_flat(2, rows).unwrap();
        Measured { q: rows.clone(), v: None, u: Some(rows), t }
    }

    #[test]
    fn straight_lines_stay_and_means_are_those_of_the_steps() {
        let measured = measured();
        let grid = Grid::new(Path::new("log.csv"), &measured).unwrap();
        let (q, u) = (grid.straight(&measured.q), grid.averaged(&measured.q));
        assert_eq!((q.len(), u.len()), (100, 100));
        for k in 0..99 {
            let (from, to) = (grid.at(k), grid.at(k + 1));
            assert!((q[k][0] - (3.0 * from - 1.0)).abs() < 1e-12);
            assert!((u[k][0] - (1.5 * (from + to) - 1.0)).abs() < 1e-12);
            let mean = (to.powi(3) - from.powi(3)) / 3.0 / (to - from);
            // The chord of t² over an interval d lies at most d²/4 above the curve.
            assert!((u[k][1] - mean).abs() < 6e-6, "{k}");
        }
    }

    #[test]
    fn absurdly_sparse_stamps_are_refused() {
        let mut measured = measured();
        measured.t[499] = 1e12;
        let error = Grid::new(Path::new("log.csv"), &measured).err().unwrap().to_string();
        assert!(error.contains("log.csv") && error.contains("500 samples"), "{error}");
    }
}
