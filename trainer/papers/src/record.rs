//! What an experiment leaves behind: rows that are written down, read again, joined and compared.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Which numbers are the good ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Better {
    /// Errors.
    Less,
    /// Times that a prediction holds.
    More,
}

/// A number of a row, beside that of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// As in the head of the table.
    pub name: String,
    /// Ours; `None` where it is not finite.
    pub ours: Option<f64>,
    /// The paper's, or what its program reaches; `None` where it is not known or failed.
    pub paper: Option<f64>,
    /// What exact physics reaches in the same measure, where that is not 0.
    pub floor: Option<f64>,
    /// Which is better.
    pub better: Better,
}

impl Measure {
    /// An error.
    pub fn error(name: &str, ours: f64, paper: Option<f64>) -> Self {
        let ours = Some(ours).filter(|x| x.is_finite());
        Self { name: name.to_owned(), ours, paper, floor: None, better: Better::Less }
    }

    /// The same, over a floor.
    #[must_use]
    pub fn over(self, floor: f64) -> Self {
        Self { floor: Some(floor).filter(|x| x.is_finite()), ..self }
    }

    /// A number of which more is better.
    #[must_use]
    pub fn more_is_better(self) -> Self {
        Self { better: Better::More, ..self }
    }
}

/// A row of a paper's table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Title of the table.
    pub table: String,
    /// What the models of the table are compared on: names of columns with their values, the same names in the whole table.
    pub subject: Vec<(String, String)>,
    /// Which model.
    pub model: String,
    /// Whether it is ours, and not one that ours is compared with.
    pub is_ours: bool,
    /// Numbers in its weight block that are learned.
    pub parameters: usize,
    /// Numbers in that of the paper's model.
    pub paper_parameters: Option<usize>,
    /// Of the weights and the data.
    pub seed: u64,
    /// Training time, s.
    pub train_seconds: f64,
    /// The same names in every row of a table.
    pub measures: Vec<Measure>,
    /// What else is to be said: how a row failed.
    pub note: Option<String>,
    /// Files of its pictures.
    pub pictures: Vec<String>,
    /// All numbers, as `--json` prints them.
    pub details: Value,
    /// Whether it sums other rows up: its numbers then stand beside the rows, not among them.
    pub is_summary: bool,
}

impl Record {
    /// Whether two rows differ by the seed alone.
    pub fn is_like(&self, other: &Self) -> bool {
        let key = |row: &Self| (row.table.clone(), row.subject.clone(), row.model.clone());
        key(self) == key(other)
    }
}

/// What a task has given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// Short name of the paper.
    pub paper: String,
    /// Name of the task.
    pub task: String,
    /// The command that does it again.
    pub command: String,
    /// What it learned from, in words.
    pub data: String,
    /// Everything that the result depends on.
    pub settings: String,
    /// The options that all tasks of a run have in common, as on the command line.
    #[serde(default)]
    pub options: String,
    /// Wall time, s.
    pub seconds: f64,
    /// Why there are no rows.
    pub failure: Option<String>,
    /// The rows.
    pub records: Vec<Record>,
}
