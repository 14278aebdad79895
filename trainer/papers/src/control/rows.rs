//! Rows of the tables.

use crate::table::aligned;
use serde::{Serialize, Serializer};
use std::fmt;

/// A row: a controller on a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Table: policy, single or robustness.
    pub table: &'static str,
    /// Robot: acrobot or pendubot.
    pub robot: &'static str,
    /// Name of the controller; ours begin with `leastaction`.
    pub controller: &'static str,
    /// Model that our controller believes in; none if the row is published.
    pub model: Option<&'static str>,
    /// Whether the row was published by others.
    pub published: bool,
    /// Number of seeds.
    pub seeds: usize,
    /// Mean score over the seeds.
    pub score_mean: f64,
    /// Standard deviation of the score over the seeds; none of a single one.
    pub score_std: Option<f64>,
    /// The table's own columns.
    #[serde(flatten)]
    pub columns: Columns,
}

/// Named numbers; `None` for unknown ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns(pub Vec<(&'static str, Option<f64>)>);

impl Serialize for Columns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

/// All rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The rows, table by table and robot by robot.
    pub rows: Vec<Row>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let blocks = self.rows.chunk_by(|a, b| (a.table, a.robot) == (b.table, b.robot));
        for (k, block) in blocks.enumerate() {
            let Some(first) = block.first() else { continue };
            writeln!(f, "{}{}, {}", if k > 0 { "\n" } else { "" }, first.table, first.robot)?;
            let names = first.columns.0.iter().map(|(name, _)| (*name).to_owned());
            let head = ["controller", "model", "seeds", "score", "std"].map(str::to_owned);
            let mut cells = vec![head.into_iter().chain(names).collect()];
            cells.extend(block.iter().map(Row::cells));
            f.write_str(&aligned(&cells, 2))?;
        }
        Ok(())
    }
}

impl Row {
    fn cells(&self) -> Vec<String> {
        let number = |x: Option<f64>| x.map_or_else(|| "–".to_owned(), |x| format!("{x:.3}"));
        let model = self.model.unwrap_or("published").to_owned();
        let start = [self.controller.to_owned(), model, self.seeds.to_string()];
        let scores = [number(Some(self.score_mean)), number(self.score_std)];
        start.into_iter().chain(scores).chain(self.columns.0.iter().map(|(_, x)| number(*x))).collect()
    }
}
