//! Rows of a paper as tables, with the seeds of a row summarised, and a list of everything that is better than our
//! models.

mod csv;
mod html;
mod text;

pub use csv::csv;
pub use html::page;
pub(crate) use text::aligned;
pub use text::text;

use super::record::{Better, Finished, Measure, Record};
use leastaction_learning::evaluate::median;

/// A table of a paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<'r> {
    /// Title of the table.
    pub title: &'r str,
    /// Rows of the table; all have the columns of the first.
    pub rows: Vec<Row<'r>>,
}

/// A row with all its seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'r> {
    /// Record of the first seed.
    pub first: &'r Record,
    /// Task that gave the row.
    pub task: &'r Finished,
    /// Records of all seeds.
    pub seeds: Vec<&'r Record>,
}

/// A number over all seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Median; `None` if most seeds have no finite number.
    pub median: Option<f64>,
    /// Smallest and largest value.
    pub range: [f64; 2],
}

impl Row<'_> {
    /// Summarises measure `k` over the seeds.
    pub fn cell(&self, k: usize) -> Cell {
        let of = |record: &&Record| record.measures.get(k).and_then(|measure| measure.ours);
        let mut values: Vec<f64> = self.seeds.iter().filter_map(of).collect();
        values.sort_by(f64::total_cmp);
        let median = (2 * values.len() > self.seeds.len()).then(|| median(&values));
        let end = |value: Option<&f64>| value.copied().unwrap_or(f64::NAN);
        Cell { median, range: [end(values.first()), end(values.last())] }
    }

    /// Total training time of all seeds, s.
    pub fn train_seconds(&self) -> f64 {
        self.seeds.iter().map(|record| record.train_seconds).sum()
    }
}

/// Tasks that failed, each with the reason.
pub fn failures(results: &[Finished]) -> Vec<String> {
    let reason = |task: &Finished| task.failure.as_ref().map(|reason| format!("{}: {reason}", task.task));
    results.iter().filter_map(reason).collect()
}

/// All rows with their tasks.
fn rows(results: &[Finished]) -> impl Iterator<Item = (&Finished, &Record)> {
    results.iter().flat_map(|task| task.records.iter().map(move |record| (task, record)))
}

/// Returns the tables of these results, in order of first occurrence.
pub fn tables(results: &[Finished]) -> Vec<Table<'_>> {
    let mut tables: Vec<Table> = Vec::new();
    for (task, record) in rows(results) {
        let at = tables.iter().position(|table| table.title == record.table).unwrap_or_else(|| {
            tables.push(Table { title: &record.table, rows: Vec::new() });
            tables.len() - 1
        });
        let rows = &mut tables[at].rows;
        match rows.iter_mut().find(|row| row.first.is_like(record)) {
            Some(row) => row.seeds.push(record),
            None => rows.push(Row { first: record, task, seeds: vec![record] }),
        }
    }
    tables
}

/// Describes in words the rows in which another model, or the paper's, is better than ours and ours is not at the floor of exact physics:
/// the measures, each with our value and the better ones.
pub fn exceptions(tables: &[Table]) -> Vec<String> {
    let rows = tables.iter().flat_map(|table| table.rows.iter().map(move |row| (table, row)));
    rows.filter(|(_, row)| row.first.is_ours).filter_map(|(table, row)| exception(table, row)).collect()
}

/// Largest ratio of our value to the floor that counts as being at the floor.
const AT_FLOOR: f64 = 2.0;

/// Describes in words what is better than one of our rows, if anything is.
fn exception(table: &Table, ours: &Row) -> Option<String> {
    let is_rival = |row: &&Row| !row.first.is_ours && row.first.subject == ours.first.subject;
    let rivals: Vec<&Row> = table.rows.iter().filter(is_rival).collect();
    let of_measure = |(k, measure): (usize, &Measure)| {
        let median = ours.cell(k).median;
        let others = rivals.iter().filter_map(|row| Some((row.first.model.as_str(), row.cell(k).median?)));
        let all = measure.paper.map(|x| ("the paper", x)).into_iter().chain(others);
        let better: Vec<String> = all
            .filter(|(_, theirs)| !median.is_some_and(|ours| is_best(measure, ours, *theirs)))
            .map(|(who, theirs)| format!("{who} {}", number(Some(theirs))))
            .collect();
        let (name, median) = (&measure.name, number(median));
        (!better.is_empty()).then(|| format!("{name} {median} ({})", better.join(", ")))
    };
    let measures: Vec<String> = ours.first.measures.iter().enumerate().filter_map(of_measure).collect();
    let (subject, model) = (subject(ours.first), &ours.first.model);
    (!measures.is_empty()).then(|| format!("{}, {subject}, {model}: {}", table.title, measures.join("; ")))
}

/// Whether our value is at least as good as theirs, or at the floor.
fn is_best(measure: &Measure, ours: f64, theirs: f64) -> bool {
    match measure.better {
        Better::Less => ours <= theirs || measure.floor.is_some_and(|floor| ours <= AT_FLOOR * floor),
        Better::More => ours >= theirs || measure.floor.is_some_and(|floor| AT_FLOOR * ours >= floor),
    }
}

/// Subject of a row in words.
pub fn subject(record: &Record) -> String {
    record.subject.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<_>>().join(", ")
}

/// A number with three digits, or a dash.
pub fn number(x: Option<f64>) -> String {
    match x {
        None => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(x) if (0.01..1e4).contains(&x.abs()) => {
            let digits = (2 - x.abs().log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        Some(x) => format!("{x:.2e}"),
    }
}
