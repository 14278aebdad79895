//! `leastaction look`.

mod configuration;
mod report;

use clap::Args;
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction_learning::atomic;
use leastaction_learning::data;
use leastaction_learning::data::survey::{Clock, Guess, RawLog, Signal};
use report::{Column, File, Report};
use std::path::{Path, PathBuf};

/// Look at logs of which nothing is known yet: clocks, ranges, encoder grids, noise, and what the columns may be.
///
/// With -o it writes a first configuration, whose columns are guessed by their names: check it, then train with it.
///
/// Example: leastaction look "logs/*.csv" -o robot.toml
#[derive(Args)]
pub struct Look {
    /// Logs of one machine, .csv or .npz; *, ? and ** stand for several.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// A first configuration to write.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A file and what is in it.
struct Seen {
    file: PathBuf,
    log: RawLog,
}

impl Look {
    /// Reads and tells.
    pub fn run(self, output: Output) -> Done {
        if let Some(file) = &self.output {
            replaceable(file, FileKind::Configuration)?;
        }
        let seen = data::files(&self.files)?.into_iter().map(read).collect::<Result<Vec<_>, _>>()?;
        let Some(first) = seen.first() else {
            return Err(Failure::Input("name at least one log".to_owned()));
        };
        let guess = Guess::of(&first.log);
        let report = Report::new(&seen, &guess);
        report.doubts().iter().for_each(|doubt| output.note(&format!("note: {doubt}")));
        if let Some(file) = &self.output {
            let text = configuration::of(&self.files, file, &report, &guess)
                .map_err(|reason| Failure::Input(format!("no configuration is written: {reason}")))?;
            atomic::write(file, text.as_bytes()).map_err(|error| Failure::file(file, error))?;
        }
        output.report(&Report { configuration: self.output, ..report })
    }
}

fn read(file: PathBuf) -> Result<Seen, Failure> {
    let log = RawLog::read(&file)?;
    Ok(Seen { file, log })
}

impl Report {
    fn new(seen: &[Seen], guess: &Guess) -> Self {
        let files: Vec<File> = seen.iter().map(|seen| of_file(&seen.file, &seen.log, guess)).collect();
        let columns = seen.first().map_or(Vec::new(), |first| {
            first.log.names.iter().filter_map(|name| of_column(name, seen, guess)).collect()
        });
        let others = seen.first().map_or(Vec::new(), |first| first.log.others.clone());
        Self { files, columns, others, configuration: None }
    }
}

fn of_file(file: &Path, log: &RawLog, guess: &Guess) -> File {
    let clock = guess.t.as_deref().and_then(|t| log.column(t)).and_then(Clock::of);
    File::new(file, log.samples(), clock)
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
