//! Poses of a mechanism as SVG text.

use super::skeleton::Part;
use super::view::View;
use std::fmt::Write;

/// Places of all points of a pose, pixels.
pub type Places = Vec<[f64; 2]>;

/// Half of the sides of a sliding block, pixels.
const BLOCK: [f64; 2] = [14.0, 8.0];

/// Drawing of this size.
pub fn svg(view: &View, inside: &str) -> String {
    let [width, height] = view.size.map(f64::ceil);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         stroke-linecap=\"round\" style=\"background:#fafafa\">{inside}</svg>\n"
    )
}

/// Parts of a pose. Each states the numbers of its points, by which a script moves it.
pub fn pose(parts: &[Part], places: &Places) -> String {
    parts.iter().map(|part| dressed(*part, places, "")).collect()
}

/// A part of a pose with further elements inside.
pub fn dressed(part: Part, places: &Places, inside: &str) -> String {
    match part {
        Part::Link(a, b) => line((a, b), places, ("#0072b2", 5), inside),
        Part::Rail(a, b) => line((a, b), places, ("#999", 2), inside),
        Part::Pivot(at) => {
            let [x, y] = places[at];
            format!(
                "<circle data-p=\"{at}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#fff\" stroke=\"#333\" stroke-width=\"1.5\">\
                 {inside}</circle>"
            )
        }
        Part::Block(at, [a, b]) => {
            let ([x, y], angle, [half, high]) = (places[at], slope(places[a], places[b]), BLOCK);
            format!(
                "<rect data-p=\"{at} {a} {b}\" x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" rx=\"2\" fill=\"#d55e00\" \
                 transform=\"translate({x:.1} {y:.1}) rotate({angle:.1})\">{inside}</rect>",
                -half,
                -high,
                2.0 * half,
                2.0 * high
            )
        }
    }
}

fn line((a, b): (usize, usize), places: &Places, (colour, width): (&str, u8), inside: &str) -> String {
    let ([x, y], [to_x, to_y]) = (places[a], places[b]);
    format!(
        "<line data-p=\"{a} {b}\" x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{to_x:.1}\" y2=\"{to_y:.1}\" stroke=\"{colour}\" \
         stroke-width=\"{width}\">{inside}</line>"
    )
}

/// Angle of a line, degrees clockwise.
pub fn slope([x, y]: [f64; 2], [to_x, to_y]: [f64; 2]) -> f64 {
    (to_y - y).atan2(to_x - x).to_degrees()
}

/// Path of a point through all poses.
pub fn trace(frames: &[Places], point: usize) -> String {
    let mut points = String::new();
    for [x, y] in frames.iter().map(|places| places[point]) {
        // Writing to a string does not fail.
        let _ = write!(points, "{x:.1},{y:.1} ");
    }
    format!(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#cc79a7\" stroke-width=\"1.2\"/>",
        points.trim_end()
    )
}

/// Bar of a round length in the lower left corner.
pub fn bar(view: &View) -> String {
    let lengths = (-4..=3).rev().flat_map(|power| [5.0, 2.0, 1.0].map(|of: f64| of * 10_f64.powi(power)));
    let Some(length) = lengths.into_iter().find(|length| length * view.scale <= 90.0) else {
        return String::new();
    };
    let (right, y) = (8.0 + length * view.scale, view.size[1].ceil() - 8.0);
    format!(
        "<line x1=\"8\" y1=\"{y}\" x2=\"{right:.1}\" y2=\"{y}\" stroke=\"#333\" stroke-width=\"1.5\"/>\
         <text x=\"8\" y=\"{}\" font-size=\"11\" font-family=\"sans-serif\" fill=\"#333\">{length} m</text>",
        y - 4.0
    )
}
