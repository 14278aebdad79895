//! Reading of several files as one log, according to a configuration.

use crate::columns::{Column, Columns};
use crate::error::Fault;
use crate::join::{Part, Wanted, joined};
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::source::Source;
use crate::table::Table;
use crate::{DataError, Dataset, control_name, located};
use leastaction_core::forces::ControlKind;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Number of files that are read side by side; each may take much memory until its columns are known.
const AT_ONCE: usize = 4;

/// Settings for reading files as one log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Names and units of the columns, if they differ from this layout.
    pub columns: Option<Columns>,
    /// Step (s) onto which all samples are resampled. By default it is the step of the files or, if their stamps are
    /// uneven, a step near their mean interval.
    pub step: Option<f64>,
    /// Sampling rate (Hz) of files that have named columns but no time.
    pub rate: Option<f64>,
    /// Control kind for files that do not state it.
    pub control: Option<ControlKind>,
    /// Further files of each recording; they need named columns.
    pub joins: Vec<Join>,
    /// Time intervals that are left out, like gaps.
    pub leave_out: Vec<LeftOut>,
}

/// A time interval that is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// End of the path of the file that it applies to; `None`: all files.
    pub file: Option<PathBuf>,
    /// First stamp that is left out (s).
    pub from: f64,
    /// Last stamp that is left out (s); it may be infinite.
    pub to: f64,
}

impl Reading {
    /// Refuses intervals for a file that is not among `files`.
    ///
    /// # Errors
    /// [`Problem::NoSuchLog`].
    pub fn check_left_out(&self, files: &[PathBuf]) -> Result<(), DataError> {
        let is_there = |file: &&PathBuf| files.iter().any(|path| path.ends_with(file));
        match self.leave_out.iter().filter_map(|left| left.file.as_ref()).find(|file| !is_there(file)) {
            Some(file) => Err(DataError {
                file: file.clone(),
                place: Place::File,
                problem: Problem::NoSuchLog(files.len()),
            }),
            None => Ok(()),
        }
    }

    /// The intervals that are left out of a file (s).
    fn left_out(&self, path: &Path) -> Vec<(f64, f64)> {
        let of_file = |left: &&LeftOut| left.file.as_ref().is_none_or(|file| path.ends_with(file));
        self.leave_out.iter().filter(of_file).map(|left| (left.from, left.to)).collect()
    }
}

/// Another file of the same recording; its columns are named with a prefix, as in `torque:tau1`.
#[derive(Clone, Debug, PartialEq)]
pub struct Join {
    /// Prefix of its columns.
    pub name: String,
    /// Text whose last occurrence in the path of the coordinates' file is replaced.
    pub replace: String,
    /// Replacement that gives the path of this file.
    pub by: String,
    /// Time column, of the same clock, scaled to s.
    pub t: Column,
}

impl Join {
    /// The path of the file that belongs to the coordinates' file at `path`.
    fn partner(&self, path: &Path) -> Result<PathBuf, Fault> {
        let text = path.to_string_lossy();
        let no = || Problem::NoPartner { part: self.replace.clone(), name: self.name.clone() };
        let at = text.rfind(&self.replace).filter(|_| !self.replace.is_empty());
        let at = at.ok_or_else(|| (Place::File, no()))?;
        let mut partner = text.to_string();
        partner.replace_range(at..at + self.replace.len(), &self.by);
        Ok(PathBuf::from(partner))
    }

    /// The column's name within this file; `None` if the column belongs to another file.
    fn strip<'n>(&self, name: &'n str) -> Option<&'n str> {
        name.strip_prefix(&self.name)?.strip_prefix(':')
    }
}

/// The files that match the patterns, in the order of the patterns and, for one pattern, of the file names: `*` and `?`
/// stand for any characters, `**` for folders.
///
/// # Errors
/// [`DataError`] if a pattern is invalid or matches no file.
pub fn files(patterns: &[PathBuf]) -> Result<Vec<PathBuf>, DataError> {
    let mut all = Vec::new();
    for pattern in patterns {
        let found = located(pattern, || matching(pattern))?;
        all.extend(found);
    }
    Ok(all)
}

fn matching(pattern: &Path) -> Result<Vec<PathBuf>, Fault> {
    let text = pattern.to_string_lossy();
    // A file name may look like a pattern.
    if pattern.exists() || !text.contains(['*', '?', '[']) {
        return Ok(vec![pattern.to_owned()]);
    }
    let paths = glob::glob(&text).map_err(|error| (Place::File, Problem::Pattern(error.to_string())))?;
    let found: Vec<PathBuf> =
        paths.collect::<Result<_, _>>().map_err(|error| (Place::File, Problem::Io(error.into())))?;
    if found.is_empty() { Err((Place::File, Problem::NoFile)) } else { Ok(found) }
}

/// Reads files as one log; if there are several, their trajectories are renumbered. Each note comes with its file.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem; also if files differ in step, coordinates or control.
pub fn read_logs(files: &[PathBuf], reading: &Reading) -> Result<(Dataset, Vec<(PathBuf, Note)>), DataError> {
    let mut all: Option<Dataset> = None;
    let mut notes = Vec::new();
    let read = |files: &[PathBuf]| files.par_iter().map(|file| read_as(file, reading)).collect::<Vec<_>>();
    for (file, read) in files.chunks(AT_ONCE).flat_map(|files| files.iter().zip(read(files))) {
        let (mut log, said) = read?;
        notes.extend(said.into_iter().map(|note| (file.clone(), note)));
        let Some(all) = &mut all else {
            all = Some(log);
            continue;
        };
        located(file, || alike(all, &log, files.first().map_or(Path::new(""), PathBuf::as_path)))?;
        all.trajectories.append(&mut log.trajectories);
    }
    let nothing = || DataError { file: PathBuf::new(), place: Place::File, problem: Problem::NoFile };
    let mut all = all.ok_or_else(nothing)?;
    if files.len() > 1 {
        (0..).zip(&mut all.trajectories).for_each(|(id, trajectory)| trajectory.id = id);
        located(&files[0], || all.fields_everywhere())?;
    }
    Ok((all, notes))
}

