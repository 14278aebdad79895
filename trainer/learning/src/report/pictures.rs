//! Plots of predictions and residuals.

use super::unit_of;
use crate::evaluate::horizons::{Prediction, Predictions};
use crate::windows::WindowLogs;
use leastaction_plot::{NotDrawn, Panel, Series, Stroke, Vertical, curves_svg, stacked_svg};

/// Largest number of coordinates that are drawn.
pub(super) const MOST: usize = 6;
/// Number of points per curve.
const POINTS: usize = 201;
/// Number of bars in a histogram.
const BARS: usize = 60;
/// Half-width of the histogram, in standard deviations.
const SIDES: f64 = 5.0;

/// Plots a prediction over the measurements, one panel per coordinate.
pub(super) fn motion(
    title: &str,
    of: &Prediction,
    (logs, letters, stroke): (&WindowLogs, &str, Stroke),
) -> Result<String, NotDrawn> {
    let n = logs.n;
    let time = |k: usize| (of.first + k) as f64 * logs.h;
    let steps = 0..=of.steps(n);
    let curves = |i: usize| {
        let measured = steps.clone().map(|k| (time(k), logs.position(of.log, of.first + k, i)));
        let predicted = steps.clone().map(|k| (time(k), of.path[k * n + i]));
        [Series::new("measured", measured).with_stroke(stroke), Series::new("predicted", predicted)]
    };
    let count = n.min(MOST);
    let all: Vec<[Series; 2]> = (0..count).map(curves).collect();
    let labels: Vec<String> = (0..count).map(|i| format!("q{i} ({})", unit_of(letters, i))).collect();
    let panels: Vec<Panel> =
        all.iter().zip(&labels).map(|(curves, label)| Panel::new(label, curves)).collect();
    stacked_svg(title, "time in the log (s)", &panels)
}

/// Plots the median error over time, beside a constant velocity, the noise and, if given, another model.
pub(super) fn growth(
    predictions: &Predictions,
    beside: Option<(&str, &Predictions)>,
    logs: &WindowLogs,
    (noise, unit): (f64, &str),
) -> Result<String, NotDrawn> {
    let errors = predictions.growth(logs);
    let curve = |errors: &[[f64; 2]], which: usize| {
        errors.iter().enumerate().map(|(k, both)| (k as f64 * logs.h, both[which])).collect::<Vec<_>>()
    };
    let ends = [0.0, errors.len().saturating_sub(1) as f64 * logs.h];
    let mut series = vec![Series::new("this model", curve(&errors, 0))];
    series.extend(beside.map(|(name, other)| Series::new(name, curve(&other.growth(logs), 0))));
    series.extend([
        Series::new("constant velocity", curve(&errors, 1)),
        Series::new("noise of the sensors", ends.map(|t| (t, noise))).with_stroke(Stroke::Dashed),
    ]);
    let label = format!("median error ({unit})");
    curves_svg("Error over the horizon", ("time ahead (s)", &label), Vertical::Logarithmic, &series)
}

/// Histogram of a coordinate's residuals, with the normal distribution of standard deviation `deviation`.
pub(super) fn histogram(
    i: usize,
    residuals: &[f64],
    (deviation, unit): (f64, &str),
) -> Result<String, NotDrawn> {
    let width = 2.0 * SIDES * deviation / BARS as f64;
    let mut counts = [0_usize; BARS];
    for residual in residuals {
        let bar = (residual / width + 0.5 * BARS as f64).floor();
        if (0.0..BARS as f64).contains(&bar) {
            counts[bar as usize] += 1;
        }
    }
    let edge = |bar: usize| (bar as f64 - 0.5 * BARS as f64) * width;
    let part = |count: usize| count as f64 / residuals.len().max(1) as f64 / width;
    let outline = counts
        .iter()
        .enumerate()
        .flat_map(|(bar, count)| [(edge(bar), part(*count)), (edge(bar + 1), part(*count))]);
    let normal = (0..POINTS).map(|k| {
        let x = SIDES * deviation * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0);
        let height = (-0.5 * (x / deviation).powi(2)).exp() / (deviation * std::f64::consts::TAU.sqrt());
        (x, height)
    });
    let series = [
        Series::new("residuals", outline),
        Series::new("normal distribution", normal).with_stroke(Stroke::Dashed),
    ];
    let (x, y) = (format!("residual of q{i} ({unit})"), format!("density (1/{unit})"));
    curves_svg(&format!("Residuals of q{i}"), (&x, &y), Vertical::Linear, &series)
}
