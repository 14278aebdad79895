//! Results of an experiment: rows that are written, read again, joined and compared.

use super::distinct;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Direction in which a number is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Better {
    /// Smaller is better, for errors.
    Less,
    /// Larger is better, as for times over which a prediction is valid.
    More,
}

/// A number of a row, beside that of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// Name in the header of the table.
    pub name: String,
    /// Our value; `None` if it is not finite.
    pub ours: Option<f64>,
    /// Value of the paper or of its program; `None` if it is unknown or failed.
    pub paper: Option<f64>,
    /// Value for exact physics in the same measure, if it is not 0.
    pub floor: Option<f64>,
    /// Direction in which the number is better.
    pub better: Better,
}

impl Measure {
    /// Creates an error.
    pub fn error(name: &str, ours: f64, paper: Option<f64>) -> Self {
        let ours = Some(ours).filter(|x| x.is_finite());
        Self { name: name.to_owned(), ours, paper, floor: None, better: Better::Less }
    }

    /// Adds a floor.
    #[must_use]
    pub fn over(self, floor: f64) -> Self {
        Self { floor: Some(floor).filter(|x| x.is_finite()), ..self }
    }

    /// Marks the number as one for which larger is better.
    #[must_use]
    pub fn more_is_better(self) -> Self {
        Self { better: Better::More, ..self }
    }
}

/// A row of a paper's table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Title of the table.
    pub table: String,
    /// Columns that identify what the models are compared on: names with their values; all rows of the table have the
    /// same names.
    pub subject: Vec<(String, String)>,
    /// Name of the model.
    pub model: String,
    /// Whether it is our model rather than one that ours is compared with.
    pub is_ours: bool,
    /// Number of learned entries of its weight block.
    pub parameters: usize,
    /// Number of weights of the paper's model.
    pub paper_parameters: Option<usize>,
    /// Seed of the weights and the data.
    pub seed: u64,
    /// Training time, s.
    pub train_seconds: f64,
    /// Measures; all rows of a table have the same names.
    pub measures: Vec<Measure>,
    /// Further remarks, such as the reason for a failure.
    pub note: Option<String>,
    /// Files of its pictures.
    pub pictures: Vec<String>,
    /// All numbers, as `--json` prints them.
    pub details: Value,
    /// Whether it summarises other rows. Its numbers then stand beside the rows, not among them.
    pub is_summary: bool,
}

impl Record {
    /// Creates a row of a table with these columns and all numbers of `row` as its details.
    pub(crate) fn of<const N: usize>(
        table: &str,
        subject: [(&str, String); N],
        row: &impl Serialize,
    ) -> Result<Self, serde_json::Error> {
        let subject = subject.map(|(name, value)| (name.to_owned(), value)).into();
        let (table, details) = (table.to_owned(), serde_json::to_value(row)?);
        Ok(Self { table, subject, details, ..Self::default() })
    }

    /// Whether two rows differ only in their seeds.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.table, &self.subject, &self.model) == (&other.table, &other.subject, &other.model)
    }
}

/// Joins the remarks that are present.
pub(crate) fn note<const N: usize>(remarks: [Option<String>; N]) -> Option<String> {
    let remarks: Vec<String> = remarks.into_iter().flatten().collect();
    Some(remarks.join("; ")).filter(|note| !note.is_empty())
}

/// Results of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// Short name of the paper.
    pub paper: String,
    /// Name of the task.
    pub task: String,
    /// Command that repeats the task.
    pub command: String,
    /// Data that the models learned from, in words.
    pub data: String,
    /// Everything that the result depends on.
    pub settings: String,
    /// Options that all tasks of a run share, as on the command line.
    #[serde(default)]
    pub options: String,
    /// Wall time, s.
    pub seconds: f64,
    /// Reason why there are no rows.
    pub failure: Option<String>,
    /// Rows of the task.
    pub records: Vec<Record>,
}

/// Returns the rows of every table, in order of first occurrence.
pub(crate) fn by_table(results: &[Finished]) -> Vec<(&str, Vec<&Record>)> {
    let records: Vec<&Record> = results.iter().flat_map(|task| &task.records).collect();
    let tables = distinct(records.iter().map(|record| record.table.as_str())).into_iter();
    let of = |table| records.iter().filter(|record| record.table == table).copied().collect();
    tables.map(|table| (table, of(table))).collect()
}
