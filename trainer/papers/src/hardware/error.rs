//! Errors of a machine's logs and of a baseline.

use leastaction_learning::data::DataError;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why logs or a baseline cannot be used.
#[derive(Debug, Error)]
pub enum HardwareError {
    /// An invalid log.
    #[error(transparent)]
    Log(#[from] DataError),
    /// A folder or file cannot be read.
    #[error("{}: {error}", path.display())]
    Io {
        /// The folder or file.
        path: PathBuf,
        /// Reason given by the operating system.
        error: io::Error,
    },
    /// A folder without enough logs to learn from some and test others.
    #[error(
        "{}: {} of .csv; at least two are needed, to learn from one and test another",
        folder.display(),
        if *found == 0 { "no log" } else { "only one log" }
    )]
    TooFew {
        /// Folder that was searched.
        folder: PathBuf,
        /// Number of logs found.
        found: usize,
    },
    /// A log that is to be tested and does not exist.
    #[error("--test {wanted}: there are {found} logs, counted from 0 in order of their names")]
    NoLog {
        /// Number as given.
        wanted: usize,
        /// Number of logs.
        found: usize,
    },
    /// No log is left to learn from.
    #[error("--test: all {0} logs are tested, and none is left to learn from")]
    NoneLeft(usize),
    /// A log with hardly any samples for its duration.
    #[error(
        "{}: {samples} samples over {span:.3e} s; stamps must be in seconds, and a second have at least one sample",
        file.display()
    )]
    Sparse {
        /// The file.
        file: PathBuf,
        /// Time from the first to the last stamp, s.
        span: f64,
        /// Number of samples.
        samples: usize,
    },
    /// A file of parameters with a line that cannot be read.
    #[error("{}, line {line}: {what}", file.display())]
    Line {
        /// The file.
        file: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Problem with the line.
        what: String,
    },
    /// A file of parameters that do not describe a mechanism.
    #[error("{}: {what}", file.display())]
    Parameters {
        /// The file.
        file: PathBuf,
        /// Problem with the parameters.
        what: String,
    },
}

impl HardwareError {
    /// The error of a file or folder whose content cannot be used.
    pub(super) fn unusable(file: &Path, what: &impl ToString) -> Self {
        Self::Parameters { file: file.to_owned(), what: what.to_string() }
    }
}
