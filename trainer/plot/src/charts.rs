//! The charts: loss curves, phase portraits, stacked panels, log-log plots, and curves in one frame.

use std::path::Path;

use super::axis::{Axis, Scale};
use super::figure::{
    Canvas, Chart, DrawError, FOOT, Frame, HEAD, draw_chart, draw_legend, draw_title, left_edge,
    legend_height, render,
};
use super::series::{Angle, Series, Stroke};
use super::{NotDrawn, PlotError};

/// Height of the frame of a single chart, pixels.
const HEIGHT: f64 = 340.0;

/// Height of the frame of a panel, and gap to the next panel, pixels.
const PANEL_HEIGHT: f64 = 118.0;
const PANEL_GAP: f64 = 16.0;

/// Numbers of ticks that fit along the axes.
const X_TICKS: usize = 8;
const Y_TICKS: usize = 7;
const PANEL_TICKS: usize = 5;

/// Draws losses over iterations on a logarithmic axis; each series is a label with its points (iteration, loss).
///
/// # Errors
/// [`PlotError`] if the file cannot be written.
pub fn loss_curve(path: &Path, title: &str, losses: &[(&str, &[(f64, f64)])]) -> Result<(), PlotError> {
    let series: Vec<_> =
        losses.iter().map(|(label, points)| Series::new(*label, points.iter().copied())).collect();
    let x = Axis::tight(Scale::Linear, values(&series, |point| point.0), X_TICKS);
    let y = Axis::fit(Scale::Log, values(&series, |point| point.1), Y_TICKS);
    let colours: Vec<_> = (0..series.len()).collect();
    let chart = Chart { x, y, x_label: "iteration", y_label: "loss", series: &series, colours: &colours };
    single(path, title, &chart)
}

/// The axes of a phase portrait.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase<'a> {
    /// Coordinate and unit, such as `θ (rad)`.
    pub x_label: &'a str,
    /// Velocity or momentum, and unit.
    pub y_label: &'a str,
    /// Treatment of whole turns of the coordinate.
    pub angle: Angle,
}

/// Draws curves in a phase plane, such as the truth and a model; curves with the same label have the same colour.
///
/// # Errors
/// [`PlotError`] if the file cannot be written.
pub fn phase_portrait(
    path: &Path,
    title: &str,
    phase: Phase<'_>,
    series: &[Series],
) -> Result<(), PlotError> {
    let series: Vec<_> = series.iter().map(|series| phase.angle.apply(series)).collect();
    let scale = if phase.angle == Angle::No { Scale::Linear } else { Scale::Angle };
    let x = Axis::fit(scale, values(&series, |point| point.0), X_TICKS);
    let y = Axis::fit(Scale::Linear, values(&series, |point| point.1), Y_TICKS);
    let colours = colours_by_label(&series);
    let chart =
        Chart { x, y, x_label: phase.x_label, y_label: phase.y_label, series: &series, colours: &colours };
    single(path, title, &chart)
}

/// Colour of each series, in the order in which labels appear; curves with the same label have the same colour.
fn colours_by_label(series: &[Series]) -> Vec<usize> {
    let mut labels: Vec<&str> = Vec::new();
    let mut colour = |label| {
        labels.iter().position(|known| *known == label).unwrap_or_else(|| {
            labels.push(label);
            labels.len() - 1
        })
    };
    series.iter().map(|series| colour(series.label.as_str())).collect()
}

/// Layout of the vertical axis of a panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vertical {
    /// Ticks at round numbers.
    Linear,
    /// Ticks at powers of ten, as for residuals.
    Logarithmic,
    /// Ticks at parts of π.
    Angle,
}

impl Vertical {
    fn scale(self) -> Scale {
        match self {
            Self::Linear => Scale::Linear,
            Self::Logarithmic => Scale::Log,
            Self::Angle => Scale::Angle,
        }
    }
}

/// A chart that shares its time axis with others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel<'a> {
    /// Quantity and unit.
    pub y_label: &'a str,
    /// Layout of the vertical axis.
    pub vertical: Vertical,
    /// Curves of (time in s, value).
    pub series: &'a [Series],
}

impl<'a> Panel<'a> {
    /// A panel with a linear axis.
    #[must_use]
    pub fn new(y_label: &'a str, series: &'a [Series]) -> Self {
        Self { y_label, vertical: Vertical::Linear, series }
    }

    /// Sets the vertical axis.
    #[must_use]
    pub fn with_vertical(self, vertical: Vertical) -> Self {
        Self { vertical, ..self }
    }

    fn axis(&self) -> Axis {
        Axis::fit(self.vertical.scale(), values(self.series, |point| point.1), PANEL_TICKS)
    }

    fn height(&self, left: f64) -> f64 {
        PANEL_HEIGHT + PANEL_GAP + legend_height(self.series, left)
    }
}

