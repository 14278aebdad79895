//! What goes to stdout and stderr, and the exit code.

use leastaction_learning::config::ConfigError;
use leastaction_learning::data::{DataError, Problem};
use leastaction_learning::run::RunError;
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Where a command's words go.
#[derive(Clone, Copy)]
pub struct Output {
    /// One JSON object instead of text.
    pub json: bool,
}

/// Why a command did not succeed.
pub enum Failure {
    /// The work failed: exit code 1.
    Work(String),
    /// Wrong usage or unreadable input: exit code 2.
    Input(String),
    /// Interrupted, all saved: exit code 130, as shells have it for Ctrl-C.
    Interrupted(String),
    /// Nobody reads stdout any more: no message, exit code 0.
    ClosedPipe,
}

impl Failure {
    /// The work failed on a file.
    pub fn file(path: &Path, error: impl Display) -> Self {
        Self::Work(format!("{}: {error}", path.display()))
    }

    /// A file cannot be used.
    pub fn input(path: &Path, error: impl Display) -> Self {
        Self::Input(format!("{}: {error}", path.display()))
    }
}

impl Output {
    /// The result: a JSON object or text.
    pub fn report(self, report: &(impl Serialize + Display)) -> Result<(), Failure> {
        if self.json { object(report) } else { print(&report.to_string()) }
    }

    /// A message for people.
    pub fn note(self, message: &str) {
        // Nothing is left to tell where stderr is closed.
        let _closed = writeln!(io::stderr(), "{message}");
    }

    /// Notes, each a sentence.
    pub fn notes(self, sentences: &[String]) {
        sentences.iter().for_each(|sentence| self.note(&format!("note: {sentence}")));
    }

    /// Tells why and gives the exit code.
    pub fn fail(self, failure: &Failure) -> ExitCode {
        let (message, code) = match failure {
            Failure::Work(message) => (message, 1),
            Failure::Input(message) => (message, 2),
            Failure::Interrupted(message) => (message, 130),
            Failure::ClosedPipe => return ExitCode::SUCCESS,
        };
        self.note(&format!("error: {message}"));
        ExitCode::from(code)
    }
}

/// Makes sure that there is a folder to write to.
pub fn folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::input(path, "there is a file of this name; name a folder"));
    }
    std::fs::create_dir_all(path).map_err(|error| Failure::file(path, error))
}

/// A JSON object to stdout.
pub fn object(report: &impl Serialize) -> Result<(), Failure> {
    let object = serde_json::to_string(report).map_err(|error| Failure::Work(error.to_string()))?;
    print(&format!("{object}\n"))
}

/// Text as it is to stdout.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(Failure::ClosedPipe),
        Err(error) => Err(Failure::Work(format!("stdout: {error}"))),
        Ok(()) => Ok(()),
    }
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self::Input(error.to_string())
    }
}

/// Of a log that is read.
impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Self::Input(error.to_string())
    }
}

/// Of a log that is written.
pub fn written(error: DataError) -> Failure {
    let message = error.to_string();
    match error.problem {
        Problem::Io(_) => Failure::Work(message),
        _ => Failure::Input(message),
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let message = error.to_string();
        match error {
            RunError::Exists { .. } | RunError::Resume(_) => Self::Input(message),
            _ => Self::Work(message),
        }
    }
}

/// Refuses options that are given but mean nothing for the system.
pub fn refuse(system: &str, options: &[(bool, &str)]) -> Result<(), Failure> {
    match options.iter().find(|(given, _)| *given) {
        Some((_, option)) => {
            Err(Failure::Input(format!("{option} means nothing for {system}; leave it out")))
        }
        None => Ok(()),
    }
}
