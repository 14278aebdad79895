//! All numeric columns of a file.

use super::Guess;
use super::words::unit_in;
use crate::archive::Archive;
use crate::array_columns::Named;
use crate::bag::{Bag, Clock, Stream};
use crate::csv_sheet::Sheet;
use crate::csv_text::{Numbers, decoded, text};
use crate::error::Fault;
use crate::layout_note::LayoutNote;
use crate::lerobot::{Lerobot, TIME};
use crate::mat::MatFile;
use crate::place::Place;
use crate::problem::Problem;
use crate::source::{Source, format_of};
use crate::{DataError, Rows, date, located};
use csv::ByteRecord;
use std::ops::Range;
use std::path::Path;

/// The numeric columns of one clock in a file, unchanged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawLog {
    /// Topic, for a bag; its stamps are the column `t` (s).
    pub topic: Option<String>,
    /// Names of the columns; `name[i]` for a two-dimensional array.
    pub names: Vec<String>,
    /// Values of each column, all of the same length; NaN for missing numbers.
    pub columns: Vec<Vec<f64>>,
    /// Names of other columns.
    pub others: Vec<String>,
    /// Column of dates, here in s since 1970.
    pub dates: Option<String>,
    /// Units of a line under the header, each with its column, as far as [`crate::unit`] knows them.
    pub units: Vec<(String, &'static str)>,
    /// Rows where a trajectory begins because a header or an episode does, in rising order.
    pub starts: Vec<usize>,
    /// Meaning of the columns, where the format states it.
    pub stated: Option<Guess>,
}

/// Least fraction of numbers among a column's cells for the column to count as numeric.
const NUMBERS: f64 = 0.5;

/// Name of the column that says to which trajectory a row belongs.
const TRAJECTORY: &str = "trajectory";

impl RawLog {
    /// Reads a file: one log, or for a bag one log per topic with joints.
    ///
    /// # Errors
    /// [`DataError`] with the file, the place in it and the problem.
    pub fn read(path: &Path) -> Result<Vec<Self>, DataError> {
        located(path, || of_source(Source::open(path)?))
    }

    /// Reads a log as [`RawLog::read`] does, from the content of a file; `path` gives the format and appears in errors.
    ///
    /// # Errors
    /// See [`RawLog::read`].
    pub fn decode(path: &Path, bytes: &[u8]) -> Result<Vec<Self>, DataError> {
        located(path, || of_source(Source::of(format_of(path)?, bytes)))
    }

    /// Number of samples in every column.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// The column with this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let at = self.names.iter().position(|known| known == name)?;
        self.columns.get(at).map(Vec::as_slice)
    }

    /// Whether the columns have leastaction's own names, among them one of trajectories.
    #[must_use]
    pub fn has_own_trajectories(&self) -> bool {
        let is_own = |name: &String| {
            let (stem, _) = name.split_once('[').unwrap_or((name, ""));
            let field = stem.trim_end_matches(|digit: char| digit.is_ascii_digit());
            ["q", "v", "a", "u"].contains(&field)
                || ["t", TRAJECTORY].contains(&stem)
                || stem.starts_with('_')
        };
        self.names.iter().any(|name| name == TRAJECTORY) && self.names.iter().all(is_own)
    }

    /// Whether the unit of time is known to be s, whatever the stamps are.
    #[must_use]
    pub fn is_in_seconds(&self) -> bool {
        self.topic.is_some() || self.stated.is_some() || self.has_own_trajectories()
    }

    /// Rows of each trajectory: from one header to the next, and of one number in a log with leastaction's own names.
    #[must_use]
    pub fn pieces(&self) -> Vec<Range<usize>> {
        let ids = self.column(TRAJECTORY).filter(|_| self.has_own_trajectories());
        let changes = |row: usize| ids.is_some_and(|ids| ids[row] != ids[row - 1]);
        let is_start = |row: &usize| *row == 0 || self.starts.binary_search(row).is_ok() || changes(*row);
        let starts: Vec<usize> = (0..self.samples()).filter(is_start).collect();
        let ends = starts.iter().skip(1).copied().chain([self.samples()]);
        starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect()
    }

    /// The log with one column for the time where it has seconds and nanoseconds.
    #[must_use]
    pub fn with_one_time(mut self, guess: &Guess) -> Self {
        let position =
            |name: &Option<String>| self.names.iter().position(|known| Some(known) == name.as_ref());
        let (Some(sec), Some(nanosec)) = (position(&guess.t), position(&guess.nanosec)) else { return self };
        let sum = |(sec, nanosec): (&f64, &f64)| sec + 1e-9 * nanosec;
        self.columns[sec] = self.columns[sec].iter().zip(&self.columns[nanosec]).map(sum).collect();
        self
    }
}

fn of_source(source: Source) -> Result<Vec<RawLog>, Fault> {
    match source {
        Source::Csv(bytes) => Ok(vec![of_csv(&bytes)?]),
        Source::Npz(bytes) => Ok(vec![of_arrays(&Archive::open(&bytes)?, &[])?]),
        Source::Mat(bytes) => {
            let file = MatFile::read(&bytes)?;
            Ok(vec![of_arrays(&file, file.others())?])
        }
        Source::Lerobot(set) => Ok(vec![of_lerobot(&set)?]),
        Source::Bag(mut source) => Ok(of_bag(&Bag::read(&mut source)?)),
    }
}

