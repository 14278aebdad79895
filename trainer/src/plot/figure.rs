//! The canvas, the house style, and one chart in its frame.

use std::fmt::Display;
use std::io;

use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, DashedPathElement, PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, IntoFont, RGBColor, ShapeStyle, TRANSPARENT, TextStyle, WHITE};

use super::axis::Axis;
use super::curve::{Pixel, pieces};
use super::series::{Series, Stroke};

pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawError = DrawingAreaErrorKind<io::Error>;

/// Canvas units in a pixel: plotters rounds coordinates to whole units, which would show.
const UNIT: f64 = 4.0;

/// plotters writes the font size divided by this.
const FONT_FACTOR: f64 = 1.24;

/// Mean width of a character, as a part of the font size, of a wide sans-serif font.
const CHARACTER: f64 = 0.6;

pub(super) const WIDTH: f64 = 720.0;
const MARGIN: f64 = 16.0;
const TITLE_SIZE: f64 = 16.0;
const LABEL_SIZE: f64 = 12.5;
const TICK_SIZE: f64 = 11.5;
const LEGEND_ROW: f64 = 20.0;
const SWATCH: f64 = 26.0;

const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
const FRAME: RGBColor = RGBColor(0x8c, 0x8c, 0x8c);
const GRID: RGBColor = RGBColor(0xe4, 0xe4, 0xe4);

/// Okabe and Ito's colours, told apart by the colour-blind; without yellow, which is too pale for a line.
const PALETTE: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0x00, 0x00, 0x00),
];

pub(super) fn colour(index: usize) -> RGBColor {
    PALETTE.get(index % PALETTE.len()).copied().unwrap_or(INK)
}

/// A rectangle in pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    pub(super) top: f64,
    pub(super) height: f64,
}

/// A chart before it is drawn.
pub(super) struct Chart<'a> {
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Empty on a panel whose horizontal axis is labelled further down.
    pub(super) x_label: &'a str,
    pub(super) y_label: &'a str,
    pub(super) series: &'a [Series],
    /// Colour of each series, by its number in the palette.
    pub(super) colours: &'a [usize],
}

