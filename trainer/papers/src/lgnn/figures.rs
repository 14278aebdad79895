//! Pictures of the table, and of the learned terms; the learned terms are also written as comma-separated values.

use super::super::numbered;
use super::{Compared, Insight, Outcome};
use leastaction_learning::atomic;
use leastaction_plot::{Panel, PlotError, Series, Stroke, Vertical, stacked, time_series};
use std::path::Path;

/// Draws the errors of the rollout over time (the paper's Figures 3 and 4), the potential of the springs, the drag, and the pulls of the
/// rods along one motion, in files that begin with the name of the task; returns their names.
pub(super) fn draw(folder: &Path, task: &str, row: &Outcome) -> Result<Vec<String>, PlotError> {
    let name = format!("{task}-{}-{}", numbered(row.system, row.count), row.samples);
    let Insight { spring, drag, rods } = &row.insight;
    let mut drawn = Vec::new();
    drawn.extend(draw_errors(folder, &format!("{name}-errors.svg"), row)?);
    let (potential, force) = ("potential (J)", "drag (N)");
    drawn.extend(learned(folder, &format!("{name}-spring"), "length (m)", &[(potential, spring)])?);
    drawn.extend(learned(folder, &format!("{name}-drag"), "velocity (m/s)", &[(force, drag)])?);
    let pulls: Vec<_> = rods.iter().map(|rod| ("pull (N)", rod)).collect();
    drawn.extend(learned(folder, &format!("{name}-rods"), "time (s)", &pulls)?);
    Ok(drawn)
}

fn draw_errors(folder: &Path, name: &str, row: &Outcome) -> Result<Option<String>, PlotError> {
    let Some((h, rollouts)) = &row.pictured else { return Ok(None) };
    let over_time = |label: &str, errors: &[f64]| {
        [Series::new(label, (1u32..).zip(errors).map(|(k, error)| (f64::from(k) * h, *error)))]
    };
    let positions = over_time("rollout error", &rollouts.rollout_error);
    let energies = over_time("energy violation", &rollouts.energy_violation);
    let panels = [Panel::new("rollout error", &positions), Panel::new("energy violation", &energies)];
    let panels = panels.map(|panel| panel.with_vertical(Vertical::Logarithmic));
    let title = format!(
        "{}, {}, {}: geometric means over the starts",
        numbered(row.system, row.count),
        row.model,
        row.kind
    );
    time_series(&folder.join(name), &title, &panels)?;
    Ok(Some(name.to_owned()))
}

/// Draws a picture and writes a table that compare learned curves with the exact ones, one panel each; does nothing
/// without curves.
fn learned(
    folder: &Path,
    name: &str,
    abscissa: &str,
    curves: &[(&str, &Compared)],
) -> Result<Option<String>, PlotError> {
    let curves: Vec<_> = curves.iter().filter(|(_, curve)| !curve.is_empty()).collect();
    if curves.is_empty() {
        return Ok(None);
    }
    let mut text = format!("curve,{abscissa},learned,exact\n");
    for (k, (_, curve)) in curves.iter().enumerate() {
        curve.iter().for_each(|[x, learned, exact]| text += &format!("{k},{x},{learned:e},{exact:e}\n"));
    }
    let table = folder.join(format!("{name}.csv"));
    atomic::write(&table, text.as_bytes()).map_err(|error| PlotError::Write { file: table, error })?;
    let series: Vec<[Series; 2]> = curves.iter().map(|(_, curve)| both(curve)).collect();
    let panels: Vec<Panel> =
        curves.iter().zip(&series).map(|((label, _), series)| Panel::new(label, series)).collect();
    let file = format!("{name}.svg");
    stacked(&folder.join(&file), name, abscissa, &panels)?;
    Ok(Some(file))
}

fn both(curve: &Compared) -> [Series; 2] {
    let series = |label: &str, k: usize| Series::new(label, curve.iter().map(|row| (row[0], row[k])));
    [series("exact", 2).with_stroke(Stroke::Wide), series("learned", 1)]
}
