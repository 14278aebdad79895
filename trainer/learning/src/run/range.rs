//! Range of the data, for the model file.

use crate::data::{Dataset, Trajectory};
use leastaction_core::model::{CoordinateRange, Interval};
use leastaction_models::Architecture;

/// Largest number of coordinates for which the range is kept: for a larger graph it would be longer than the model.
const MAX_COORDINATES: usize = 64;

/// The range of every coordinate; empty for more than [`MAX_COORDINATES`] coordinates. Missing velocities are computed
/// as differences of positions; missing controls count as 0.
pub(super) fn of(architecture: &Architecture, data: &Dataset) -> Vec<CoordinateRange> {
    if data.n > MAX_COORDINATES {
        return Vec::new();
    }
    let range = |(i, letter): (usize, char)| CoordinateRange {
        q: interval(data, |t| column(t.q.as_flat(), i, data.n)),
        v: interval(data, |t| velocities(t, i, data)),
        u: interval(data, |t| t.u.as_ref().map_or(Vec::new(), |u| column(u.as_flat(), i, data.n))),
        period: if letter == 'a' { std::f32::consts::TAU } else { 0.0 },
    };
    architecture.coordinates().chars().enumerate().map(range).collect()
}

fn velocities(trajectory: &Trajectory, i: usize, data: &Dataset) -> Vec<f64> {
    match &trajectory.v {
        Some(v) => column(v.as_flat(), i, data.n),
        None => {
            let q = column(trajectory.q.as_flat(), i, data.n);
            q.windows(2).map(|pair| (pair[1] - pair[0]) / data.h).collect()
        }
    }
}

fn column(rows: &[f64], i: usize, n: usize) -> Vec<f64> {
    rows.iter().skip(i).step_by(n).copied().collect()
}

/// Smallest and largest value, rounded outwards to single precision; 0 … 0 if there are no values.
fn interval(data: &Dataset, of: impl Fn(&Trajectory) -> Vec<f64>) -> Interval {
    let values = data.trajectories.iter().flat_map(of);
    let Some((least, most)) = values.fold(None, |range: Option<(f64, f64)>, x| {
        let (least, most) = range.unwrap_or((x, x));
        Some((least.min(x), most.max(x)))
    }) else {
        return Interval { least: 0.0, most: 0.0 };
    };
    let (low, high) = (least as f32, most as f32);
    Interval {
        least: if f64::from(low) > least { low.next_down() } else { low },
        most: if f64::from(high) < most { high.next_up() } else { high },
    }
}
