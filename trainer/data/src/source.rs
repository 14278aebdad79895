//! Files of all formats, as tables.

use crate::archive::Archive;
use crate::bag::{Bag, BagSource};
use crate::bag_problem::BagProblem;
use crate::column_problem::ColumnProblem;
use crate::columns::Columns;
use crate::error::Fault;
use crate::lerobot::{self, Lerobot};
use crate::mat::MatFile;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use crate::{array_columns, csv_columns, csv_file, join, npz};
use leastaction_core::forces::ControlKind;
use std::borrow::Cow;
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// The content of a file; bags are read piece by piece.
pub(crate) enum Source<'a> {
    Npz(Cow<'a, [u8]>),
    Csv(Cow<'a, [u8]>),
    Mat(Cow<'a, [u8]>),
    Bag(BagSource<'a>),
    Lerobot(Box<Lerobot>),
}

impl Source<'static> {
    pub(crate) fn open(path: &Path) -> Result<Self, Fault> {
        let whole = || fs::read(path).map(Cow::Owned).map_err(|error| (Place::File, error.into()));
        Ok(match format_of(path)? {
            Format::Npz => Self::Npz(whole()?),
            Format::Csv => Self::Csv(whole()?),
            Format::Mat => Self::Mat(whole()?),
            Format::Mcap => Self::Bag(BagSource::mcap(path)?),
            Format::Db3 => Self::Bag(BagSource::db3(path)?),
            Format::Folder => Self::Bag(BagSource::folder(path)?),
            Format::Lerobot => Self::Lerobot(Box::new(Lerobot::open(path)?)),
        })
    }
}

impl<'a> Source<'a> {
    pub(crate) fn of(format: Format, bytes: &'a [u8]) -> Self {
        match format {
            Format::Npz => Self::Npz(bytes.into()),
            Format::Csv => Self::Csv(bytes.into()),
            Format::Mat => Self::Mat(bytes.into()),
            Format::Mcap | Format::Folder | Format::Lerobot => Self::Bag(BagSource::Mcap(Box::new(bytes))),
            Format::Db3 => Self::Bag(BagSource::Db3(Box::new(Cursor::new(bytes)))),
        }
    }

    /// Reads the columns by the names of this layout; u is of the kind `control` if the file does not say.
    pub(crate) fn table(self, control: Option<ControlKind>) -> Result<(Table, Vec<Note>), Fault> {
        match self {
            Self::Npz(bytes) => npz::read(&bytes).map(|table| (table, Vec::new())),
            Self::Csv(bytes) => csv_file::read(&bytes, control),
            Self::Mat(bytes) => Ok((MatFile::read(&bytes)?.table()?, Vec::new())),
            Self::Bag(_) => Err((Place::File, BagProblem::Unnamed.into())),
            Self::Lerobot(set) => Err(set.unnamed()),
        }
    }

    /// Reads the columns named by `columns`, in SI units; samples at a `rate` (Hz) need no stamps.
    pub(crate) fn named(
        self,
        columns: &Columns,
        control: Option<ControlKind>,
        rate: Option<f64>,
    ) -> Result<(Table, Vec<Note>), Fault> {
        match self {
            Self::Npz(bytes) => array_columns::read(&Archive::open(&bytes)?, columns, rate),
            Self::Mat(bytes) => array_columns::read(&MatFile::read(&bytes)?, columns, rate),
            Self::Csv(bytes) => csv_columns::read(&bytes, columns, control, rate),
            Self::Lerobot(set) => set.table(columns, rate),
            Self::Bag(_) if rate.is_some() => {
                Err((Place::File, ColumnProblem::RateAndTime("t".to_owned()).into()))
            }
            Self::Bag(mut source) => {
                let mut bag = Bag::read(&mut source)?;
                let (columns, mut notes) = bag.without_dead_velocities(columns);
                let (parts, more) = bag.parts(&columns)?;
                notes.extend(more);
                let (table, more) = join::joined(parts, columns.widths(), control)?;
                notes.extend(more);
                Ok((table, notes))
            }
        }
    }
}

/// Format of a file, or a folder: of a bag, or of a data set of LeRobot.
#[derive(Clone, Copy)]
pub(crate) enum Format {
    Npz,
    Csv,
    Mat,
    Mcap,
    Db3,
    Folder,
    Lerobot,
}

/// Formats by extension.
const EXTENSIONS: [(&str, Format); 5] = [
    ("npz", Format::Npz),
    ("csv", Format::Csv),
    ("mat", Format::Mat),
    ("mcap", Format::Mcap),
    ("db3", Format::Db3),
];

/// The format given by the extension.
pub(crate) fn format_of(path: &Path) -> Result<Format, Fault> {
    let extension = path.extension().unwrap_or_default();
    match EXTENSIONS.into_iter().find(|(known, _)| extension.eq_ignore_ascii_case(known)) {
        _ if lerobot::is_at(path) => Ok(Format::Lerobot),
        _ if path.is_dir() => Ok(Format::Folder),
        Some((_, format)) => Ok(format),
        None => Err((Place::File, Problem::Extension)),
    }
}
