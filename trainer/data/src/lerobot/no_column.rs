//! Columns in a program without the reader of Parquet files.

use crate::lerobot_problem::LerobotProblem;
use std::path::Path;

/// Refuses to read, and says how to build a program that reads.
pub(super) fn read(_: &Path, _: &str, _: (&str, usize)) -> Result<Vec<f64>, LerobotProblem> {
    Err(LerobotProblem::NotBuilt)
}
