//! What can be wrong with logs of a machine and with a baseline.

use leastaction_learning::data::DataError;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Logs or a baseline that cannot be used.
#[derive(Debug, Error)]
pub enum HardwareError {
    /// A log.
    #[error(transparent)]
    Log(#[from] DataError),
    /// The operating system says why.
    #[error("{}: {error}", path.display())]
    Io {
        /// Of the folder or file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A folder without enough logs to learn from some and test others.
    #[error(
        "{}: {} of .csv; at least two are needed, to learn from one and test another",
        folder.display(),
        if *found == 0 { "no log" } else { "only one log" }
    )]
    TooFew {
        /// Where they were looked for.
        folder: PathBuf,
        /// How many there are.
        found: usize,
    },
    /// A log that is to be tested and is not there.
    #[error("--test {wanted}: there are {found} logs, counted from 0 in order of their names")]
    NoLog {
        /// As given.
        wanted: usize,
        /// How many there are.
        found: usize,
    },
    /// All logs are to be tested.
    #[error("--test: all {0} logs are tested, and none is left to learn from")]
    NoneLeft(usize),
    /// A log with hardly any samples for its time.
    #[error(
        "{}: {samples} samples over {span:.3e} s; stamps must be in seconds, and a second have at least one sample",
        file.display()
    )]
    Sparse {
        /// Which.
        file: PathBuf,
        /// From the first to the last stamp, s.
        span: f64,
        /// How many there are.
        samples: usize,
    },
    /// A file of parameters that cannot be read.
    #[error("{}, line {line}: {what}", file.display())]
    Line {
        /// Which.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
    /// A file of parameters that are not those of a mechanism.
    #[error("{}: {what}", file.display())]
    Parameters {
        /// Which.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
}
