//! Survey of unknown logs, and a first configuration.

mod configuration;
mod coordinate;
mod doubts;
mod mechanism;
mod report;
mod tables;

pub use coordinate::{Coordinate, FirstOutlier};
pub use report::{Column, File, Report};

use configuration::Layout;
use leastaction_learning::config::Config;
use leastaction_learning::data::survey::{Clock, Goals, Guess, RawLog, Signal, is_of_angle};
use leastaction_learning::data::{self, DataError, Dataset, Problem};
use leastaction_learning::run::error_at_start;
use mechanism::{MOST_JOINTS, Mechanism};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use tables::Tables;

/// Surveyed logs of one machine.
pub struct Look {
    patterns: Vec<PathBuf>,
    seen: Vec<Seen>,
    guess: Guess,
    rate: Option<f64>,
    /// The robot's description, URDF or MJCF.
    description: Option<PathBuf>,
    /// Whether training reads the logs by leastaction's own names, which say where a trajectory ends.
    is_own: bool,
}

/// The data of a file that have one clock.
struct Seen {
    file: PathBuf,
    log: RawLog,
}

impl Seen {
    /// The clock of the time column, in its unit.
    fn clock(&self, t: &str) -> Option<Clock> {
        let stamps = self.log.column(t)?;
        let pieces = self.log.pieces();
        Clock::of_pieces(pieces.iter().map(|rows| &stamps[rows.clone()]))
    }
}

impl Look {
    /// Reads the files that match the patterns; the meaning of columns is guessed from the first file.
    ///
    /// # Errors
    /// [`DataError`] if a pattern is invalid, or if a file cannot be read.
    pub fn at(patterns: &[PathBuf]) -> Result<Self, DataError> {
        let mut seen: Vec<Seen> = Vec::new();
        let mut guess = None;
        for file in data::files(patterns)? {
            let logs = RawLog::read(&file)?;
            guess.get_or_insert_with(|| Guess::of(&logs));
            seen.extend(logs.into_iter().map(|log| Seen { file: file.clone(), log }));
        }
        let guess = guess.unwrap_or_default();
        let one_time = |seen: Seen| Seen { log: seen.log.with_one_time(&guess), ..seen };
        let seen: Vec<Seen> = seen.into_iter().map(one_time).collect();
        let is_own = seen.iter().all(|seen| seen.log.has_own_trajectories());
        Ok(Self { patterns: patterns.to_vec(), seen, guess, rate: None, description: None, is_own })
    }

    /// The survey, with the sampling rate (Hz) of logs without time.
    #[must_use]
    pub fn at_rate(self, rate: Option<f64>) -> Self {
        Self { rate, ..self }
    }

    /// The survey of a robot with a description, URDF or MJCF, which the configuration names.
    #[must_use]
    pub fn described(self, description: Option<PathBuf>) -> Self {
        Self { description, ..self }
    }

    /// The report on the logs.
    pub fn report(&self) -> Report {
        Report::new(&self.seen, &self.guess)
    }

    /// A configuration for a file of this name; it can be used for training without changes.
    ///
    /// # Errors
    /// The reason, in words, why the columns cannot be guessed.
    pub fn configuration(&self, at: &Path) -> Result<Proposal, String> {
        let report = self.report();
        let proposal = self.proposal(at, &report)?;
        let nameless = report.is_nameless().then(|| {
            let rest = if self.guess.u.is_empty() { "" } else { ", u are the others" };
            format!(
                "there is no header line: q are columns of which others are the derivatives{rest}; check [data.columns]"
            )
        });
        let note = nameless.into_iter().chain(proposal.note).reduce(|a, b| format!("{a}; {b}"));
        Ok(Proposal { note, ..proposal })
    }

