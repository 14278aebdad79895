//! Labelled curves, and the treatment of angles along them.

use std::f64::consts::PI;

/// Stroke of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A thin pale line, for the edges of a band.
    Thin,
    /// A wide pale line, for a truth with another curve drawn over it.
    Wide,
    /// A thin line with a dot at each point, for a few measured values.
    Dotted,
    /// A small dot at each point without a line, for many unordered points.
    Points,
}

/// A labelled curve. Points that the axes cannot show (not finite; not positive on a logarithmic axis) interrupt it.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Label in the legend; empty: not in the legend.
    pub label: String,
    /// Points (x, y) in the units of the axis labels.
    pub points: Vec<(f64, f64)>,
    /// Stroke.
    pub stroke: Stroke,
}

impl Series {
    /// A series with a solid line.
    pub fn new(label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self { label: label.into(), points: points.into_iter().collect(), stroke: Stroke::Solid }
    }

    /// Sets the stroke.
    #[must_use]
    pub fn with_stroke(self, stroke: Stroke) -> Self {
        Self { stroke, ..self }
    }
}

/// Treatment of angles on the horizontal axis of a phase portrait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angle {
    /// Not an angle: values as they are, ticks at round numbers.
    No,
    /// Values as they are, ticks at parts of π.
    AsGiven,
    /// Unwrapped: jumps of more than half a turn between points are removed.
    Unwrapped,
    /// Wrapped to (−π, π\]; the curve is interrupted where it leaves on one side.
    Wrapped,
}

impl Angle {
    pub(super) fn apply(self, series: &Series) -> Series {
        let points = match self {
            Self::No | Self::AsGiven => series.points.clone(),
            Self::Unwrapped => unwrapped(&series.points),
            Self::Wrapped => wrapped(&series.points),
        };
        Series { points, ..series.clone() }
    }
}

fn unwrapped(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut last = None;
    let unwrap = |&(x, y): &(f64, f64)| {
        let near = last.map_or(x, |last: f64| last + wrap(x - last));
        last = if near.is_finite() { Some(near) } else { last };
        (near, y)
    };
    points.iter().map(unwrap).collect()
}

fn wrapped(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for &(x, y) in points {
        let x = wrap(x);
        if all.last().is_some_and(|&(last, _)| (x - last).abs() > PI) {
            all.push((f64::NAN, f64::NAN));
        }
        all.push((x, y));
    }
    all
}

/// The angle in (−π, π\] that differs from `x` by whole turns.
fn wrap(x: f64) -> f64 {
    let turned = (x + PI).rem_euclid(2.0 * PI) - PI;
    if turned <= -PI { PI } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn xs(angle: Angle, xs: &[f64]) -> Vec<f64> {
        angle.apply(&Series::new("", xs.iter().map(|&x| (x, 1.0)))).points.iter().map(|p| p.0).collect()
    }

    #[test]
    fn unwrapping_undoes_wrapping() {
        let spin: Vec<f64> = (0..40).map(|k| f64::from(k) * 0.7).collect();
        let folded: Vec<f64> = xs(Angle::Wrapped, &spin).into_iter().filter(|x| !x.is_nan()).collect();
        assert!(folded.iter().all(|x| x.abs() <= PI));
        for (back, x) in xs(Angle::Unwrapped, &folded).iter().zip(&spin) {
            assert!((back - x).abs() < 1e-12, "{back} {x}");
        }
    }

    #[test]
    fn a_seam_interrupts_the_curve() {
        let folded = xs(Angle::Wrapped, &[3.0, 3.3]);
        assert_eq!(folded.len(), 3);
        assert!(folded[1].is_nan() && (folded[2] - (3.3 - 2.0 * PI)).abs() < 1e-12);
        assert_eq!(xs(Angle::Wrapped, &[PI, -PI]), [PI, PI]);
    }

    #[test]
    fn what_is_not_finite_stays_so_and_spoils_no_neighbour() {
        let turned = xs(Angle::Unwrapped, &[3.0, f64::NAN, -3.0]);
        assert!(turned[1].is_nan() && (turned[2] - (2.0 * PI - 3.0)).abs() < 1e-12);
        assert_eq!(xs(Angle::AsGiven, &[9.0]), [9.0]);
    }
}