/// Draws panels one above the other over the same time axis; curves of a panel with the same label have the same colour.
///
/// # Errors
/// [`PlotError`] if the file cannot be written.
pub fn time_series(path: &Path, title: &str, panels: &[Panel<'_>]) -> Result<(), PlotError> {
    stacked(path, title, "time (s)", panels)
}

/// Draws panels one above the other over the same horizontal axis.
///
/// # Errors
/// [`PlotError`] if the file cannot be written.
pub fn stacked(path: &Path, title: &str, x_label: &str, panels: &[Panel<'_>]) -> Result<(), PlotError> {
    save(path, &stacked_svg(title, x_label, panels).map_err(|error| error.of(path))?)
}

/// The panels of [`stacked`] as SVG text, for embedding in a page.
///
/// # Errors
/// [`NotDrawn`] if the drawing library fails.
pub fn stacked_svg(title: &str, x_label: &str, panels: &[Panel<'_>]) -> Result<String, NotDrawn> {
    let times = panels.iter().flat_map(|panel| values(panel.series, |point| point.0));
    let time = Axis::tight(Scale::Linear, times, X_TICKS);
    let axes: Vec<_> = panels.iter().map(Panel::axis).collect();
    let left = left_edge(&axes);
    let height = HEAD + panels.iter().map(|panel| panel.height(left)).sum::<f64>() - PANEL_GAP + FOOT;
    drawn(height, |canvas| {
        draw_title(canvas, title)?;
        let mut top = HEAD;
        for (index, (panel, axis)) in panels.iter().zip(axes).enumerate() {
            let x_label = if index + 1 == panels.len() { x_label } else { "" };
            draw_panel(canvas, (top, left), panel, (&time, axis), x_label)?;
            top += panel.height(left);
        }
        Ok(())
    })
}

/// Draws a panel with its legend above its frame.
fn draw_panel(
    canvas: &Canvas<'_>,
    (top, left): (f64, f64),
    panel: &Panel<'_>,
    (time, y): (&Axis, Axis),
    x_label: &str,
) -> Result<(), DrawError> {
    let colours = colours_by_label(panel.series);
    draw_legend(canvas, (top, left), panel.series, &colours)?;
    let chart = Chart {
        x: time.clone(),
        y,
        x_label,
        y_label: panel.y_label,
        series: panel.series,
        colours: &colours,
    };
    let top = top + legend_height(panel.series, left);
    draw_chart(canvas, Frame { left, top, bottom: top + PANEL_HEIGHT }, &chart)
}

/// Draws curves on two logarithmic axes, such as errors over step sizes, with dashed lines of given slopes.
///
/// Each slope is drawn below the curve whose own slope, from its first point to its last, is nearest to it, in that
/// curve's colour.
///
/// # Errors
/// [`PlotError`] if the file cannot be written.
pub fn log_log(
    path: &Path,
    title: &str,
    (x_label, y_label): (&str, &str),
    series: &[Series],
    slopes: &[f64],
) -> Result<(), PlotError> {
    let mut all = series.to_vec();
    let mut colours: Vec<_> = (0..series.len()).collect();
    for &slope in slopes {
        if let Some((number, line)) = reference_line(series, slope) {
            all.push(line);
            colours.push(number);
        }
    }
    let x = Axis::fit(Scale::Log, values(&all, |point| point.0), X_TICKS);
    let y = Axis::fit(Scale::Log, values(&all, |point| point.1), Y_TICKS);
    single(path, title, &Chart { x, y, x_label, y_label, series: &all, colours: &colours })
}

/// A line of slope `slope` that ends at 0.4 times the end value of the nearest curve, with the index of that curve.
fn reference_line(series: &[Series], slope: f64) -> Option<(usize, Series)> {
    let ends = series.iter().enumerate().filter_map(|(number, series)| Some((number, ends(series)?)));
    let distance =
        |(from, to): ((f64, f64), (f64, f64))| ((to.1 / from.1).ln() / (to.0 / from.0).ln() - slope).abs();
    let nearest = ends.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    let (number, (from, to)) = nearest?;
    let at = |x: f64| (x, 0.4 * to.1 * (x / to.0).powf(slope));
    let line = Series::new(format!("slope {slope}"), [at(from.0), at(to.0)]).with_stroke(Stroke::Dashed);
    Some((number, line))
}

/// The drawable points with the least and the greatest x.
fn ends(series: &Series) -> Option<((f64, f64), (f64, f64))> {
    let shown = || {
        series.points.iter().copied().filter(|point| Scale::Log.shows(point.0) && Scale::Log.shows(point.1))
    };
    let from = shown().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let to = shown().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (from.0 < to.0).then_some((from, to))
}

fn values(series: &[Series], of: fn((f64, f64)) -> f64) -> impl Iterator<Item = f64> + Clone {
    series.iter().flat_map(|series| series.points.iter().copied()).map(of)
}

/// Curves in one frame as SVG text, for embedding in a page.
///
/// # Errors
/// [`NotDrawn`] if the drawing library fails.
pub fn curves_svg(
    title: &str,
    (x_label, y_label): (&str, &str),
    vertical: Vertical,
    series: &[Series],
) -> Result<String, NotDrawn> {
    let x = Axis::tight(Scale::Linear, values(series, |point| point.0), X_TICKS);
    let y = Axis::fit(vertical.scale(), values(series, |point| point.1), Y_TICKS);
    let colours = colours_by_label(series);
    of_one_chart(title, &Chart { x, y, x_label, y_label, series, colours: &colours })
}

/// Saves a figure with one chart.
fn single(path: &Path, title: &str, chart: &Chart<'_>) -> Result<(), PlotError> {
    save(path, &of_one_chart(title, chart).map_err(|error| error.of(path))?)
}

fn of_one_chart(title: &str, chart: &Chart<'_>) -> Result<String, NotDrawn> {
    let left = left_edge([&chart.y]);
    let top = HEAD + legend_height(chart.series, left);
    drawn(top + HEIGHT + FOOT, |canvas| {
        draw_title(canvas, title)?;
        draw_legend(canvas, (HEAD, left), chart.series, chart.colours)?;
        draw_chart(canvas, Frame { left, top, bottom: top + HEIGHT }, chart)
    })
}

fn drawn(height: f64, draw: impl FnOnce(&Canvas<'_>) -> Result<(), DrawError>) -> Result<String, NotDrawn> {
    render(height, draw).map_err(|error| NotDrawn { reason: error.to_string() })
}

fn save(path: &Path, svg: &str) -> Result<(), PlotError> {
    leastaction_data::atomic::write(path, svg.as_bytes())
        .map_err(|error| PlotError::Write { file: path.to_path_buf(), error })
}
