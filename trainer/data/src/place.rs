//! Places in a file.

use std::fmt;

/// Place in a file. Lines count from 1, rows and columns of arrays from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a CSV file.
    Line(u64),
    /// A cell of a CSV file.
    Cell {
        /// Line in the file, including comments.
        line: u64,
        /// Name in the header line.
        column: String,
    },
    /// An array of an NPZ file.
    Key(String),
    /// One sample of an array of an NPZ file.
    Row {
        /// Name of the array.
        key: String,
        /// Index along the first axis.
        row: usize,
    },
    /// A message of a bag, counted from 1 over all topics; in a damaged file the first that cannot be read.
    Message(u64),
    /// A message of one of several files of a bag, counted over all of them.
    PartOfBag {
        /// Name of the file.
        file: String,
        /// Message, from 1; 0 for the file as a whole.
        message: u64,
    },
    /// A number in a message of a bag.
    Value {
        /// Message, from 1, over all topics.
        message: u64,
        /// Name of the column.
        column: String,
    },
    /// A trajectory in memory, by its id.
    Trajectory(i64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Cell { line, column } => write!(f, ", line {line}, column {column}"),
            Self::Key(key) => write!(f, ", key {key}"),
            Self::Row { key, row } => write!(f, ", key {key}, row {row}"),
            Self::Message(message) => write!(f, ", message {message}"),
            Self::PartOfBag { file, message: 0 } => write!(f, ", file {file}"),
            Self::PartOfBag { file, message } => write!(f, ", file {file}, message {message}"),
            Self::Value { message, column } => write!(f, ", message {message}, {column}"),
            Self::Trajectory(id) => write!(f, ", trajectory {id}"),
        }
    }
}

impl Place {
    /// The place in one of several files of a bag.
    pub(crate) fn within(self, file: &std::path::Path) -> Self {
        let file = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match self {
            Self::File => Self::PartOfBag { file, message: 0 },
            Self::Message(message) => Self::PartOfBag { file, message },
            other => other,
        }
    }

    /// The place without the name of the column.
    pub(crate) fn without_column(self) -> Self {
        match self {
            Self::Cell { line, .. } => Self::Line(line),
            Self::Value { message, .. } => Self::Message(message),
            other => other,
        }
    }
}
