use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reason why there is no plan.
#[derive(Debug, Error)]
pub enum PlanError {
    /// The configuration could not be read.
    #[error("{}: {error}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The text is not a valid configuration.
    #[error("{}:{line}: {text:?}: {message}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// The line.
        text: String,
        /// The problem and its remedy.
        message: String,
    },
    /// A value has no meaning for the model.
    #[error("`{key}` {message}")]
    Value {
        /// The key.
        key: String,
        /// The problem and its remedy.
        message: String,
    },
    /// The model cannot be used.
    #[error("{}: {message}", file.display())]
    Model {
        /// The file.
        file: PathBuf,
        /// The problem and its remedy.
        message: String,
    },
    /// The motion cannot be computed.
    #[error("{0}")]
    Motion(String),
}

impl PlanError {
    /// Locates the line of a TOML error.
    pub(crate) fn invalid(file: &Path, source: &str, error: &toml::de::Error) -> Self {
        let start = error.span().map_or(0, |span| span.start);
        let line = source.get(..start).unwrap_or(source).matches('\n').count() + 1;
        let text = source.lines().nth(line - 1).unwrap_or_default().trim().to_owned();
        Self::Invalid { file: file.to_owned(), line, text, message: error.message().trim_end().to_owned() }
    }

    /// An error at a key.
    pub(crate) fn value(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Value { key: key.into(), message: message.into() }
    }

    /// An error of a model file.
    pub(crate) fn model(file: &Path, message: impl ToString) -> Self {
        Self::Model { file: file.to_owned(), message: message.to_string() }
    }
}
