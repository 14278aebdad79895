//! Access to a fit over windows: its windows by log, its residuals, its learned numbers.

use super::WindowLoss;
use crate::training::Residuals;
use crate::windows::logs::Window;
use leastaction_models::parallel;
use leastaction_programs::WIDTH;
use std::ops::Range;

impl WindowLoss {
    /// The windows of every log that has any, in the order of the logs.
    pub(in crate::windows) fn windows_of_logs(&self) -> Vec<Range<usize>> {
        let mut first = 0;
        let of = |part: &[Window]| {
            let start = first;
            first += part.len();
            start..first
        };
        self.windows.chunk_by(|a, b| a.log == b.log).map(of).collect()
    }

    /// For every window, its log and the logarithm of its mean squared position error, (m, rad)², from the best start
    /// state. The squared sensor noise is added to the error as a floor.
    pub fn held_back_errors(&self, weights: &[f64]) -> Vec<(usize, f64)> {
        let weights = self.enter(weights[..self.layout.end().min(weights.len())].to_vec());
        let (n, scales) = (self.n(), self.scales(&weights).to_vec());
        let floor: f64 = self.noise.iter().map(|noise| noise * noise).sum::<f64>() / n as f64;
        let logarithms = self.of_blocks(|first, count, stepper| {
            let starts = self.starts(&weights, first);
            let (residuals, _) = self.lanes(&weights, first).residuals(stepper, &starts);
            let mean = |lane: usize| -> f64 {
                let squares =
                    residuals.iter().enumerate().map(|(k, row)| (scales[k % n] * row.0[lane]).powi(2));
                squares.sum::<f64>() / residuals.len() as f64
            };
            (0..count).map(|lane| (mean(lane) + floor).ln()).collect::<Vec<f64>>()
        });
        self.windows.iter().map(|window| window.log).zip(logarithms.into_iter().flatten()).collect()
    }

    /// Positions of the shared numbers that are varied.
    pub(in crate::windows) fn learned(&self) -> Vec<usize> {
        (0..self.layout.end()).filter(|position| !self.fixed.contains(position)).collect()
    }

    /// Scale s of every coordinate, m or rad.
    pub fn residual_scales(&self, weights: &[f64]) -> Vec<f64> {
        self.scales(weights).to_vec()
    }

    /// Scaled residuals (q̂_i + z_i − q̃_i)/s_i of every coordinate, over at most `most` windows taken from all parts
    /// of the logs; windows that cannot be computed are left out.
    pub fn scaled_residuals(&self, weights: &[f64], most: usize) -> Vec<Vec<f64>> {
        let blocks = self.windows.len().div_ceil(WIDTH);
        let stride = blocks.div_ceil((most / WIDTH).max(1)).max(1);
        let parts = parallel::map(blocks.div_ceil(stride), &|k| {
            let first = k * stride * WIDTH;
            let (lanes, starts) = (self.lanes(weights, first), self.starts(weights, first));
            let (residuals, failures) =
                self.steppers.with(|stepper| lanes.residuals(&mut **stepper, &starts));
            let count = (self.windows.len() - first).min(WIDTH);
            let lanes: Vec<usize> = (0..count).filter(|lane| !failures.0[*lane]).collect();
            let of = |i: usize| residuals.iter().skip(i).step_by(self.n());
            let of = |i: usize| of(i).flat_map(|row| lanes.iter().map(|lane| row.0[*lane])).collect();
            (0..self.n()).map(of).collect::<Vec<Vec<f64>>>()
        });
        (0..self.n()).map(|i| parts.iter().flat_map(|part| part[i].iter().copied()).collect()).collect()
    }
}
