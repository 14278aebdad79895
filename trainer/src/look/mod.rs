//! What is in logs of which nothing is known yet, and a first configuration.

mod configuration;
mod coordinate;
mod doubts;
mod mechanism;
mod report;

pub use coordinate::{Coordinate, FirstOutlier};
pub use report::{Column, File, Report};

use leastaction_learning::config::Config;
use leastaction_learning::data::survey::{Clock, Guess, RawLog, Signal};
use leastaction_learning::data::{self, DataError, Dataset};
use leastaction_learning::run::error_at_start;
use mechanism::{MOST_JOINTS, Mechanism};
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
    pub fn configuration(&self, at: &Path) -> Result<Proposal, String> {
        let report = self.report();
        let text = |at: &Path, mechanism: Option<&Mechanism>| {
            configuration::of((&self.patterns, at), &report, &self.guess, mechanism)
        };
        let n = self.guess.q.len();
        if n > MOST_JOINTS || self.guess.u.is_empty() {
            return Ok(Proposal { text: text(at, None)?, note: None });
        }
        let Some(found) = Found::among(Mechanism::all(n), |own| text(Path::new(""), Some(own)).ok()) else {
            return Ok(Proposal { text: text(at, Some(&Mechanism::links(n)))?, note: None });
        };
        Ok(Proposal { text: text(at, Some(&found.mechanism))?, note: found.sentence() })
    }
}

/// A first configuration.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The text of the file.
    pub text: String,
    /// Why the mechanism is another one than links alone.
    pub note: Option<String>,
}

/// The mechanism that predicts logs best, before any training.
struct Found {
    mechanism: Mechanism,
    /// How far off positions of held-back logs are, m or rad.
    error: f64,
    /// Those of links alone; not a number where nothing was predicted.
    of_links: f64,
}

/// Another mechanism is proposed where its error is below this part of that of links.
const BETTER: f64 = 0.7;

impl Found {
    /// Of several mechanisms, links alone being the first, by the text of the configuration of each; `None` where no log can be held back or none
    /// predicts anything.
    fn among(all: Vec<Mechanism>, text: impl Fn(&Mechanism) -> Option<String>) -> Option<Self> {
        let mut data: Option<Dataset> = None;
        let errors = all.iter().map(|mechanism| {
            let config = Config::parse(&text(mechanism)?, Path::new("")).ok()?;
            let config = Config { data: config.data.alternatives().into_iter().next()?, ..config };
            if data.is_none() {
                data = Some(config.data.read().ok()?.0);
            }
            error_at_start(&config, data.as_ref()?).ok()?
        });
        let errors: Vec<f64> = errors.map(|error| error.unwrap_or(f64::NAN)).collect();
        let of_links = *errors.first()?;
        let is_worth = |error: f64| error < BETTER * of_links || of_links.is_nan() && error.is_finite();
        let others = all.iter().zip(&errors).filter(|(_, error)| is_worth(**error));
        let best = others.min_by(|a, b| a.1.total_cmp(b.1)).or_else(|| all.iter().zip(&errors).next())?;
        let (mechanism, error) = (best.0.clone(), *best.1);
        error.is_finite().then_some(Self { mechanism, error, of_links })
    }

    /// What there is to say where it is not links alone.
    fn sentence(&self) -> Option<String> {
        let Self { mechanism, error, of_links } = self;
        (error != of_links).then(|| {
            format!(
                "{mechanism}, predicts positions of held-back logs to {error:.1e} (m, rad) before any training, links alone to {of_links:.1e}: \
                 [[model.bodies]] says so, check it"
            )
        })
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
