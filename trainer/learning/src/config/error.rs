//! Errors in a configuration, with their place.

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
        /// The line with its key.
        text: String,
        /// The problem and its remedy.
        message: String,
    },
}

impl ConfigError {
    /// Locates the line of a TOML error and adds advice.
    pub(super) fn invalid(file: &Path, source: &str, error: &toml::de::Error) -> Self {
        let start = error.span().map_or(0, |span| span.start);
        Self::at(file, source, start, advise(error.message()))
    }

    /// An error at byte offset `start` of the text.
    pub(super) fn at(file: &Path, source: &str, start: usize, message: String) -> Self {
        let before = source.get(..start).unwrap_or(source);
        let line = before.matches('\n').count() + 1;
        let text = source.lines().nth(line - 1).unwrap_or_default().trim().to_owned();
        Self::Invalid { file: file.to_owned(), line, text, message }
    }
}

/// The message with advice on how to mend it.
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

/// The known name most like the unknown name, both from serde's message.
fn nearest(message: &str) -> Option<&str> {
    message.strip_prefix("unknown ")?;
    let mut names = message.split('`').skip(1).step_by(2);
    let unknown = names.next()?;
    let alike = names.map(|name| (strsim::jaro_winkler(unknown, name), name));
    alike.filter(|(alike, _)| *alike > 0.7).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}
