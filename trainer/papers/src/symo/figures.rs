//! Pictures of all rows.

use super::super::record::{Finished, Record, by_table};
use super::super::{Overview, distinct};
use leastaction_plot::{PlotError, Series, Stroke, log_log};
use std::path::Path;

/// Draws test and integration error, energy and inertia against the number of trajectories, one picture per mechanism and measure, with our
/// values and the paper's (Figure 4).
pub fn overview(folder: &Path, results: &[Finished]) -> Result<Vec<Overview>, PlotError> {
    let mut drawn = Vec::new();
    for (table, rows) in by_table(results).into_iter().filter(|(table, _)| !table.ends_with("noisy")) {
        for (k, (name, label)) in MEASURES.into_iter().enumerate() {
            let file = format!("{table}-{name}.svg");
            draw(&folder.join(&file), &format!("{table}: {label}"), &rows, k)?;
            drawn.push(Overview { table: table.to_owned(), file });
        }
    }
    Ok(drawn)
}

/// File names and titles of the measures of a row.
const MEASURES: [(&str, &str); 6] = [
    ("test", "error one step ahead"),
    ("integration", "error over 500 free steps"),
    ("median", "median error over 500 free steps"),
    ("100-steps", "error over 100 free steps"),
    ("energy", "error of the energy over 500 free steps"),
    ("inertia", "error of the inertia matrix"),
];

fn draw(file: &Path, title: &str, rows: &[&Record], k: usize) -> Result<(), PlotError> {
    let point = |record: &Record, value: Option<f64>| Some((record.subject.first()?.1.parse().ok()?, value?));
    let mut series = Vec::new();
    for model in distinct(rows.iter().map(|record| record.model.as_str())) {
        let rows = || rows.iter().filter(|record| record.model == model);
        let ours = rows().filter_map(|record| point(record, record.measures.get(k)?.ours));
        series.push(Series::new(model, ours).with_stroke(Stroke::Dotted));
        // The published models of the discrete equation have order 2.
        if !model.ends_with("order 4") {
            let paper = rows().filter_map(|record| point(record, record.measures.get(k)?.paper));
            let label = format!("{}, published", model.trim_end_matches(", order 2"));
            series.push(Series::new(label, paper).with_stroke(Stroke::Dotted));
        }
    }
    series.retain(|series| !series.points.is_empty());
    log_log(file, title, ("training trajectories", "mean squared error"), &series, &[])
}
