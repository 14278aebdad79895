//! Samples at which predictions start.

use super::horizons::{HALF, HORIZONS, Predictor};

/// Time between the starts of consecutive predictions, s.
const STRIDE: f64 = 0.25;
/// Largest number of predictions.
const MOST: usize = 2000;

impl Predictor<'_> {
    /// Logs long enough for a prediction, each with its first start.
    pub(super) fn log_starts(&self) -> Vec<(usize, usize)> {
        let fits = |log: &usize| self.logs.samples(*log) > 2 * HALF + 1;
        (0..self.logs.count()).filter(fits).map(|log| (log, HALF)).collect()
    }

    /// Start samples throughout the logs, for the longest horizon that fits into some log.
    pub(super) fn starts(&self) -> Vec<(usize, usize)> {
        let steps = HORIZONS.map(|seconds| (seconds / self.logs.h).round() as usize);
        let longest = (0..self.logs.count()).map(|log| self.logs.samples(log)).max().unwrap_or(0);
        let Some(steps) = steps.into_iter().rev().find(|steps| HALF + steps < longest && *steps > 0) else {
            return Vec::new();
        };
        let stride = ((STRIDE / self.logs.h).round() as usize).max(1);
        let of = |log: usize| {
            let last = self.logs.samples(log).checked_sub(steps.max(HALF) + 1);
            let starts = last.map(|last| (HALF..=last).step_by(stride));
            starts.into_iter().flatten().map(move |first| (log, first))
        };
        let all: Vec<_> = (0..self.logs.count()).flat_map(of).collect();
        all.iter().copied().step_by(all.len().div_ceil(MOST).max(1)).collect()
    }
}
