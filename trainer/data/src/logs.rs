//! Several files as one log, read as a configuration says.

use crate::columns::Columns;
use crate::error::{Fault, Place, Problem};
use crate::note::Note;
use crate::{DataError, Dataset, content, control_name, located, table};
use leastaction_core::forces::ControlKind;
use std::path::{Path, PathBuf};

/// How files become one log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Names and units of the columns, where they are not those of this layout.
    pub columns: Option<Columns>,
    /// The step (s) that all samples are resampled onto; else that of the files, or one near their median interval where it is uneven.
    pub step: Option<f64>,
    /// What u does between samples, where a file does not say it.
    pub control: Option<ControlKind>,
}

/// The files that patterns name, those of each in the order of their names: `*` and `?` stand for any characters, `**` for folders.
///
/// # Errors
/// [`DataError`] where a pattern is none, or no file is called so.
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
    // A file may be called as a pattern is.
    if pattern.exists() || !text.contains(['*', '?', '[']) {
        return Ok(vec![pattern.to_owned()]);
    }
    let paths = glob::glob(&text).map_err(|error| (Place::File, Problem::Pattern(error.to_string())))?;
    let found: Vec<PathBuf> =
        paths.collect::<Result<_, _>>().map_err(|error| (Place::File, Problem::Io(error.into())))?;
    if found.is_empty() { Err((Place::File, Problem::NoFile)) } else { Ok(found) }
}

/// Reads files as one log; their trajectories are numbered anew where there are several files. Each note has its file.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem; also where files differ in step or in coordinates.
pub fn read_logs(files: &[PathBuf], reading: &Reading) -> Result<(Dataset, Vec<(PathBuf, Note)>), DataError> {
    let mut all: Option<Dataset> = None;
    let mut notes = Vec::new();
    for file in files {
        let (mut log, said) = read_as(file, reading)?;
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

/// Refuses to join what does not belong together.
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

/// Reads one file.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem.
pub fn read_as(path: &Path, reading: &Reading) -> Result<(Dataset, Vec<Note>), DataError> {
    located(path, || {
        let (format, bytes) = content(path)?;
        let mut table = table(format, &bytes, reading.columns.as_ref())?;
        drop(bytes);
        // What a file says of itself goes before; that it contradicts the configuration is said by who knows both.
        table.control = table.control.or(reading.control);
        table.into_even(reading.step)
    })
}
