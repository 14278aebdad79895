//! Plot of a run.

use super::{FORCE, POSITION, Plant, Request, Row, Scenario, Trace, unit};
use leastaction::cli::Failure;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_firmware_sim::wrap;
use leastaction_ground_truth::Mechanism;
use leastaction_learning::atomic;
use leastaction_planning::moving_picture;
use leastaction_plot::{Panel, Series, Stroke, Vertical, time_series};
use std::path::{Path, PathBuf};

/// Plots positions (true, model, reference) and forces over time.
pub fn draw(file: &Path, request: &Request, trace: &Trace) -> Result<(), Failure> {
    let coordinates = request.plant.labels().into_iter().zip(request.plant.coordinates()).enumerate();
    let positions: Vec<_> = coordinates
        .map(|(i, (name, kind))| (kind, label(&name, kind), position(request.scenario, trace, i, kind)))
        .collect();
    let (force_label, forces) = forces(&request.plant, trace);
    let panels: Vec<Panel> = positions
        .iter()
        .map(|(kind, label, series)| Panel::new(label, series).with_vertical(vertical(*kind)))
        .chain([Panel::new(&force_label, &forces)])
        .collect();
    time_series(file, &title(request), &panels).map_err(|error| Failure::Work(error.to_string()))
}

/// File of the moving picture beside a plot.
pub fn moving_beside(picture: &Path) -> PathBuf {
    let mut name = picture.file_stem().unwrap_or_default().to_owned();
    name.push("-moving.svg");
    picture.with_file_name(name)
}

/// Draws the motion with the geometry of the model; `None` if the mechanism cannot be drawn.
pub fn draw_moving(file: PathBuf, request: &Request, trace: &Trace) -> Result<Option<PathBuf>, Failure> {
    let path: Vec<Vec<f64>> =
        trace.rows.iter().map(|row| row.q.iter().map(|q| f64::from(*q)).collect()).collect();
    let time = |row: Option<&Row>| row.map_or(0.0, |row| f64::from(row.time));
    let h = (time(trace.rows.last()) - time(trace.rows.first())) / (path.len().max(2) - 1) as f64;
    let Some(picture) = moving_picture(request.model, &path, h) else { return Ok(None) };
    atomic::write(&file, picture.as_bytes()).map_err(|error| Failure::file(&file, error))?;
    Ok(Some(file))
}

fn title(request: &Request) -> String {
    let zero = match request.plant {
        Plant::Exact(Mechanism::Acrobot) => " (θ = 0: hanging)",
        Plant::Exact(_) => " (θ = 0: upright)",
        Plant::Model { .. } => "",
    };
    let (scenario, system, seed) = (request.scenario, request.plant.name(), request.seed);
    let processor = request.on.map_or_else(String::new, |target| format!(", on a {}", target.board.name()));
    format!("{scenario} of the {system}, seed {seed}{processor}{zero}")
}

fn label(name: &str, kind: Coordinate) -> String {
    format!("{name} ({})", unit(kind, POSITION))
}

fn vertical(kind: Coordinate) -> Vertical {
    if kind == Coordinate::Angle { Vertical::Angle } else { Vertical::Linear }
}

fn position(scenario: Scenario, trace: &Trace, i: usize, kind: Coordinate) -> Vec<Series> {
    let angle = kind == Coordinate::Angle;
    // Upright is the same after any number of turns, so the motion is shown such that it ends within half a turn of its
    // reference.
    let turns = if angle { whole_turns(trace, i) } else { 0.0 };
    // Encoders do not count whole turns, so an estimated angle may differ from the true one by whole turns.
    let near = move |x: f32, q: f32| if angle { q + wrap(x - q) } else { x };
    let of_model = move |row: &Row| {
        let q = row.q.get(i)?;
        Some(near(*row.q_estimate.get(i)?, *q) - turns)
    };
    let truth = curve("true", trace, move |row| Some(row.q.get(i)? - turns)).with_stroke(Stroke::Wide);
    if scenario == Scenario::Predict {
        return vec![truth, curve("predicted by the model", trace, of_model)];
    }
    let reference = curve("reference", trace, move |row| row.reference.get(i).copied());
    vec![truth, curve("estimated by the model", trace, of_model), reference.with_stroke(Stroke::Dashed)]
}

/// Whole turns (rad) between the reference and the true angle at the end.
fn whole_turns(trace: &Trace, i: usize) -> f32 {
    let away = trace.rows.last().and_then(|row| Some(row.q.get(i)? - row.reference.get(i)?)).unwrap_or(0.0);
    away - wrap(away)
}

/// The forces that act, and the label of their axis.
fn forces(plant: &Plant, trace: &Trace) -> (String, Vec<Series>) {
    let acts = |i: usize| trace.rows.iter().any(|row| row.applied.get(i).is_some_and(|u| *u != 0.0));
    let coordinates = plant.labels().into_iter().zip(plant.coordinates()).enumerate();
    let acting: Vec<_> = coordinates.filter(|(i, _)| acts(*i)).collect();
    let mut units: Vec<_> = acting.iter().map(|(_, (_, kind))| unit(*kind, FORCE)).collect();
    units.dedup();
    let series = acting
        .iter()
        .map(|(i, (name, _))| curve(&format!("on {name}"), trace, |row| row.applied.get(*i).copied()))
        .collect();
    (format!("force ({})", units.join(", ")), series)
}

fn curve(label: &str, trace: &Trace, value: impl Fn(&Row) -> Option<f32>) -> Series {
    let point = |row: &Row| Some((f64::from(row.time), f64::from(value(row)?)));
    Series::new(label, trace.rows.iter().filter_map(point))
}
