//! The files of a bag: one, or all in a folder, in the order of time.

use super::container::{self, Visit};
use super::db3;
use super::gathered::is_of_joints;
use super::sqlite::Source as Database;
use crate::bag_problem::BagProblem;
use crate::error::Fault;
use crate::place::Place;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// A bag to be read.
pub(crate) enum BagSource<'a> {
    /// An `.mcap` file, read sequentially.
    Mcap(Box<dyn Read + 'a>),
    /// A `.db3` file.
    Db3(Box<dyn Database + 'a>),
    /// The files of a bag that was split while it was recorded.
    Folder(Vec<PathBuf>),
}

impl BagSource<'static> {
    /// Opens an `.mcap` file.
    pub fn mcap(path: &Path) -> Result<Self, Fault> {
        Ok(Self::Mcap(Box::new(BufReader::with_capacity(1 << 20, open(path)?))))
    }

    /// Opens a `.db3` file; refuses one to which a journal beside it belongs.
    pub fn db3(path: &Path) -> Result<Self, Fault> {
        for ending in ["-wal", "-journal"] {
            let beside: OsString = [path.as_os_str(), ending.as_ref()].into_iter().collect();
            if fs::metadata(&beside).is_ok_and(|file| file.len() > 0) {
                let name = Path::new(&beside).file_name().unwrap_or_default().to_string_lossy();
                return Err((Place::File, BagProblem::Unfinished(name.into_owned()).into()));
            }
        }
        Ok(Self::Db3(Box::new(open(path)?)))
    }

    /// Opens the files in the folder of a bag.
    pub fn folder(path: &Path) -> Result<Self, Fault> {
        let entries = fs::read_dir(path).map_err(|error| (Place::File, error.into()))?;
        let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        let packed = files.iter().find(|file| is_named(file, "zstd"));
        if let Some(name) = packed.and_then(|file| file.file_name()) {
            return Err((Place::File, BagProblem::PackedFile(name.to_string_lossy().into_owned()).into()));
        }
        files.retain(|file| is_named(file, "mcap") || is_named(file, "db3"));
        if files.is_empty() {
            return Err((Place::File, BagProblem::NoBag.into()));
        }
        if let Some(missing) = missing(path, &files) {
            return Err((Place::File, BagProblem::NoPart(missing).into()));
        }
        files.sort();
        files.sort_by_cached_key(|file| Self::file(file).ok().and_then(Self::first_time));
        Ok(Self::Folder(files))
    }

    fn file(path: &Path) -> Result<Self, Fault> {
        if is_named(path, "db3") { Self::db3(path) } else { Self::mcap(path) }
    }

    /// The time of recording of the first message, ns.
    fn first_time(self) -> Option<u64> {
        match self {
            Self::Mcap(mut file) => container::first_time(&mut file),
            Self::Db3(mut file) => db3::first_time(&mut file),
            Self::Folder(_) => None,
        }
    }
}

impl BagSource<'_> {
    /// Passes the messages to `visit`, numbered from `before` + 1 on; returns the number of the last.
    pub(super) fn messages(&mut self, before: u64, visit: Visit<'_>) -> Result<u64, Fault> {
        match self {
            Self::Mcap(file) => container::messages(file, before, visit),
            Self::Db3(file) => db3::messages(file, before, is_of_joints, visit),
            Self::Folder(files) => files.iter().try_fold(before, |number, file| {
                let read = BagSource::file(file).and_then(|mut source| source.messages(number, visit));
                read.map_err(|(place, problem)| (place.within(file), problem))
            }),
        }
    }
}

fn open(path: &Path) -> Result<File, Fault> {
    File::open(path).map_err(|error| (Place::File, error.into()))
}

fn is_named(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension))
}

/// A file that the folder's `metadata.yaml` lists under `relative_file_paths`, but that is not there.
fn missing(folder: &Path, files: &[PathBuf]) -> Option<String> {
    let text = fs::read_to_string(folder.join("metadata.yaml")).ok()?;
    let (_, list) = text.split_once("relative_file_paths:")?;
    let entries = list.lines().skip(1).map_while(|line| line.trim_start().strip_prefix("- "));
    let names = entries.map(|entry| entry.trim().trim_matches(['"', '\'']));
    let has = |name: &&str| files.iter().any(|file| file.file_name() == Path::new(name).file_name());
    names.into_iter().find(|name| !has(name)).map(str::to_owned)
}
