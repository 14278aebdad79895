//! The canvas, the house style, and one chart in its frame.

use std::io;

use plotters::backend::SVGBackend;
use plotters::chart::ChartBuilder;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, DashedPathElement, PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontStyle, FontTransform, IntoFont, RGBColor, ShapeStyle, TRANSPARENT, TextStyle, WHITE,
};

use super::axis::Axis;
use super::curve::{Pixel, pieces};
use super::series::{Series, Stroke};

pub(super) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawError = DrawingAreaErrorKind<io::Error>;

/// Canvas units per pixel. Plotters rounds coordinates to whole units, which would be visible if they were pixels.
const UNIT: f64 = 4.0;

/// Factor by which plotters reduces the font size in its output.
const FONT_FACTOR: f64 = 1.24;

/// Mean character width relative to the font size, for a wide sans-serif font.
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

/// Okabe and Ito's colours, which colour-blind readers can distinguish; without yellow, which is too pale for a line.
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

/// Frame of a chart in pixels; labels are outside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Frame {
    const RIGHT: f64 = WIDTH - MARGIN - 8.0;

    fn middle(self) -> (f64, f64) {
        ((self.left + Self::RIGHT) / 2.0, (self.top + self.bottom) / 2.0)
    }
}

/// A chart before it is drawn.
pub(super) struct Chart<'a> {
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// Label of the horizontal axis; empty on a panel above another one.
    pub(super) x_label: &'a str,
    pub(super) y_label: &'a str,
    pub(super) series: &'a [Series],
    /// Colour of each series, as an index into the palette.
    pub(super) colours: &'a [usize],
}

