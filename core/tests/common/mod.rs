//! Shared parts of the tests: an exact oracle of derivatives, seeded numbers, models of every shape, and comparisons.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod arms;
pub mod bodies;
pub mod cases;
pub mod crane;
pub mod dual;
pub mod dual_number;
pub mod file;
pub mod forces;
pub mod graphs;
pub mod manipulator;
pub mod network_laws;
pub mod oracle;
pub mod particles;
pub mod sections;
pub mod shapes;
pub mod trees;

/// The largest |a − b| relative to 1 + |b|.
#[track_caller]
pub fn assert_close(name: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / (1.0 + expected.abs());
    assert!(
        error <= tolerance,
        "{name}: {found:e} instead of {expected:e}, off by {error:e} (at most {tolerance:e})"
    );
}

/// [`assert_close`] entry by entry.
#[track_caller]
pub fn assert_vectors_close<const N: usize>(
    name: &str,
    found: &[f64; N],
    expected: &[f64; N],
    tolerance: f64,
) {
    for i in 0..N {
        assert_close(&format!("{name}[{i}]"), found[i], expected[i], tolerance);
    }
}

/// [`assert_close`] entry by entry.
#[track_caller]
pub fn assert_matrices_close<const N: usize>(
    name: &str,
    found: &[[f64; N]; N],
    expected: &[[f64; N]; N],
    tolerance: f64,
) {
    for i in 0..N {
        assert_vectors_close(&format!("{name}[{i}]"), &found[i], &expected[i], tolerance);
    }
}

/// A small seeded stream of numbers (SplitMix64), the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in ±`radius`.
    pub fn symmetric(&mut self, radius: f64) -> f64 {
        (self.bits() >> 11) as f64 * 2f64.powi(-52) * radius - radius
    }

    pub fn array<const N: usize>(&mut self, radius: f64) -> [f64; N] {
        core::array::from_fn(|_| self.symmetric(radius))
    }

    pub fn vector(&mut self, length: usize, radius: f64) -> Vec<f64> {
        (0..length).map(|_| self.symmetric(radius)).collect()
    }
}

/// The slope of the line through (ln h, ln error), by least squares.
pub fn log_log_slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    let variance: f64 = logs.iter().map(|(x, _)| (x - mx) * (x - mx)).sum();
    covariance / variance
}
