//! Pictures of all rows.

use super::super::record::{Finished, Record, by_table};
use super::super::{Overview, distinct};
use super::grid::STEP;
use super::task::ZEROS;
use super::window::HORIZONS;
use leastaction_plot::{PlotError, Series, Stroke, log_log};
use std::path::Path;

/// Draws the median error of every model against the horizon, one picture per table and kind of zeros.
pub fn overview(folder: &Path, results: &[Finished]) -> Result<Vec<Overview>, PlotError> {
    let mut drawn = Vec::new();
    for (table, rows) in by_table(results) {
        for zeros in distinct(rows.iter().filter_map(|record| zeros(record))) {
            let file = format!("{table}-{zeros}.svg").replace(", ", "-").replace(' ', "-");
            let own: Vec<&Record> =
                rows.iter().filter(|row| self::zeros(row) == Some(zeros)).copied().collect();
            draw(&folder.join(&file), &format!("{table}: median error, {zeros}"), &own)?;
            drawn.push(Overview { table: table.to_owned(), file });
        }
    }
    Ok(drawn)
}

/// Kind of zeros, as is or calibrated; `None` for a record without horizons.
fn zeros(record: &Record) -> Option<&str> {
    record.subject.first().filter(|(name, _)| name == ZEROS).map(|(_, value)| value.as_str())
}

fn draw(file: &Path, title: &str, rows: &[&Record]) -> Result<(), PlotError> {
    let seconds = HORIZONS.map(|steps| steps as f64 * STEP);
    let series = |model: &str| {
        let of = |record: &&&Record| record.model == model;
        let first = rows.iter().find(of).map_or(&[][..], |record| &record.measures);
        let points = seconds.into_iter().zip(first).filter_map(|(t, measure)| Some((t, measure.ours?)));
        let is_ours = rows.iter().find(of).is_some_and(|record| record.is_ours);
        Series::new(model, points).with_stroke(if is_ours { Stroke::Dotted } else { Stroke::Dashed })
    };
    let models = distinct(rows.iter().map(|record| record.model.as_str()));
    let mut series: Vec<Series> = models.into_iter().map(series).collect();
    // Series are sorted so that models with the same colour have different strokes.
    series.sort_by_key(|series| series.stroke == Stroke::Dotted);
    log_log(file, title, ("time ahead (s)", "error (rad)"), &series, &[])
}