/// Returns the SVG text of a figure that `draw` draws.
pub(super) fn render(
    height: f64,
    draw: impl FnOnce(&Canvas<'_>) -> Result<(), DrawError>,
) -> Result<String, DrawError> {
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

/// Top of the legend or the first chart, below the title.
pub(super) const HEAD: f64 = MARGIN + TITLE_SIZE + 10.0;

/// Height of a legend whose rows begin at `left`.
pub(super) fn legend_height(series: &[Series], left: f64) -> f64 {
    legend_slots(series, left).last().map_or(0.0, |&(_, row, _)| (row + 1) as f64 * LEGEND_ROW + 2.0)
}

/// Places of the labels in the legend: index of the first series with the label, row, and left edge.
fn legend_slots(all: &[Series], start: f64) -> Vec<(usize, usize, f64)> {
    let (mut row, mut left) = (0, start);
    let mut slots = Vec::new();
    let first = |index: usize, label: &str| all.iter().position(|other| other.label == label) == Some(index);
    let labelled =
        |(index, series): &(usize, &Series)| !series.label.is_empty() && first(*index, &series.label);
    for (index, series) in all.iter().enumerate().filter(labelled) {
        let width = SWATCH + 6.0 + text_width(&series.label, LABEL_SIZE) + 20.0;
        if left > start && left + width > WIDTH {
            (row, left) = (row + 1, start);
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

/// Draws a legend into the room above a frame.
pub(super) fn draw_legend(
    canvas: &Canvas<'_>,
    (top, left): (f64, f64),
    series: &[Series],
    colours: &[usize],
) -> Result<(), DrawError> {
    for (index, row, left) in legend_slots(series, left) {
        let (Some(entry), Some(&number)) = (series.get(index), colours.get(index)) else { continue };
        let middle = top + (row as f64 + 0.5) * LEGEND_ROW;
        let ends = [left, left + SWATCH / 2.0, left + SWATCH].map(|x| (units(x), units(middle)));
        draw_stroke(canvas, &ends, entry.stroke, colour(number))?;
        let room = WIDTH - MARGIN - left - SWATCH - 6.0;
        let (label, size) = fitted(&entry.label, LABEL_SIZE, room);
        write_text(
            canvas,
            &label,
            (left + SWATCH + 6.0, middle),
            &font(size, FontStyle::Normal, HPos::Left),
        )?;
    }
    Ok(())
}

/// Left edge of a frame, with room for the tick labels and the label of the axis.
pub(super) fn left_edge<'a>(axes: impl IntoIterator<Item = &'a Axis>) -> f64 {
    let widest = axes.into_iter().map(Axis::label_width).max().unwrap_or(1);
    MARGIN + LABEL_SIZE + 20.0 + widest as f64 * CHARACTER * TICK_SIZE
}

/// Room below a frame for tick labels and the label of the axis.
pub(super) const FOOT: f64 = 56.0;

pub(super) fn draw_chart(canvas: &Canvas<'_>, frame: Frame, chart: &Chart<'_>) -> Result<(), DrawError> {
    let inside = canvas.clone().shrink(
        (units(frame.left), units(frame.top)),
        (units(Frame::RIGHT - frame.left), units(frame.bottom - frame.top)),
    );
    let mut context = ChartBuilder::on(&inside).build_cartesian_2d(chart.x.clone(), chart.y.clone())?;
    let mut mesh = context.configure_mesh();
    mesh.bold_line_style(line(GRID, 1.0)).light_line_style(TRANSPARENT).draw()?;
    let place = |point: (f64, f64)| context.plotting_area().map_coordinate(&point);
    draw_curves(canvas, chart, place, frame)?;
    draw_axis_lines(canvas, frame)?;
    draw_vertical_labels(canvas, frame, chart, |y| place((chart.x.middle(), y)).1)?;
    draw_horizontal_labels(canvas, frame, chart, |x| place((x, chart.y.middle())).0)
}

fn draw_curves(
    canvas: &Canvas<'_>,
    chart: &Chart<'_>,
    place: impl Fn((f64, f64)) -> Pixel,
    frame: Frame,
) -> Result<(), DrawError> {
    let scales = (chart.x.scale(), chart.y.scale());
    let mut curves: Vec<_> = chart.series.iter().zip(chart.colours).collect();
    // A stable sort: wide curves go beneath, then thin ones; the rest keep their order.
    curves.sort_by_key(|(series, _)| (series.stroke != Stroke::Wide, series.stroke != Stroke::Thin));
    let mut drawn = 0;
    for (series, &number) in curves {
        for piece in pieces(&series.points, scales, &place) {
            draw_stroke(canvas, &piece, series.stroke, colour(number))?;
            drawn += 1;
        }
    }
    if drawn > 0 {
        return Ok(());
    }
    write_text(
        canvas,
        "no values to show",
        frame.middle(),
        &font(LABEL_SIZE, FontStyle::Italic, HPos::Center),
    )
}

fn draw_axis_lines(canvas: &Canvas<'_>, frame: Frame) -> Result<(), DrawError> {
    let corners = [(frame.left, frame.top), (frame.left, frame.bottom), (Frame::RIGHT, frame.bottom)];
    let corners = corners.map(|(x, y)| (units(x), units(y)));
    canvas.draw(&PathElement::new(corners.to_vec(), line(FRAME, 1.0)))
}

fn draw_vertical_labels(
    canvas: &Canvas<'_>,
    frame: Frame,
    chart: &Chart<'_>,
    place: impl Fn(f64) -> i32,
) -> Result<(), DrawError> {
    let style = font(TICK_SIZE, FontStyle::Normal, HPos::Right);
    for &tick in chart.y.ticks() {
        write_at(canvas, &chart.y.label(tick), (units(frame.left - 7.0), place(tick)), &style)?;
    }
    let (label, size) = fitted(chart.y_label, LABEL_SIZE, frame.bottom - frame.top + 24.0);
    let style = font(size, FontStyle::Normal, HPos::Center).transform(FontTransform::Rotate270);
    write_text(canvas, &label, (MARGIN / 2.0 + LABEL_SIZE, frame.middle().1), &style)
}

fn draw_horizontal_labels(
    canvas: &Canvas<'_>,
    frame: Frame,
    chart: &Chart<'_>,
    place: impl Fn(f64) -> i32,
) -> Result<(), DrawError> {
    if chart.x_label.is_empty() {
        return Ok(());
    }
    let style = font(TICK_SIZE, FontStyle::Normal, HPos::Center);
    for &tick in chart.x.ticks() {
        write_at(canvas, &chart.x.label(tick), (place(tick), units(frame.bottom + 14.0)), &style)?;
    }
    let (label, size) = fitted(chart.x_label, LABEL_SIZE, Frame::RIGHT - frame.left);
    let style = font(size, FontStyle::Normal, HPos::Center);
    write_text(canvas, &label, (frame.middle().0, frame.bottom + 35.0), &style)
}

/// Draws an unbroken curve; a single point as a dot.
fn draw_stroke(
    canvas: &Canvas<'_>,
    points: &[Pixel],
    stroke: Stroke,
    colour: RGBColor,
) -> Result<(), DrawError> {
    let dot = |&point: &Pixel, radius: f64| canvas.draw(&Circle::new(point, units(radius), colour.filled()));
    if let [point] = points {
        return dot(point, 2.0);
    }
    let path = |style: ShapeStyle| canvas.draw(&PathElement::new(points.to_vec(), style));
    match stroke {
        Stroke::Solid => path(line(colour, 1.6)),
        Stroke::Wide => path(line(colour.mix(0.35), 5.0)),
        Stroke::Thin => path(line(colour.mix(0.6), 0.8)),
        Stroke::Dashed => {
            let (dash, space) = (units(6.0), units(3.5));
            canvas.draw(&DashedPathElement::new(points.to_vec(), dash, space, line(colour, 1.6)))
        }
        Stroke::Dotted => {
            path(line(colour.mix(0.6), 1.0))?;
            points.iter().try_for_each(|point| dot(point, 3.0))
        }
        Stroke::Points => points.iter().try_for_each(|point| dot(point, 1.5)),
    }
}

fn line(colour: impl Color, width: f64) -> ShapeStyle {
    colour.stroke_width(units(width).unsigned_abs())
}

/// Converts pixels to canvas units.
fn units(pixels: f64) -> i32 {
    (pixels * UNIT).round() as i32
}

fn font(size: f64, style: FontStyle, anchor: HPos) -> TextStyle<'static> {
    let font = ("sans-serif", size * UNIT * FONT_FACTOR).into_font().style(style);
    TextStyle::from(font).color(&INK).pos(Pos::new(anchor, VPos::Center))
}

fn write_text(
    canvas: &Canvas<'_>,
    text: &str,
    (x, y): (f64, f64),
    style: &TextStyle<'_>,
) -> Result<(), DrawError> {
    write_at(canvas, text, (units(x), units(y)), style)
}

fn write_at(canvas: &Canvas<'_>, text: &str, at: Pixel, style: &TextStyle<'_>) -> Result<(), DrawError> {
    // XML does not allow control characters.
    let text: String = text.chars().filter(|c| !c.is_control()).collect();
    canvas.draw(&Text::new(text, at, style.clone()))
}

fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * CHARACTER * size
}

/// Shrinks a text, to no less than three quarters, and then cuts it, to fit `room` pixels.
fn fitted(text: &str, size: f64, room: f64) -> (String, f64) {
    let smaller = (size * room / text_width(text, size).max(1.0)).clamp(0.75 * size, size);
    let fitting = (room / (CHARACTER * smaller)).max(1.0) as usize;
    if text.chars().count() <= fitting {
        return (text.to_owned(), smaller);
    }
    let cut: String = text.chars().take(fitting.saturating_sub(1)).collect();
    (format!("{}…", cut.trim_end()), smaller)
}
