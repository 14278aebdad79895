//! Problems with the columns that a configuration names.

use crate::problem::list;
use thiserror::Error;

/// Problem with named columns. The message says what to do about it.
#[derive(Debug, Error)]
pub enum ColumnProblem {
    /// A name, though the file has no header.
    #[error(
        "there is no header line that names {name:?}; columns are named by number, from 1 to {columns}: as q = [2, 3] under [data.columns]"
    )]
    NoHeader {
        /// Configured name.
        name: String,
        /// Number of columns.
        columns: usize,
    },
    /// No column of time, and no rate.
    #[error(
        "no column is time; name it, as t, under [data.columns], or say rate, in Hz, under [data]; the file has {}",
        list(known)
    )]
    NoTime {
        /// Names in the file.
        known: Vec<String>,
    },
    /// A sampling rate beside stamps.
    #[error("the file has a time, {0:?}; leave out rate under [data], or give that column another name")]
    RateAndTime(String),
    /// A column without a single number.
    #[error("{0} has no numbers; take it out of [data.columns]")]
    NoNumbers(String),
    /// A column without a single number in one of several trajectories.
    #[error(
        "{0} has no numbers from here to the end of the trajectory; take the trajectory out, or the column"
    )]
    NoNumbersFrom(String),
    /// A column index beyond the columns of an array.
    #[error("there is no column {index}; it has {found}, counted from 0")]
    NoIndex {
        /// Configured index.
        index: usize,
        /// Columns of the array.
        found: usize,
    },
}
