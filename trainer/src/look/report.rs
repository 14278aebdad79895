//! Report on surveyed logs.

use super::coordinate::Coordinate;
use leastaction_learning::data::survey::{Clock, RawLog, Signal, time_unit};
use leastaction_learning::data::unit;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// The report.
#[derive(Serialize)]
pub struct Report {
    /// Every file.
    pub files: Vec<File>,
    /// Numeric columns.
    pub columns: Vec<Column>,
    /// Motion of every coordinate.
    pub coordinates: Vec<Coordinate>,
    /// Columns that are not numeric.
    pub others: Vec<String>,
    /// Configuration that was written.
    pub configuration: Option<PathBuf>,
}

/// A file, or a topic in it; times in s.
#[derive(Serialize)]
pub struct File {
    /// Name of the file.
    pub file: PathBuf,
    /// Topic, for an MCAP file.
    pub topic: Option<String>,
    /// Number of rows.
    pub samples: usize,
    /// Unit of the stamps.
    pub time_unit: Option<&'static str>,
    /// Time from the first to the last stamp.
    pub seconds: Option<f64>,
    /// Sampling rate by the median interval, Hz.
    pub rate: Option<f64>,
    /// Root mean square of (interval − median)/median.
    pub jitter: Option<f64>,
    /// Longest interval that is not a gap.
    pub longest: Option<f64>,
    /// Number of intervals of more than 2.5 medians.
    pub gaps: usize,
    /// Number of repeated stamps.
    pub repeated: usize,
    /// Number of stamps that go back in time.
    pub backwards: usize,
}

impl File {
    pub(super) fn new(file: &Path, log: &RawLog, clock: Option<Clock>) -> Self {
        let of_columns = clock.map(|clock| time_unit(clock.median));
        let time_unit = if log.is_in_seconds() { clock.map(|_| "s") } else { of_columns };
        let second = time_unit.and_then(unit);
        let seconds = |of: fn(&Clock) -> f64| Some(of(&clock?) * second?);
        Self {
            file: file.to_owned(),
            topic: log.topic.clone(),
            samples: log.samples(),
            time_unit,
            seconds: seconds(|clock| clock.duration),
            rate: seconds(|clock| clock.median).map(|median| 1.0 / median),
            jitter: clock.map(|clock| clock.jitter),
            longest: seconds(|clock| clock.longest),
            gaps: clock.map_or(0, |clock| clock.gaps),
            repeated: clock.map_or(0, |clock| clock.repeated),
            backwards: clock.map_or(0, |clock| clock.backwards),
        }
    }
}

/// A column, in its own units.
#[derive(Serialize)]
pub struct Column {
    /// Name.
    pub column: String,
    /// Assumed role.
    pub taken_for: Option<String>,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub greatest: f64,
    /// Encoder step.
    pub grid: Option<f64>,
    /// Standard deviation of the sample-to-sample noise.
    pub noise: f64,
    /// Number of cells without a number.
    pub missing: usize,
    /// Unit in a line of units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
}

impl Column {
    pub(super) fn new(name: &str, signal: Signal, taken_for: Option<String>) -> Self {
        let Signal { least, greatest, missing, grid, noise } = signal;
        Self { column: name.to_owned(), taken_for, least, greatest, grid, noise, missing, unit: None }
    }

    pub(super) fn is(&self, letter: char) -> bool {
        self.taken_for.as_deref().is_some_and(|role| role.starts_with(letter))
    }
}

impl Report {
    /// Whether the logs have no header, so that columns have numbers for names.
    pub(super) fn is_nameless(&self) -> bool {
        !self.columns.is_empty() && self.columns.iter().all(|column| column.column.starts_with('#'))
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let width = self.files.iter().map(|file| file.name().chars().count()).max().unwrap_or(0);
        writeln!(f, "{:width$}  samples        s       Hz   jitter  gaps  repeated", "file")?;
        self.files.iter().try_for_each(|file| file.line(f, width))?;
        let width =
            self.columns.iter().map(|column| column.column.chars().count()).max().unwrap_or(0).max(10);
        writeln!(f, "\n{:width$}  taken for        least     greatest         grid        noise", "column")?;
        self.columns.iter().try_for_each(|column| column.line(f, width))?;
        if !self.coordinates.is_empty() {
            writeln!(f, "\n{:width$}  rms per s  moving  reversals  turns  outliers", "coordinate")?;
            self.coordinates.iter().try_for_each(|coordinate| coordinate.line(f, width))?;
        }
        if !self.others.is_empty() {
            writeln!(f, "no numbers: {}", self.others.join(", "))?;
        }
        match &self.configuration {
            Some(file) => {
                writeln!(f, "\nwritten: {}; check its columns and kinds of coordinates", file.display())
            }
            None => Ok(()),
        }
    }
}

impl File {
    /// Name of the file, with its topic.
    fn name(&self) -> String {
        let topic = self.topic.as_ref().map_or(String::new(), |topic| format!(" {topic}"));
        format!("{}{topic}", self.file.display())
    }

    /// Whether the file may have this column.
    pub(super) fn may_have(&self, column: &str) -> bool {
        self.topic.as_ref().is_none_or(|topic| column.starts_with(topic.as_str()))
    }

    fn line(&self, f: &mut fmt::Formatter, width: usize) -> fmt::Result {
        let name = self.name();
        let or_dash = |number: Option<String>| number.unwrap_or_else(|| "–".to_owned());
        let seconds = or_dash(self.seconds.map(|seconds| format!("{seconds:.2}")));
        let rate = or_dash(self.rate.map(|rate| format!("{rate:.1}")));
        let jitter = or_dash(self.jitter.map(|jitter| format!("{:.2}%", 100.0 * jitter)));
        let Self { samples, gaps, repeated, .. } = self;
        writeln!(
            f,
            "{name:width$}  {samples:7}  {seconds:>7}  {rate:>7}  {jitter:>7}  {gaps:4}  {repeated:8}"
        )
    }
}

impl Column {
    fn line(&self, f: &mut fmt::Formatter, width: usize) -> fmt::Result {
        let Self { column, least, greatest, noise, .. } = self;
        let role = self.taken_for.as_deref().unwrap_or("");
        let grid = self.grid.map_or("–".to_owned(), |grid| format!("{grid:.3e}"));
        writeln!(
            f,
            "{column:width$}  {role:9}  {least:>11.4e}  {greatest:>11.4e}  {grid:>11}  {noise:>11.3e}"
        )
    }
}