    fn proposal(&self, at: &Path, report: &Report) -> Result<Proposal, String> {
        let step = self.step(report)?;
        let text = |at: &Path, mechanism: Option<&Mechanism>| self.text(at, report, mechanism, step);
        let propose = |mechanism: Option<&Mechanism>, said: Option<String>| {
            let refusal = self.refusal(&text(Path::new(""), mechanism)?);
            let is_refused = refusal.is_some();
            let note = said.into_iter().chain(refusal).reduce(|a, b| format!("{a}; {b}"));
            Ok(Proposal { text: text(at, mechanism)?, note, is_refused })
        };
        let n = self.guess.q.len();
        if n > MOST_JOINTS || self.guess.u.is_empty() || self.description.is_some() {
            return propose(None, None);
        }
        if n == 1 && self.goals().is_none() && self.guess.u.iter().all(|name| is_force(name)) {
            // A long heavy link moves as a slide does: only the name tells them apart.
            let said = "u is named a force, not a torque, so that the joint slides: [[model.bodies]] says so, check it";
            return propose(Some(&Mechanism::slide()), Some(said.to_owned()));
        }
        let all = Mechanism::all(n).into_iter().filter(|own| own.turns_where(&self.angles(report))).collect();
        match Found::among(all, |own| text(Path::new(""), Some(own)).ok()) {
            None => propose(Some(&Mechanism::links(n)), None),
            Some(found) => propose(Some(&found.mechanism), found.sentence()),
        }
    }

    fn text(
        &self,
        at: &Path,
        report: &Report,
        mechanism: Option<&Mechanism>,
        step: Option<f64>,
    ) -> Result<String, String> {
        let all_state = self.is_own || self.seen.iter().all(|seen| seen.log.stated.is_some());
        let trajectories = all_state.then(|| self.seen.iter().map(|seen| seen.log.pieces().len()).sum());
        let layout = Layout { step, rate: self.rate, trajectories, is_own: self.is_own };
        let tables = Tables {
            n: self.guess.q.len(),
            is_driven: !self.guess.u.is_empty(),
            goals: self.goals(),
            description: self.description.as_ref(),
            mechanism,
        };
        configuration::of((&self.patterns, at), report, &self.guess, &tables, layout)
    }

    /// How near commands are to positions, if they are positions to go to and no forces.
    fn goals(&self) -> Option<Goals> {
        let logs: Vec<&RawLog> = self.seen.iter().map(|seen| &seen.log).collect();
        Goals::of(&logs, &self.guess).filter(Goals::are_positions)
    }

    /// The step that the configuration gives (s): one for files whose steps differ, as the reader sees them.
    fn step(&self, report: &Report) -> Result<Option<f64>, String> {
        if let Some(step) = configuration::step(report, &self.guess) {
            return Ok(Some(step));
        }
        let text = self.text(Path::new(""), report, None, None)?;
        let differ = matches!(tried(&text), Err(Trouble::Reading(Problem::OtherStep { .. }, _)));
        Ok(configuration::common_step(report, &self.guess).filter(|_| differ))
    }

    /// The reason for which training would refuse a configuration before it learns, in words.
    fn refusal(&self, text: &str) -> Option<String> {
        let said = match tried(text) {
            Ok(config) => mismatch(&config)?,
            Err(Trouble::Reading(_, said) | Trouble::Configuration(said)) => said,
        };
        Some(format!("training will refuse the configuration as it stands: {said}"))
    }

    /// Whether each coordinate is an angle by its unit, its name, its jumps by whole turns or its range.
    fn angles(&self, report: &Report) -> Vec<bool> {
        let turns = |name: &String| {
            let coordinate = report.coordinates.iter().find(|coordinate| coordinate.column == *name);
            coordinate.is_some_and(|coordinate| coordinate.turns + coordinate.turns_of_360 > 0)
        };
        let column = |name: &String| report.columns.iter().find(|column| column.column == *name);
        let is_angle = |name: &String| match column(name).and_then(|column| column.unit) {
            Some("rad" | "deg" | "rev") => true,
            Some(_) => false,
            None => is_of_angle(name) || turns(name) || column(name).is_some_and(ranges_as_angle),
        };
        self.guess.q.iter().map(is_angle).collect()
    }
}

