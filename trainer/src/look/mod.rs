//! What is in logs of which nothing is known yet, and a first configuration.

mod configuration;
mod coordinate;
mod doubts;
mod report;

pub use coordinate::{Coordinate, FirstOutlier};
pub use report::{Column, File, Report};

use leastaction_learning::data::survey::{Clock, Guess, RawLog, Signal};
use leastaction_learning::data::{self, DataError};
use std::path::{Path, PathBuf};

/// Logs of one machine, looked at.
pub struct Look {
    patterns: Vec<PathBuf>,
    seen: Vec<Seen>,
    guess: Guess,
}

/// A file and what is in it, of one clock.
struct Seen {
    file: PathBuf,
    log: RawLog,
}

impl Look {
    /// Reads the files that patterns name; what their columns are is guessed by the first one.
    ///
    /// # Errors
    /// [`DataError`] where a pattern is none, or a file cannot be read.
    pub fn at(patterns: &[PathBuf]) -> Result<Self, DataError> {
        let mut seen: Vec<Seen> = Vec::new();
        let mut guess = None;
        for file in data::files(patterns)? {
            let logs = RawLog::read(&file)?;
            guess.get_or_insert_with(|| Guess::of(&logs));
            seen.extend(logs.into_iter().map(|log| Seen { file: file.clone(), log }));
        }
        let guess = guess.unwrap_or_default();
        Ok(Self { patterns: patterns.to_vec(), seen, guess })
    }

    /// What was seen.
    pub fn report(&self) -> Report {
        Report::new(&self.seen, &self.guess)
    }

    /// A configuration for a file of this name, which trains as it stands.
    ///
    /// # Errors
    /// Why there is none, in words, where the columns cannot be guessed.
    pub fn configuration(&self, at: &Path) -> Result<String, String> {
        configuration::of(&self.patterns, at, &self.report(), &self.guess)
    }
}

impl Report {
    /// Of these logs.
    fn new(seen: &[Seen], guess: &Guess) -> Self {
        let files: Vec<File> = seen.iter().map(|seen| of_file(&seen.file, &seen.log, guess)).collect();
        let first = seen.iter().take_while(|seen| Some(&seen.file) == files.first().map(|first| &first.file));
        let mut names: Vec<&String> = Vec::new();
        for name in first.flat_map(|seen| &seen.log.names) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let columns = names.into_iter().filter_map(|name| of_column(name, seen, guess)).collect();
        let others = seen.first().map_or(Vec::new(), |first| first.log.others.clone());
        let coordinates = Coordinate::all(seen, guess);
        Self { files, columns, coordinates, others, configuration: None }
    }
}

fn of_file(file: &Path, log: &RawLog, guess: &Guess) -> File {
    let clock = guess.t.as_deref().and_then(|t| log.column(t)).and_then(Clock::of);
    File::new(file, log, clock)
}

/// A column over all files that have it.
fn of_column(name: &str, seen: &[Seen], guess: &Guess) -> Option<Column> {
    let all: Vec<Signal> =
        seen.iter().filter_map(|seen| seen.log.column(name)).filter_map(Signal::of).collect();
    let signal = all.iter().copied().reduce(|a, b| Signal {
        least: a.least.min(b.least),
        greatest: a.greatest.max(b.greatest),
        missing: a.missing + b.missing,
        grid: a.grid.into_iter().chain(b.grid).min_by(f64::total_cmp),
        noise: a.noise.max(b.noise),
    })?;
    Some(Column::new(name, signal, role(name, guess)))
}

/// q0, v1 … where a column is taken for one.
fn role(name: &str, guess: &Guess) -> Option<String> {
    let at = |letter: &str, names: &[String]| {
        names.iter().position(|known| known == name).map(|i| format!("{letter}{i}"))
    };
    let time = guess.t.as_deref().filter(|t| *t == name).map(|_| "t".to_owned());
    time.or_else(|| at("q", &guess.q)).or_else(|| at("v", &guess.v)).or_else(|| at("u", &guess.u))
}
