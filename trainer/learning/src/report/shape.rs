//! Plots of inertia and potential over the range of the logs.

use super::unit_of;
use crate::evaluate::median;
use crate::windows::WindowLogs;
use leastaction_core::model::ModelError;
use leastaction_models::Model;
use leastaction_models::rest::AtRest;
use leastaction_plot::{NotDrawn, Series, Vertical, curves_svg};
use std::f64::consts::PI;

/// Largest number of coordinates for which inertia is drawn.
const MOST: usize = 2;
/// Number of points per curve.
const POINTS: usize = 121;
/// Approximate number of positions that determine the range.
const SAMPLES: usize = 4000;

/// Positions along one coordinate, with the other coordinates at their median.
struct Slice {
    along: usize,
    q: Vec<f64>,
    at_rest: Vec<AtRest>,
}

/// Plots of inertia and potential along every coordinate; empty if there are more than two coordinates.
pub(super) fn pictures(
    model: &Model,
    logs: &WindowLogs,
) -> Result<Vec<Result<String, NotDrawn>>, ModelError> {
    if logs.n > MOST {
        return Ok(Vec::new());
    }
    let letters = model.architecture.coordinates();
    let columns: Vec<Vec<f64>> = (0..logs.n).map(|i| column(logs, i)).collect();
    let middle: Vec<f64> = columns.iter().map(|column| median(column)).collect();
    let slice = |along: usize| {
        let q = range(&columns[along], letters.as_bytes().get(along) != Some(&b't'));
        let positions: Vec<Vec<f64>> = q
            .iter()
            .map(|q| {
                let mut position = middle.clone();
                position[along] = *q;
                position
            })
            .collect();
        let positions: Vec<&[f64]> = positions.iter().map(Vec::as_slice).collect();
        let at_rest = model.at_rest(&positions)?;
        Ok(Slice { along, q, at_rest })
    };
    let slices = (0..logs.n).map(slice).collect::<Result<Vec<_>, ModelError>>()?;
    let of = |slice: &Slice| [slice.inertia(&letters), slice.potential(&letters)];
    Ok(slices.iter().flat_map(of).collect())
}

/// Positions of a coordinate sampled throughout the logs, m or rad.
pub(super) fn column(logs: &WindowLogs, i: usize) -> Vec<f64> {
    let all = logs.all_samples();
    let stride = all.div_ceil(SAMPLES).max(1);
    let of = |log: usize| (0..logs.samples(log)).step_by(stride).map(move |k| logs.position(log, k, i));
    (0..logs.count()).flat_map(of).collect()
}

/// Positions from the least to the largest; for an angle at most one turn.
fn range(column: &[f64], is_angle: bool) -> Vec<f64> {
    let (least, most) =
        column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let turns = is_angle && most - least > 2.0 * PI;
    let (least, most) = if turns { (-PI, PI) } else { (least, most) };
    (0..POINTS).map(|k| least + (most - least) * k as f64 / (POINTS - 1) as f64).collect()
}

impl Slice {
    fn curves(&self, label: String, of: impl Fn(&AtRest) -> f64) -> Series {
        Series::new(label, self.q.iter().copied().zip(self.at_rest.iter().map(of)))
    }

    fn axis(&self, letters: &str) -> String {
        format!("q{} ({})", self.along, unit_of(letters, self.along))
    }

    fn inertia(&self, letters: &str) -> Result<String, NotDrawn> {
        let n = letters.len();
        let entries = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
        let series: Vec<Series> =
            entries.map(|(i, j)| self.curves(format!("M{i}{j}"), |at| at.mass[i * n + j])).collect();
        let unit = match (letters.contains('t'), letters.chars().all(|letter| letter == 't')) {
            (_, true) => "kg",
            (true, false) => "kg, kg m, kg m²",
            (false, false) => "kg m²",
        };
        let title = format!("Inertia over q{}", self.along);
        let label = format!("entries of M ({unit})");
        curves_svg(&title, (&self.axis(letters), &label), Vertical::Linear, &series)
    }

    /// Potential V = ∫ ∂V/∂q dq by the trapezoidal rule, shifted so that its minimum is 0.
    fn potential(&self, letters: &str) -> Result<String, NotDrawn> {
        let slopes = self.at_rest.iter().map(|at| at.slope[self.along]).collect::<Vec<_>>();
        let mut values = vec![0.0];
        for (q, slope) in self.q.windows(2).zip(slopes.windows(2)) {
            let before = values.last().copied().unwrap_or(0.0);
            values.push(before + 0.5 * (q[1] - q[0]) * (slope[0] + slope[1]));
        }
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let series = [Series::new("", self.q.iter().copied().zip(values.iter().map(|v| v - least)))];
        let title = format!("Potential over q{}", self.along);
        curves_svg(&title, (&self.axis(letters), "V (J)"), Vertical::Linear, &series)
    }
}
