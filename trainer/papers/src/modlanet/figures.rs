//! Pictures of the table's contents.

use super::super::{numbered, option_name};
use super::{LongRun, Outcome, Pictured};
use leastaction_ground_truth::ManyBody;
use leastaction_plot::{
    Angle, Panel, Phase, PlotError, Series, Stroke, Vertical, phase_portrait, time_series,
};
use std::path::Path;

/// Duration of the motion in a picture of paths, s.
const PATH_SECONDS: f64 = 10.0;

/// Draws the accelerations of the test set (the paper's Figure 8), the prediction over time (Figures 5 and 6), the paths of its first start
/// (Figure 7), and the energies of the long run; returns the names of the files.
pub(super) fn draw(folder: &Path, row: &Outcome) -> Result<Vec<String>, PlotError> {
    let name =
        format!("{}-{}-{}-{}", option_name(&row.case), numbered(row.system, row.count), row.kind, row.seed);
    let mut drawn = Vec::new();
    let mut file = |what: &str| {
        let file = format!("{name}-{what}.svg");
        drawn.push(file.clone());
        folder.join(file)
    };
    if !row.accelerations.is_empty() {
        draw_accelerations(&file("accelerations"), row)?;
    }
    if let Some(pictured) = &row.pictured {
        draw_errors(&file("errors"), row, pictured)?;
        draw_paths(&file("paths"), row, pictured)?;
    }
    if let Some(run) = &row.long_run {
        draw_energy(&file("energy"), run)?;
    }
    Ok(drawn)
}

fn is_chain(row: &Outcome) -> bool {
    row.system == ManyBody::Pendulum(row.count).name()
}

fn title(row: &Outcome) -> String {
    let what = if is_chain(row) { "pendulums" } else { "bodies" };
    format!("{} {what}, {}", row.count, row.kind)
}

/// Draws learned accelerations over the true ones.
fn draw_accelerations(file: &Path, row: &Outcome) -> Result<(), PlotError> {
    let truth = row.accelerations.iter().map(|(exact, _)| *exact);
    let [least, largest] =
        [truth.clone().fold(f64::INFINITY, f64::min), truth.fold(f64::NEG_INFINITY, f64::max)];
    let exact = Series::new("exact", [least, largest].map(|a| (a, a))).with_stroke(Stroke::Wide);
    let learned = Series::new("learned", row.accelerations.iter().copied()).with_stroke(Stroke::Points);
    let unit = if is_chain(row) { "rad/s²" } else { "m/s²" };
    let [x_label, y_label] = ["true", "learned"].map(|whose| format!("{whose} acceleration ({unit})"));
    let phase = Phase { x_label: &x_label, y_label: &y_label, angle: Angle::No };
    phase_portrait(file, &format!("{}: accelerations of the test set", title(row)), phase, &[exact, learned])
}

/// Draws mean squared errors over time beside those of exact physics in single precision.
fn draw_errors(file: &Path, row: &Outcome, pictured: &Pictured) -> Result<(), PlotError> {
    let Pictured { h, ours, floor, .. } = pictured;
    let over_time = |label: &str, errors: &[f64]| {
        Series::new(label, errors.iter().enumerate().map(|(k, error)| (k as f64 * h, *error)))
    };
    let both = |ours: &[f64], floor: &[f64]| {
        [over_time("learned", ours), over_time("exact physics in f32", floor).with_stroke(Stroke::Dashed)]
    };
    let (q, energy) = (both(&ours.mse_q, &floor.mse_q), both(&ours.mse_energy, &floor.mse_energy));
    let unit = if is_chain(row) { "MSE of q (rad²)" } else { "MSE of q (m²)" };
    let panels = [Panel::new(unit, &q), Panel::new("MSE of E (J²)", &energy)];
    let panels = panels.map(|panel| panel.with_vertical(Vertical::Logarithmic));
    time_series(file, &format!("{}: errors over {} starts", title(row), ours.trajectories.len()), &panels)
}

/// Draws paths of the first start: for a chain the path of its end, for bodies the paths of all.
fn draw_paths(file: &Path, row: &Outcome, pictured: &Pictured) -> Result<(), PlotError> {
    let shown = (PATH_SECONDS / pictured.h) as usize + 1;
    let paths = |label: &str, states: &[f64], stroke| -> Vec<Series> {
        let paths = paths(row, states).into_iter();
        paths.map(|path| Series::new(label, path.into_iter().take(shown)).with_stroke(stroke)).collect()
    };
    let mut series = paths("exact", &pictured.exact, Stroke::Wide);
    series.extend(paths("learned", &pictured.ours.first, Stroke::Solid));
    let phase = Phase { x_label: "x (m)", y_label: "y (m)", angle: Angle::No };
    phase_portrait(file, &format!("{}: the first {PATH_SECONDS} s of one motion", title(row)), phase, &series)
}

/// Paths of points in the plane along states (q, v); rods are 1 m long.
fn paths(row: &Outcome, states: &[f64]) -> Vec<Vec<(f64, f64)>> {
    if is_chain(row) {
        let end = |state: &[f64]| {
            let angles = state[..row.count].iter();
            angles.fold((0.0, 0.0), |(x, y), q| (x + q.sin(), y - q.cos()))
        };
        return vec![states.chunks_exact(2 * row.count).map(end).collect()];
    }
    let body = |k: usize| move |state: &[f64]| (state[2 * k], state[2 * k + 1]);
    (0..row.count).map(|k| states.chunks_exact(4 * row.count).map(body(k)).collect()).collect()
}

/// Draws the energy error of the long runs over time.
fn draw_energy(file: &Path, run: &LongRun) -> Result<(), PlotError> {
    let series = |label: &str, errors: &[(f64, f64)]| Series::new(label, errors.iter().copied());
    let del = [series("DEL, order 2", &run.del_2), series("DEL, order 4", &run.del_4)];
    let rk4 = [series("Runge-Kutta, order 4", &run.rk4)];
    let title = format!("Learned double pendulum, {} steps of {} s in f32", run.steps, run.h);
    let panels = [Panel::new("energy error (J)", &del), Panel::new("energy error (J)", &rk4)];
    time_series(file, &title, &panels)
}