/// Range within a turn beyond which a coordinate is an angle, and no slide, which is seldom longer (rad or m).
const FAR: f64 = 2.5;

/// Whether a column moves far, but within one turn, as encoders give angles.
fn ranges_as_angle(column: &Column) -> bool {
    let Column { least, greatest, .. } = *column;
    let is_within = |low: f64, high: f64| least >= low - 1e-6 && greatest <= high + 1e-6;
    greatest - least > FAR && (is_within(-PI, PI) || is_within(0.0, TAU))
}

/// Trouble with a configuration.
enum Trouble {
    /// Logs are refused; the problem, and the error in words.
    Reading(Problem, String),
    /// The configuration is refused.
    Configuration(String),
}

/// The reason why a description does not fit the logs: it cannot be read, or has another number of joints.
fn mismatch(config: &Config) -> Option<String> {
    let columns = config.data.columns.iter().map(|columns| columns.columns.q.len()).next()?;
    match config.beginning() {
        Err(error) => Some(error.to_string()),
        Ok((model, _)) => (model.family.n() != columns).then(|| model.family.mismatch(columns)),
    }
}

/// Reads a configuration and its logs as training does.
fn tried(text: &str) -> Result<Config, Trouble> {
    let config =
        Config::parse(text, Path::new("")).map_err(|error| Trouble::Configuration(error.to_string()))?;
    for data in config.data.alternatives() {
        data.read().map_err(|error| {
            let said = error.to_string();
            Trouble::Reading(error.problem, said)
        })?;
    }
    Ok(config)
}

/// A first configuration.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The text of the file.
    pub text: String,
    /// Reason for a mechanism other than a chain of links, and for which training would refuse the configuration.
    pub note: Option<String>,
    /// Whether training would refuse it.
    pub is_refused: bool,
}

/// The mechanism that predicts held-back logs best before any training.
struct Found {
    mechanism: Mechanism,
    /// Position error on held-back logs, m or rad.
    error: f64,
    /// Error of the chain of links; NaN if nothing was predicted.
    of_links: f64,
}

/// Ratio of the error to that of the chain of links, below which another mechanism is proposed.
const BETTER: f64 = 0.7;

/// Whether a column's name says that it is a force on something that slides.
fn is_force(name: &str) -> bool {
    let name = name.to_lowercase();
    name.contains("force") && !name.contains("torque")
}

impl Found {
    /// Chooses among several mechanisms, of which the first is the chain of links; `text` gives the configuration of
    /// each. `None` if no log can be held back, or if no mechanism predicts anything.
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

    /// A note if the mechanism is not a chain of links.
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
    /// The report on these logs.
    fn new(seen: &[Seen], guess: &Guess) -> Self {
        let clock = |seen: &Seen| guess.t.as_deref().and_then(|t| seen.clock(t));
        let of_file = |seen: &Seen| File::new(&seen.file, &seen.log, clock(seen));
        let files: Vec<File> = seen.iter().map(of_file).collect();
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

/// Statistics of a column over all files that have it.
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
    let units = || seen.iter().flat_map(|seen| &seen.log.units);
    let unit = units().find(|(column, _)| column == name).map(|(_, unit)| *unit);
    Some(Column { unit, ..Column::new(name, signal, role(name, guess)) })
}

/// Assumed role of a column, such as q0 or v1.
fn role(name: &str, guess: &Guess) -> Option<String> {
    let at = |letter: &str, names: &[String]| {
        names.iter().position(|known| known == name).map(|i| format!("{letter}{i}"))
    };
    let time = guess.t.as_deref().filter(|t| *t == name).map(|_| "t".to_owned());
    time.or_else(|| at("q", &guess.q)).or_else(|| at("v", &guess.v)).or_else(|| at("u", &guess.u))
}
