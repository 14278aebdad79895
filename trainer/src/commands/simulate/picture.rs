//! The picture of a run.

use super::{Row, Trace};
use crate::commands::output::Failure;
use leastaction::plot::{Panel, Series, Stroke, time_series};
use leastaction_firmware_sim::wrap;
use std::path::Path;

/// Draws positions (true, estimated, wanted) and forces over time.
pub fn draw(file: &Path, title: &str, kinds: &str, trace: &Trace) -> Result<(), Failure> {
    let panels: Vec<(String, Vec<Series>)> = kinds
        .char_indices()
        .flat_map(|(i, kind)| [(format!("q{i} ({})", unit(kind)), position(trace, i, kind))])
        .chain([("force (N, N m)".to_owned(), forces(trace, kinds.len()))])
        .collect();
    let panels: Vec<Panel> = panels.iter().map(|(label, series)| Panel::new(label, series)).collect();
    time_series(file, title, &panels).map_err(|error| Failure::Work(error.to_string()))
}

/// Of a position.
pub fn unit(kind: char) -> &'static str {
    if kind == 'a' { "rad" } else { "m" }
}

fn position(trace: &Trace, i: usize, kind: char) -> Vec<Series> {
    // Encoders forget whole turns, so that an estimated angle may be turns away from the true one.
    let near = move |x: f32, q: f32| if kind == 'a' { q + wrap(x - q) } else { x };
    let turns = if kind == 'a' { whole_turns(trace, i) } else { 0.0 };
    vec![
        curve("true", trace, move |row| row.q.get(i).copied()).with_stroke(Stroke::Wide),
        curve("estimated by the model", trace, move |row| {
            Some(near(*row.q_estimate.get(i)?, *row.q.get(i)?))
        }),
        curve("reference", trace, move |row| Some(row.reference.get(i)? + turns)).with_stroke(Stroke::Dashed),
    ]
}

/// Whole turns (rad) from the reference to the true angle at the end: upright is upright.
fn whole_turns(trace: &Trace, i: usize) -> f32 {
    let away = trace.rows.last().and_then(|row| Some(row.q.get(i)? - row.reference.get(i)?)).unwrap_or(0.0);
    away - wrap(away)
}

fn forces(trace: &Trace, n: usize) -> Vec<Series> {
    let acts = |i: &usize| trace.rows.iter().any(|row| row.applied.get(*i).is_some_and(|u| *u != 0.0));
    (0..n)
        .filter(acts)
        .map(|i| curve(&format!("u{i}"), trace, move |row| row.applied.get(i).copied()))
        .collect()
}

fn curve(label: &str, trace: &Trace, value: impl Fn(&Row) -> Option<f32>) -> Series {
    let point = |row: &Row| Some((f64::from(row.time), f64::from(value(row)?)));
    Series::new(label, trace.rows.iter().filter_map(point))
}
