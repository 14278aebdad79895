//! Output on stdout and stderr, and exit codes.

use anstyle::AnsiColor;
use leastaction_learning::config::ConfigError;
use leastaction_learning::data::{DataError, Problem};
use leastaction_learning::run::RunError;
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// Output of a command.
#[derive(Clone, Copy, Default)]
pub struct Output {
    /// Whether to print one JSON object instead of text.
    pub json: bool,
    /// Whether to leave out progress and the command that comes next.
    pub quiet: bool,
}

/// Beginnings of messages, with the colours of the word before the colon on a terminal.
const KINDS: [(&str, AnsiColor); 4] = [
    ("error", AnsiColor::Red),
    ("warning", AnsiColor::Yellow),
    ("note", AnsiColor::Cyan),
    ("next", AnsiColor::Green),
];

/// The reason why a command did not succeed.
pub enum Failure {
    /// The work failed: exit code 1.
    Work(String),
    /// Wrong usage or unreadable input: exit code 2.
    Input(String),
    /// Interrupted with everything saved: exit code 130, as shells use it for Ctrl-C.
    Interrupted(String),
    /// stdout is closed: no message, exit code 0.
    ClosedPipe,
}

impl Failure {
    /// A failure of the work on a file.
    pub fn file(path: &Path, error: impl Display) -> Self {
        Self::Work(format!("{}: {error}", path.display()))
    }

    /// A failure due to an unusable file.
    pub fn input(path: &Path, error: impl Display) -> Self {
        Self::Input(format!("{}: {error}", path.display()))
    }
}

impl Output {
    /// Prints the result, as a JSON object or as text.
    pub fn report(self, report: &(impl Serialize + Display)) -> Result<(), Failure> {
        if self.json { object(report) } else { print(&report.to_string()) }
    }

    /// Prints a message for people on stderr: in lines and colours of the terminal, if it is one (`NO_COLOR` is obeyed).
    pub fn note(self, message: &str) {
        let message = if io::stderr().is_terminal() { in_lines(message) } else { message.to_owned() };
        // If stderr is closed, the message cannot be shown to anybody.
        let _closed = writeln!(anstream::stderr(), "{}", coloured(&message));
    }

    /// Prints the command that usually comes next.
    pub fn next(self, command: &str) {
        if !self.json && !self.quiet {
            self.note(&format!("next: leastaction {command}"));
        }
    }

    /// Prints notes, each a sentence.
    pub fn notes(self, sentences: &[String]) {
        sentences.iter().for_each(|sentence| self.note(&format!("note: {sentence}")));
    }

    /// Prints the reason for a failure and returns the exit code.
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

/// A message in lines as wide as the terminal; further lines are indented.
fn in_lines(message: &str) -> String {
    let options = textwrap::Options::with_termwidth().subsequent_indent("  ").break_words(false);
    let options = options.word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(message, options)
}

/// A message with the word before its colon in the colour of its kind.
fn coloured(message: &str) -> String {
    let kind = KINDS.iter().find_map(|(kind, colour)| Some((kind, colour, message.strip_prefix(kind)?)));
    match kind.filter(|(.., rest)| rest.starts_with(':')) {
        None => message.to_owned(),
        Some((kind, colour, rest)) => {
            let style = colour.on_default().bold();
            format!("{style}{kind}{style:#}{rest}")
        }
    }
}

/// Creates a folder to write to, unless it exists.
pub fn folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::input(path, "there is a file of this name; name a folder"));
    }
    std::fs::create_dir_all(path).map_err(|error| Failure::file(path, error))
}

/// Prints a JSON object on stdout.
pub fn object(report: &impl Serialize) -> Result<(), Failure> {
    let object = serde_json::to_string(report).map_err(|error| Failure::Work(error.to_string()))?;
    print(&format!("{object}\n"))
}

/// Prints text unchanged on stdout.
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

/// The failure to read a log.
impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Self::Input(error.to_string())
    }
}

/// The failure to write a log.
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

/// Refuses options that are given but have no meaning for the system.
pub fn refuse(system: &str, options: &[(bool, &str)]) -> Result<(), Failure> {
    match options.iter().find(|(given, _)| *given) {
        Some((_, option)) => {
            Err(Failure::Input(format!("{option} means nothing for {system}; leave it out")))
        }
        None => Ok(()),
    }
}
