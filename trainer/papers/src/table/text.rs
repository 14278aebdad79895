use super::{Cell, Finished, Row, Table, exceptions, number, tables};

/// Returns the tables as text, with lists of everything that is better than our models, and of failures.
pub fn text(results: &[Finished]) -> String {
    let tables = tables(results);
    let mut text: String =
        tables.iter().map(|table| format!("{}\n{}\n", table.title, lines(table))).collect();
    let exceptions = exceptions(&tables);
    if !exceptions.is_empty() {
        text += &format!("Ours is not the best in\n  {}\n\n", exceptions.join("\n  "));
    }
    for task in results {
        if let Some(reason) = &task.failure {
            text += &format!("{} failed: {reason}\n", task.task);
        }
    }
    text
}

/// Head and rows, with aligned columns.
fn lines(table: &Table) -> String {
    let Some(first) = table.rows.first() else { return String::new() };
    let names = first.first.measures.iter().map(|measure| measure.name.clone());
    let subject = first.first.subject.iter().map(|(name, _)| name.clone());
    let head = subject.chain(["model".to_owned(), "weights".to_owned()]).chain(names).chain(["s".to_owned()]);
    let mut cells = vec![head.collect()];
    for row in &table.rows {
        cells.extend(row_cells(row));
    }
    let left = first.first.subject.len() + 1;
    let mut text = aligned(&cells, left);
    for row in &table.rows {
        if let Some(note) = &row.first.note {
            text += &format!("  {}, {}: {note}\n", super::subject(row.first), row.first.model);
        }
    }
    text
}

/// Cells with our values, the extremes over the seeds if there are several seeds, and the paper's values and the floor
/// if they are known.
fn row_cells(row: &Row) -> Vec<Vec<String>> {
    let (record, count) = (row.first, row.first.measures.len());
    let subject = || record.subject.iter();
    let of = |model: &str, weights: String, values: Vec<Option<f64>>, last: String| -> Vec<String> {
        let start =
            subject().map(|(_, value)| if model == record.model { value.clone() } else { String::new() });
        let values = values.into_iter().map(number);
        start.chain([model.to_owned(), weights]).chain(values).chain([last]).collect()
    };
    let cells: Vec<Cell> = (0..count).map(|k| row.cell(k)).collect();
    let medians = cells.iter().map(|cell| cell.median).collect();
    let seconds = format!("{:.1}", row.train_seconds() / row.seeds.len() as f64);
    let mut lines = vec![of(&record.model, record.parameters.to_string(), medians, seconds)];
    if row.seeds.len() > 1 {
        for (end, name) in ["  least", "  largest"].into_iter().enumerate() {
            let values = cells.iter().map(|cell| Some(cell.range[end]).filter(|x| x.is_finite())).collect();
            lines.push(of(name, String::new(), values, String::new()));
        }
    }
    let paper: Vec<_> = record.measures.iter().map(|measure| measure.paper).collect();
    let floor: Vec<_> = record.measures.iter().map(|measure| measure.floor).collect();
    if paper.iter().any(Option::is_some) {
        let weights = record.paper_parameters.map_or(String::new(), |count| count.to_string());
        lines.push(of("  paper", weights, paper, String::new()));
    }
    if floor.iter().any(Option::is_some) {
        lines.push(of("  floor", String::new(), floor, String::new()));
    }
    lines
}

/// Pads columns to the necessary width; the first `left` columns are aligned to the left.
pub fn aligned(cells: &[Vec<String>], left: usize) -> String {
    let columns = cells.first().map_or(0, Vec::len);
    let width = |k: usize| cells.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in cells {
        let padded = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| {
            if k < left { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        text += padded.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}
