//! What is wrong with a configuration, and where.

use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A configuration that cannot be used.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file could not be read.
    #[error("{}: {error}; `leastaction train --print-defaults` prints a configuration to begin with", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        error: io::Error,
    },
    /// The text is no configuration.
    #[error("{}:{line}: {text:?}: {message}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// The line with its key.
        text: String,
        /// What is wrong and what to do.
        message: String,
    },
}

impl ConfigError {
    /// Finds the line and says what to do.
    pub(super) fn invalid(file: &Path, source: &str, error: &toml::de::Error) -> Self {
        let start = error.span().map_or(0, |span| span.start);
        Self::at(file, source, start, advise(error.message()))
    }

    /// What is wrong at a place of the text.
    pub(super) fn at(file: &Path, source: &str, start: usize, message: String) -> Self {
        let before = source.get(..start).unwrap_or(source);
        let line = before.matches('\n').count() + 1;
        let text = source.lines().nth(line - 1).unwrap_or_default().trim().to_owned();
        Self::Invalid { file: file.to_owned(), line, text, message }
    }
}

/// The message with what to do about it.
fn advise(message: &str) -> String {
    let message = message.trim_end();
    if let Some(suggestion) = nearest(message) {
        return format!("{message}; did you mean `{suggestion}`?");
    }
    if message.starts_with("missing field") {
        return format!("{message}; add it (`leastaction train --print-defaults` shows every key)");
    }
    message.to_owned()
}

/// Of the names that serde lists as known, the one most like the name it does not know.
fn nearest(message: &str) -> Option<&str> {
    message.strip_prefix("unknown ")?;
    let mut names = message.split('`').skip(1).step_by(2);
    let unknown = names.next()?;
    let alike = names.map(|name| (strsim::jaro_winkler(unknown, name), name));
    alike.filter(|(alike, _)| *alike > 0.7).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}