fn of_csv(bytes: &[u8]) -> Result<RawLog, Fault> {
    let content = decoded(bytes)?;
    let any = |name: &[u8]| name.first().is_some_and(u8::is_ascii_alphabetic);
    let sheet = Sheet::open(&content, any)?;
    let names = sheet.names.clone();
    let mut cells =
        Cells { columns: vec![Vec::new(); names.len()], dates: vec![0; names.len()], ..Cells::default() };
    let layout = sheet.samples(|record, part| {
        cells.push(record, part);
        Ok(())
    })?;
    let Cells { columns, dates, starts, rows, .. } = cells;
    let of_dates = names.iter().zip(dates).find(|(_, dates)| 2 * dates > rows);
    let dates = of_dates.map(|(name, _)| name.clone());
    let log = RawLog { units: units(&names, &layout), names, columns, dates, starts, ..RawLog::default() }
        .of_numbers();
    if log.samples() == 0 { Err((Place::File, Problem::Empty)) } else { Ok(log) }
}

/// Cells of a CSV file so far.
#[derive(Default)]
struct Cells {
    columns: Vec<Vec<f64>>,
    /// Number of dates in every column.
    dates: Vec<usize>,
    starts: Vec<usize>,
    rows: usize,
    part: i64,
    numbers: Numbers,
}

impl Cells {
    fn push(&mut self, record: &ByteRecord, part: i64) {
        if part != self.part {
            self.starts.push(self.rows);
        }
        (self.rows, self.part) = (self.rows + 1, part);
        let cells = record.iter().chain(std::iter::repeat(&b""[..]));
        for ((column, dates), cell) in self.columns.iter_mut().zip(&mut self.dates).zip(cells) {
            let cell = text(cell);
            let date = date::seconds(&cell);
            *dates += usize::from(date.is_some());
            let number = date.or_else(|| self.numbers.read(cell, || Place::File).ok());
            column.push(number.unwrap_or(f64::NAN));
        }
    }
}

/// Units of the columns in a line of units, as far as they are known.
fn units(names: &[String], layout: &[LayoutNote]) -> Vec<(String, &'static str)> {
    let line = layout.iter().find_map(|note| match note {
        LayoutNote::UnitsLine { units, .. } => Some(units.split(", ")),
        _ => None,
    });
    let pairs = names.iter().zip(line.into_iter().flatten());
    pairs.filter_map(|(name, text)| Some((name.clone(), unit_in(text)?))).collect()
}

/// The arrays of an archive or a MATLAB file; `others` are not arrays of numbers.
fn of_arrays(arrays: &dyn Named, others: &[String]) -> Result<RawLog, Fault> {
    let mut parts: Vec<(&String, Rows)> = Vec::new();
    let mut others = others.to_vec();
    for name in arrays.names() {
        match arrays.rows(name).ok().flatten() {
            Some(rows) => parts.push((name, rows)),
            None => others.push(name.clone()),
        }
    }
    // The most common length is taken as the length of the log.
    let same = |length: usize| parts.iter().filter(|(_, rows)| rows.len() == length).count();
    let samples = parts.iter().map(|(_, rows)| rows.len()).max_by_key(|length| (same(*length), *length));
    let mut log = RawLog { others, ..RawLog::default() };
    for (name, rows) in parts {
        if Some(rows.len()) != samples {
            log.others.push(name.clone());
            continue;
        }
        for i in 0..rows.width() {
            log.names.push(if rows.width() == 1 { name.clone() } else { format!("{name}[{i}]") });
            log.columns.push(rows.column(i).collect());
        }
    }
    if log.samples() == 0 { Err((Place::File, Problem::Empty)) } else { Ok(log) }
}

/// The measurements and commands of a data set, and its stamps.
fn of_lerobot(set: &Lerobot) -> Result<RawLog, Fault> {
    let (mut names, mut columns) = (vec![TIME.to_owned()], vec![set.feature(TIME)?.as_flat().to_vec()]);
    for (feature, elements) in set.elements() {
        let rows = set.feature(feature)?;
        columns.extend((0..rows.width()).map(|i| rows.column(i).collect::<Vec<_>>()));
        names.extend(elements);
    }
    let episodes = set.episodes()?;
    if columns.iter().any(|column| column.len() != episodes.len()) {
        let (found, expected) = (columns[0].len(), episodes.len());
        return Err((
            Place::File,
            Problem::Inconsistent { name: "a feature", what: "samples", found, expected },
        ));
    }
    let starts = (1..episodes.len()).filter(|row| episodes[*row] != episodes[row - 1]).collect();
    let log = RawLog { names, columns, others: set.others(), starts, ..RawLog::default() };
    Ok(log.stated_by_lerobot())
}

fn of_bag(bag: &Bag) -> Vec<RawLog> {
    let clock = bag.clock();
    let streams = bag.streams.iter().enumerate();
    streams.map(|(k, stream)| of_stream(stream, &clock, if k == 0 { &bag.others } else { &[] })).collect()
}

fn of_stream(stream: &Stream, clock: &Clock, others: &[String]) -> RawLog {
    let names = std::iter::once("t".to_owned()).chain(stream.names.iter().cloned());
    let fields = (0..stream.names.len()).map(|i| stream.column(i));
    let columns = std::iter::once(stream.seconds(clock)).chain(fields);
    RawLog {
        topic: Some(stream.topic.clone()),
        names: names.collect(),
        columns: columns.collect(),
        others: others.to_vec(),
        ..RawLog::default()
    }
}

impl RawLog {
    /// Moves the columns that are mostly text to `others`.
    fn of_numbers(mut self) -> Self {
        let (mut names, mut columns) = (Vec::new(), Vec::new());
        let mut others = std::mem::take(&mut self.others);
        for (name, column) in
            std::mem::take(&mut self.names).into_iter().zip(std::mem::take(&mut self.columns))
        {
            let numbers = column.iter().filter(|x| x.is_finite()).count();
            if numbers as f64 >= NUMBERS * column.len() as f64 && !name.is_empty() {
                names.push(name);
                columns.push(column);
            } else {
                others.push(name);
            }
        }
        Self { names, columns, others, ..self }
    }
}
