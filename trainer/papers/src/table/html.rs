use super::super::{Overview, Paper, distinct};
use super::{Finished, Row, Table, exceptions, failures, number, tables};
use leastaction_plot::page::{escaped, page as framed};
use std::path::Path;

/// Returns a self-contained page: the tables with the paper's numbers, ours, their ratio and the spread over the seeds,
/// the command and the data of every row, and the pictures in `folder`. At the top it lists everything that is better
/// than our models.
pub fn page(paper: &Paper, results: &[Finished], folder: &Path, overviews: &[Overview]) -> String {
    let tables = tables(results);
    let body: String = tables.iter().map(|table| section(table, folder, overviews)).collect();
    let about = escaped(paper.about);
    let lists = list("Ours is not the best in", &exceptions(&tables)) + &list("Failed", &failures(results));
    framed(paper.title, &format!("<p>{about}</p>\n{lists}{body}"))
}

fn list(title: &str, items: &[String]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let items: String = items.iter().map(|item| format!("<li>{}</li>\n", escaped(item))).collect();
    format!("<h2>{title}</h2>\n<ul>\n{items}</ul>\n")
}

fn section(table: &Table, folder: &Path, overviews: &[Overview]) -> String {
    let Some(first) = table.rows.first() else { return String::new() };
    let text = |name: &str| format!("<th class=\"text\">{}</th>", escaped(name));
    let subject: String = first.first.subject.iter().map(|(name, _)| text(name)).collect();
    let names = first.first.measures.iter().map(|measure| format!("<th>{}</th>", escaped(&measure.name)));
    let rows: String = table.rows.iter().map(line).collect();
    format!(
        "<h2>{}</h2>\n<div class=\"wide\"><table>\n<tr>{subject}{}<th>weights</th>{}<th>training, s</th></tr>\n{rows}</table></div>\n{}{}{}",
        escaped(table.title),
        text("model"),
        names.collect::<String>(),
        notes(table),
        commands(table),
        pictures(table, folder, overviews),
    )
}

fn line(row: &Row) -> String {
    let record = row.first;
    let text = |value: &str| format!("<td class=\"text\">{}</td>", escaped(value));
    let subject: String = record.subject.iter().map(|(_, value)| text(value)).collect();
    let weights =
        record.paper_parameters.map_or(String::new(), |count| format!("<small>paper {count}</small>"));
    let cells: String = (0..record.measures.len()).map(|k| cell(row, k)).collect();
    let class = if record.is_ours { "ours" } else { "other" };
    let seconds = row.train_seconds() / row.seeds.len() as f64;
    format!(
        "<tr class=\"{class}\">{subject}<td class=\"text\">{}</td><td>{}{weights}</td>{cells}<td>{seconds:.1}</td></tr>\n",
        escaped(&record.model),
        record.parameters,
    )
}

/// Cell with our value, the spread, the paper's value with the ratio, and the floor.
fn cell(row: &Row, k: usize) -> String {
    let (cell, Some(measure)) = (row.cell(k), row.first.measures.get(k)) else {
        return "<td></td>".to_owned();
    };
    let mut text = format!("<b>{}</b>", number(cell.median));
    if row.seeds.len() > 1 && cell.range[0].is_finite() {
        let [least, largest] = cell.range.map(|x| number(Some(x)));
        text += &format!("<small>{least} … {largest}, {} seeds</small>", row.seeds.len());
    }
    let ratio = measure.paper.zip(cell.median).map(|(paper, ours)| ours / paper);
    for (name, value) in [("paper", measure.paper), ("ratio", ratio), ("floor", measure.floor)] {
        if value.is_some() {
            text += &format!("<small>{name} {}</small>", number(value));
        }
    }
    let is_worse =
        ratio.is_some_and(|ratio| (measure.better == super::Better::Less) == (ratio > 1.0) && ratio != 1.0);
    format!("<td{}>{text}</td>", if is_worse { " class=\"worse\"" } else { "" })
}

/// Notes with the results that do not have their own column.
fn notes(table: &Table) -> String {
    let note = |row: &Row| {
        let (record, note) = (row.first, row.first.note.as_ref()?);
        let (subject, model) = (escaped(&super::subject(record)), escaped(&record.model));
        Some(format!("<li>{subject}, {model}: {}</li>\n", escaped(note)))
    };
    let notes: String = table.rows.iter().filter_map(note).collect();
    if notes.is_empty() { notes } else { format!("<ul class=\"notes\">\n{notes}</ul>\n") }
}

/// List of all tasks of the table: time, data and command.
fn commands(table: &Table) -> String {
    let mut tasks: Vec<&Finished> = Vec::new();
    for row in &table.rows {
        if !tasks.iter().any(|task| task.task == row.task.task) {
            tasks.push(row.task);
        }
    }
    let item = |task: &&Finished| {
        let (command, data) = (escaped(&task.command), escaped(&task.data));
        format!("<li><code>{command}</code> ({:.0} s; {data})</li>\n", task.seconds)
    };
    let items: String = tasks.iter().map(item).collect();
    format!("<details><summary>commands and data</summary>\n<ul>\n{items}</ul>\n</details>\n")
}

/// Pictures of the whole table, followed by those of its rows.
fn pictures(table: &Table, folder: &Path, overviews: &[Overview]) -> String {
    let of_table = overviews.iter().filter(|overview| overview.table == table.title);
    let of_table = of_table.map(|overview| overview.file.as_str());
    let of_rows = table.rows.iter().flat_map(|row| &row.first.pictures).map(String::as_str);
    let names = distinct(of_table.chain(of_rows));
    names.into_iter().enumerate().filter_map(|(k, name)| picture(name, folder, k == 0)).collect()
}

/// Embeds a picture, to be unfolded or shown at once; `None` if its file is gone.
fn picture(name: &str, folder: &Path, is_shown: bool) -> Option<String> {
    let svg = std::fs::read_to_string(folder.join(name)).ok()?;
    let svg = &svg[svg.find("<svg")?..];
    let title = escaped(name.trim_end_matches(".svg"));
    let open = if is_shown { " open" } else { "" };
    Some(format!("<details{open}><summary>{title}</summary>\n{svg}\n</details>\n"))
}
