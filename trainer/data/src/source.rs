//! Files of all formats, as tables.

use crate::bag::Bag;
use crate::column_problem::ColumnProblem;
use crate::columns::Columns;
use crate::error::Fault;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use crate::{csv_columns, csv_file, join, npz, npz_columns};
use leastaction_core::forces::ControlKind;
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::Path;

/// The content of a file; an `.mcap` file is read sequentially.
pub(crate) enum Source<'a> {
    Npz(Cow<'a, [u8]>),
    Csv(Cow<'a, [u8]>),
    Mcap(Box<dyn Read + 'a>),
}

impl Source<'static> {
    pub(crate) fn open(path: &Path) -> Result<Self, Fault> {
        let fault = |error: std::io::Error| (Place::File, error.into());
        match format_of(path)? {
            Format::Npz => fs::read(path).map(|bytes| Self::Npz(bytes.into())).map_err(fault),
            Format::Csv => fs::read(path).map(|bytes| Self::Csv(bytes.into())).map_err(fault),
            Format::Mcap => {
                let file = File::open(path).map_err(fault)?;
                Ok(Self::Mcap(Box::new(BufReader::with_capacity(1 << 20, file))))
            }
        }
    }
}

impl<'a> Source<'a> {
    pub(crate) fn of(format: Format, bytes: &'a [u8]) -> Self {
        match format {
            Format::Npz => Self::Npz(bytes.into()),
            Format::Csv => Self::Csv(bytes.into()),
            Format::Mcap => Self::Mcap(Box::new(bytes)),
        }
    }

    /// Reads the columns by the names of this layout.
    pub(crate) fn table(self) -> Result<(Table, Vec<Note>), Fault> {
        match self {
            Self::Npz(bytes) => npz::read(&bytes).map(|table| (table, Vec::new())),
            Self::Csv(bytes) => csv_file::read(&bytes),
            Self::Mcap(_) => Err((Place::File, Problem::Unnamed)),
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
            Self::Npz(bytes) => npz_columns::read(&bytes, columns, rate),
            Self::Csv(bytes) => csv_columns::read(&bytes, columns, control, rate),
            Self::Mcap(_) if rate.is_some() => {
                Err((Place::File, ColumnProblem::RateAndTime("t".to_owned()).into()))
            }
            Self::Mcap(mut source) => {
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

/// Format of a file.
pub(crate) enum Format {
    Npz,
    Csv,
    Mcap,
}

/// The format given by the extension.
pub(crate) fn format_of(path: &Path) -> Result<Format, Fault> {
    let extension = path.extension().unwrap_or_default();
    if extension.eq_ignore_ascii_case("npz") {
        Ok(Format::Npz)
    } else if extension.eq_ignore_ascii_case("csv") {
        Ok(Format::Csv)
    } else if extension.eq_ignore_ascii_case("mcap") {
        Ok(Format::Mcap)
    } else {
        Err((Place::File, Problem::Extension))
    }
}