/// The SVG text of a figure that `draw` fills.
pub(super) fn render(height: f64, draw: impl FnOnce(&Canvas<'_>) -> Result<(), DrawError>) -> Result<String, DrawError> {
    let size = (units(WIDTH).unsigned_abs(), units(height).unsigned_abs());
    let mut svg = String::new();
    {
        let canvas = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        canvas.fill(&WHITE)?;
        draw(&canvas)?;
        canvas.present()?;
    }
    let fine = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let shown = format!("width=\"{WIDTH}\" height=\"{height}\" stroke-linejoin=\"round\"");
    Ok(svg.replacen(&fine, &shown, 1))
}

/// Height of the title and of the legend's rows beneath it.
pub(super) fn header_height(series: &[Series]) -> f64 {
    MARGIN + TITLE_SIZE + 10.0 + legend_height(series)
}

pub(super) fn legend_height(series: &[Series]) -> f64 {
    legend_slots(series).last().map_or(0.0, |&(_, row, _)| (row + 1) as f64 * LEGEND_ROW + 2.0)
}

/// Where each labelled series stands in the legend: its number, row and left edge.
fn legend_slots(series: &[Series]) -> Vec<(usize, usize, f64)> {
    let (mut row, mut left) = (0, MARGIN);
    let mut slots = Vec::new();
    for (index, series) in series.iter().enumerate().filter(|(_, series)| !series.label.is_empty()) {
        let width = SWATCH + 6.0 + text_width(&series.label, LABEL_SIZE) + 20.0;
        if left > MARGIN && left + width > WIDTH - MARGIN {
            (row, left) = (row + 1, MARGIN);
        }
        slots.push((index, row, left));
        left += width;
    }
    slots
}

pub(super) fn draw_title(canvas: &Canvas<'_>, title: &str) -> Result<(), DrawError> {
    let (title, size) = fitted(title, TITLE_SIZE, WIDTH - 2.0 * MARGIN);
    write_text(canvas, &title, (MARGIN, MARGIN + TITLE_SIZE / 2.0), &font(size, FontStyle::Bold, HPos::Left))
}

pub(super) fn draw_legend(canvas: &Canvas<'_>, top: f64, series: &[Series], colours: &[usize]) -> Result<(), DrawError> {
    for (index, row, left) in legend_slots(series) {
        let (Some(entry), Some(&number)) = (series.get(index), colours.get(index)) else { continue };
        let middle = top + (row as f64 + 0.5) * LEGEND_ROW;
        let ends = [left, left + SWATCH / 2.0, left + SWATCH].map(|x| (units(x), units(middle)));
        draw_stroke(canvas, &ends, entry.stroke, colour(number))?;
        let room = WIDTH - MARGIN - left - SWATCH - 6.0;
        let (label, size) = fitted(&entry.label, LABEL_SIZE, room);
        write_text(canvas, &label, (left + SWATCH + 6.0, middle), &font(size, FontStyle::Normal, HPos::Left))?;
    }
    Ok(())
}

/// Room that tick labels and the axis label need left of the frame.
pub(super) fn left_room(axis: &Axis) -> f64 {
    20.0 + axis.label_width() as f64 * CHARACTER * TICK_SIZE + LABEL_SIZE
}

/// Room below the frame, with or without an axis label.
pub(super) fn bottom_room(x_label: &str) -> f64 {
    if x_label.is_empty() { 8.0 } else { 48.0 }
}

pub(super) fn draw_chart(canvas: &Canvas<'_>, area: Area, left: f64, chart: &Chart<'_>) -> Result<(), DrawError> {
    let (frame_left, frame_right) = (MARGIN / 2.0 + left, WIDTH - MARGIN - 6.0);
    let (frame_top, frame_bottom) = (area.top + 6.0, area.top + area.height - bottom_room(chart.x_label));
    let frame = canvas.clone().shrink(
        (units(frame_left), units(frame_top)),
        (units(frame_right - frame_left), units(frame_bottom - frame_top)),
    );
    let mut context = ChartBuilder::on(&frame).build_cartesian_2d(chart.x.clone(), chart.y.clone())?;
    let mut mesh = context.configure_mesh();
    mesh.bold_line_style(line(GRID, 1.0)).light_line_style(TRANSPARENT).axis_style(line(FRAME, 1.0));
    mesh.draw()?;
    let place = |&(x, y): &(f64, f64)| context.plotting_area().map_coordinate(&(x, y));
    let scales = (chart.x.scale(), chart.y.scale());
    let mut empty = true;
    for wide_ones in [true, false] {
        for (series, &number) in chart.series.iter().zip(chart.colours) {
            if (series.stroke == Stroke::Wide) == wide_ones {
                for piece in pieces(&series.points, scales, place) {
                    draw_stroke(canvas, &piece, series.stroke, colour(number))?;
                    empty = false;
                }
            }
        }
    }
    let middle = ((frame_left + frame_right) / 2.0, (frame_top + frame_bottom) / 2.0);
    if empty {
        write_text(canvas, "no finite values", middle, &font(LABEL_SIZE, FontStyle::Italic, HPos::Center))?;
    }
    let small = |anchor| font(TICK_SIZE, FontStyle::Normal, anchor);
    for tick in chart.y.ticks() {
        let (_, y) = place(&(chart.x.middle(), tick));
        write_at(canvas, &chart.y.label(tick), (units(frame_left - 7.0), y), &small(HPos::Right))?;
    }
    let label = font(LABEL_SIZE, FontStyle::Normal, HPos::Center);
    let (y_label, size) = fitted(chart.y_label, LABEL_SIZE, area.height);
    let turned = font(size, FontStyle::Normal, HPos::Center).transform(plotters::style::FontTransform::Rotate270);
    write_text(canvas, &y_label, (MARGIN / 2.0 + LABEL_SIZE / 2.0, middle.1), &turned)?;
    if chart.x_label.is_empty() {
        return Ok(());
    }
    for tick in chart.x.ticks() {
        let (x, _) = place(&(tick, chart.y.middle()));
        write_at(canvas, &chart.x.label(tick), (x, units(frame_bottom + 13.0)), &small(HPos::Center))?;
    }
    let (x_label, _) = fitted(chart.x_label, LABEL_SIZE, frame_right - frame_left);
    write_text(canvas, &x_label, (middle.0, frame_bottom + 34.0), &label)
}
