//! Growth of computing time and error with the number of springs.

use super::{Case, Outcome};
use serde::Serialize;

/// Growth over the rows of [`Case::Scale`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Growth {
    /// Slope of the logarithm of a step's time against that of the size.
    pub time_exponent: f64,
    /// Slope of the logarithm of the energy violation against that of the size.
    pub energy_violation_slope: f64,
    /// Time of one step of 500 springs, µs.
    pub microseconds_per_step_500: f64,
}

impl Growth {
    pub fn of(rows: &[Outcome]) -> Option<Self> {
        let sizes = || rows.iter().filter(|row| row.case == Case::Scale);
        let points = |value: fn(&Outcome) -> Option<f64>| -> Option<Vec<(f64, f64)>> {
            sizes().map(|row| Some(((row.count as f64).ln(), value(row)?.ln()))).collect()
        };
        let microseconds_per_step_500 = sizes().find(|row| row.count == 500)?.step_microseconds?;
        Some(Self {
            time_exponent: slope(&points(|row| row.step_microseconds)?),
            energy_violation_slope: slope(&points(|row| Some(row.rolled_out?.energy_violation))?),
            microseconds_per_step_500,
        })
    }
}

/// Slope of the least-squares line.
fn slope(points: &[(f64, f64)]) -> f64 {
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (sum, squares) = points
        .iter()
        .fold((0.0, 0.0), |(sum, squares), p| (sum + (p.0 - x) * (p.1 - y), squares + (p.0 - x) * (p.0 - x)));
    sum / squares
}