/// Refuses to combine logs that do not match.
fn alike(all: &Dataset, log: &Dataset, first: &Path) -> Result<(), Fault> {
    let first = first.to_owned();
    let problem = if all.n != log.n {
        Problem::OtherCoordinates { found: log.n, expected: all.n, first }
    } else if all.h != log.h {
        Problem::OtherStep { found: log.h, expected: all.h, first }
    } else if all.control != log.control {
        let [found, expected] = [log, all].map(|log| log.control.map_or("not stated", control_name));
        Problem::OtherControl { found, expected, first }
    } else {
        return Ok(());
    };
    Err((Place::File, problem))
}

/// Reads a file and the files that are joined to it.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem.
pub fn read_as(path: &Path, reading: &Reading) -> Result<(Dataset, Vec<Note>), DataError> {
    match &reading.columns {
        Some(columns) if !reading.joins.is_empty() => {
            let (table, notes) = joined_files(path, columns, reading)?;
            located(path, || finished(table, notes, reading, path))
        }
        _ => located(path, || even(Source::open(path)?, reading, path)),
    }
}

/// The log of a single file.
pub(crate) fn even(
    source: Source<'_>,
    reading: &Reading,
    path: &Path,
) -> Result<(Dataset, Vec<Note>), Fault> {
    let (table, notes) = match &reading.columns {
        Some(columns) => source.named(columns, reading.control, reading.rate)?,
        None => {
            let (table, notes) = source.table(reading.control)?;
            (table.at_rate(reading.rate)?, notes)
        }
    };
    finished(table, notes, reading, path)
}

/// The log of a table.
fn finished(
    table: Table,
    mut notes: Vec<Note>,
    reading: &Reading,
    path: &Path,
) -> Result<(Dataset, Vec<Note>), Fault> {
    let mut table = match &reading.columns {
        Some(columns) => table.driven(columns.actuation.as_deref())?,
        None => table,
    };
    // The file's own statement takes precedence. The caller, which knows both statements, reports a contradiction.
    table.control = table.control.or(reading.control);
    let left_out = reading.left_out(path);
    if !left_out.is_empty() {
        let (rest, more) = table.without(&left_out)?;
        table = rest;
        notes.extend(more);
    }
    let (log, more) = table.into_even(reading.step)?;
    notes.extend(more);
    Ok((log, notes))
}

/// Joins the files of one recording into one table.
fn joined_files(path: &Path, columns: &Columns, reading: &Reading) -> Result<(Table, Vec<Note>), DataError> {
    let joins = &reading.joins;
    let (mut of_path, mut of_joins): (Wanted, Vec<Wanted>) = (Vec::new(), vec![Vec::new(); joins.len()]);
    for (index, column) in columns.wanted().enumerate() {
        let found = joins.iter().zip(&mut of_joins).find_map(|(join, wanted)| {
            Some((column.renamed(|name| join.strip(name).map(str::to_owned))?, wanted))
        });
        match found {
            Some((column, wanted)) => wanted.push((index, column)),
            None => of_path.push((index, column.clone())),
        }
    }
    let mut notes = Vec::new();
    let mut parts = Vec::new();
    let mut read = |file: &Path, t: &Column, wanted: Wanted| {
        if !wanted.is_empty() {
            let (part, said) = located(file, || part(file, t, wanted, reading.control))?;
            parts.push(part);
            notes.extend(said);
        }
        Ok(())
    };
    read(path, &columns.t, of_path)?;
    for (join, wanted) in joins.iter().zip(of_joins) {
        read(&located(path, || join.partner(path))?, &join.t, wanted)?;
    }
    // The first coordinate gives the clock.
    parts.sort_by_key(|part| part.wanted.first().map_or(usize::MAX, |(index, _)| *index));
    let (table, more) = located(path, || joined(parts, columns.widths(), reading.control))?;
    notes.extend(more);
    Ok((table, notes))
}

/// The wanted columns of one file.
fn part(
    file: &Path,
    t: &Column,
    wanted: Wanted,
    control: Option<ControlKind>,
) -> Result<(Part, Vec<Note>), Fault> {
    let q: Vec<Column> = wanted.iter().map(|(_, column)| column.clone()).collect();
    let columns = Columns { t: t.clone(), q, v: Vec::new(), u: Vec::new(), actuation: None };
    let (table, notes) = Source::open(file)?.named(&columns, control, None)?;
    table.check_finite()?;
    let Table { q: values, t, origin, control, .. } = table;
    if values.width() != wanted.len() {
        let (name, what) = ("an array that is joined", "columns; name them one by one, as name[0],");
        let problem = Problem::Inconsistent { name, what, found: values.width(), expected: wanted.len() };
        return Err((Place::File, problem));
    }
    let t = t.unwrap_or_default();
    Ok((Part { t, values, wanted, origin, control }, notes))
}
