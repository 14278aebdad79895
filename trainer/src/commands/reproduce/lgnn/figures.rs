//! Pictures of what the table says, and of what was learned; the numbers of the latter also as comma-separated values.

use crate::commands::Done;
use crate::commands::output::Failure;
use crate::commands::reproduce::modlanet::numbered;
use leastaction::atomic;
use leastaction::plot::{Panel, PlotError, Series, Stroke, Vertical, stacked, time_series};
use leastaction::reproduce::lgnn::{Compared, Insight, Outcome};
use std::path::Path;

/// Draws the errors of every rollout over time (the paper's Figures 3 and 4), and of every model the potential of its springs, its
/// drag, and the pulls of the rods along one motion.
pub fn draw(folder: &Path, rows: &[Outcome]) -> Done {
    for row in rows {
        let name = name(row);
        let file = folder.join(format!("{name}-errors.svg"));
        draw_errors(&file, row).map_err(|error| Failure::file(&file, error))?;
        let Insight { spring, drag, rods } = &row.insight;
        let (potential, force) = ("potential (J)", "drag (N)");
        learned(folder, &format!("{name}-spring"), "length (m)", &[(potential, spring)])?;
        learned(folder, &format!("{name}-drag"), "velocity (m/s)", &[(force, drag)])?;
        let pulls: Vec<_> = rods.iter().map(|rod| ("pull (N)", rod)).collect();
        learned(folder, &format!("{name}-rods"), "time (s)", &pulls)?;
    }
    Ok(())
}

fn name(row: &Outcome) -> String {
    let drag = if row.drag > 0.0 { "-drag" } else { "" };
    let pull = if row.pull > 0.0 { "-pulled" } else { "" };
    format!("{}{drag}{pull}-{}-{}", numbered(row.system, row.count), row.samples, row.seed)
}

fn draw_errors(file: &Path, row: &Outcome) -> Result<(), PlotError> {
    let Some((h, rollouts)) = &row.pictured else { return Ok(()) };
    let over_time = |label: &str, errors: &[f64]| {
        [Series::new(label, (1u32..).zip(errors).map(|(k, error)| (f64::from(k) * h, *error)))]
    };
    let positions = over_time("rollout error", &rollouts.rollout_error);
    let energies = over_time("energy violation", &rollouts.energy_violation);
    let panels = [Panel::new("rollout error", &positions), Panel::new("energy violation", &energies)];
    let panels = panels.map(|panel| panel.with_vertical(Vertical::Logarithmic));
    let title = format!("{}, {}: geometric means over the starts", numbered(row.system, row.count), row.kind);
    time_series(file, &title, &panels)
}

/// A picture and a table of learned curves beside the exact ones, one panel each; nothing where there is none.
fn learned(folder: &Path, name: &str, abscissa: &str, curves: &[(&str, &Compared)]) -> Done {
    let curves: Vec<_> = curves.iter().filter(|(_, curve)| !curve.rows.is_empty()).collect();
    if curves.is_empty() {
        return Ok(());
    }
    let mut text = format!("curve,{abscissa},learned,exact\n");
    for (k, (_, curve)) in curves.iter().enumerate() {
        curve.rows.iter().for_each(|[x, learned, exact]| text += &format!("{k},{x},{learned:e},{exact:e}\n"));
    }
    let table = folder.join(format!("{name}.csv"));
    atomic::write(&table, text.as_bytes()).map_err(|error| Failure::file(&table, error))?;
    let series: Vec<[Series; 2]> = curves.iter().map(|(_, curve)| both(curve)).collect();
    let panels: Vec<Panel> =
        curves.iter().zip(&series).map(|((label, _), series)| Panel::new(label, series)).collect();
    let file = folder.join(format!("{name}.svg"));
    stacked(&file, name, abscissa, &panels).map_err(|error| Failure::file(&file, error))
}

fn both(curve: &Compared) -> [Series; 2] {
    let series = |label: &str, k: usize| Series::new(label, curve.rows.iter().map(|row| (row[0], row[k])));
    [series("exact", 2).with_stroke(Stroke::Wide), series("learned", 1)]
}
