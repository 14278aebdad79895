//! Pictures of what the table says.

use crate::commands::Done;
use crate::commands::output::Failure;
use crate::commands::reproduce::modlanet::numbered;
use leastaction::plot::{Panel, PlotError, Series, Vertical, time_series};
use leastaction::reproduce::lgnn::Outcome;
use std::path::Path;

/// Draws the errors of every rollout over time (the paper's Figures 3 and 4).
pub fn draw(folder: &Path, rows: &[Outcome]) -> Done {
    for row in rows {
        let file = folder.join(format!("{}.svg", name(row)));
        draw_errors(&file, row).map_err(|error| Failure::file(&file, error))?;
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
