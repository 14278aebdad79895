//! `[data]`: which logs, and how they are read.

mod column;
mod columns;
mod joints;
mod list;
mod recordings;

pub use columns::ColumnsConfig;
pub(super) use joints::OtherOrder;
pub use recordings::{JoinConfig, LeftOutConfig};

use super::fields;
use crate::data::{self, Column, Columns, DataError, Dataset, Note, Reading};
use leastaction_core::forces::ControlKind;
use list::{OneOrMany, one_or_many};
use serde::de::{Deserializer, Error};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// The `[data]` table: the logs and how to read them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataConfig {
    /// Log files, `.npz`, `.csv`, `.mat`, `.mcap` or `.db3`, or folders of bags or of data sets of LeRobot; relative to the configuration file.
    pub file: LogFiles,
    /// Step onto which all samples are resampled, s; by default the step of the files.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub step: Option<f64>,
    /// Sampling rate of logs without time, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub rate: Option<f64>,
    /// Number of trajectories to use, from the first on, at least 1; by default all.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_positive")]
    pub trajectories: Option<usize>,
    /// Fraction of the trajectories, taken from the end, that is held back for validation, in [0, 1).
    #[serde(default = "validation", deserialize_with = "fields::fraction")]
    pub validation: f64,
    /// Behaviour of u between samples; by default as the log states, or held if the log states nothing.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::control_kind")]
    pub control: Option<ControlKind>,
    /// Time intervals to leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub leave_out: Vec<LeftOutConfig>,
    /// Names and units of the columns, unless they are q0, …, t.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub columns: Option<ColumnsConfig>,
    /// Further files of each recording, keyed by the prefix of their column names (the text before the colon).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub join: BTreeMap<String, JoinConfig>,
}

fn validation() -> f64 {
    0.1
}

impl DataConfig {
    /// The defaults for the given log files.
    pub fn new(file: impl Into<LogFiles>) -> Self {
        Self {
            file: file.into(),
            step: None,
            rate: None,
            trajectories: None,
            validation: validation(),
            control: None,
            leave_out: Vec::new(),
            columns: None,
            join: BTreeMap::new(),
        }
    }

    /// Settings for the reader of logs.
    pub fn reading(&self) -> Reading {
        let columns = self.columns.as_ref().map(|columns| columns.columns.clone());
        let t = columns.as_ref().map_or_else(|| Column::si("t"), |columns| columns.t.clone());
        let joins = self.join.iter().map(|(name, join)| join.named(name, &t)).collect();
        let leave_out = self.leave_out.iter().map(|left| left.0.clone()).collect();
        Reading { columns, step: self.step, rate: self.rate, control: self.control, joins, leave_out }
    }

    /// An inconsistency, if any: files can only be joined through named columns, and a rate stands in place of stamps.
    pub(super) fn problem(&self) -> Option<String> {
        let unnamed = self.columns.is_none().then(|| self.join.keys().next()).flatten();
        if let Some(name) = unnamed {
            return Some(format!("columns of {name:?} need names: {name}:… under [data.columns]"));
        }
        let t = self.columns.as_ref().map(|columns| &columns.columns.t).filter(|t| **t != Column::si("t"));
        match (self.rate, t) {
            (Some(_), Some(t)) => Some(format!(
                "rate is for logs without time, but {:?} is named as time; leave one of them out",
                t.name
            )),
            (Some(_), None) if !self.join.is_empty() => {
                Some("files are joined by their stamps; rate is for logs without them".to_owned())
            }
            _ => None,
        }
    }

    /// This configuration, followed by a variant for each entry of `other_u`.
    pub fn alternatives(&self) -> Vec<Self> {
        let Some(ColumnsConfig { columns, other_u }) = &self.columns else { return vec![self.clone()] };
        let with = |u: &Vec<Column>| {
            let columns = Columns { u: u.clone(), ..columns.clone() };
            Self { columns: Some(ColumnsConfig { columns, other_u: Vec::new() }), ..self.clone() }
        };
        std::iter::once(&columns.u).chain(other_u).map(with).collect()
    }

    /// Checks that every interval to leave out names a file of these logs.
    ///
    /// # Errors
    /// [`DataError`] with the unknown file, or with a log file that does not exist.
    pub fn check_left_out(&self) -> Result<(), DataError> {
        self.reading().check_left_out(&data::files(&self.file.0)?)
    }

    /// Reads the logs; each note comes with its file.
    ///
    /// # Errors
    /// [`DataError`] with the file, the place in it and the problem.
    pub fn read(&self) -> Result<(Dataset, Vec<(PathBuf, Note)>), DataError> {
        data::read_logs(&data::files(&self.file.0)?, &self.reading())
    }
}

/// Log files, or patterns of file names with `*` and `?`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogFiles(
    /// Paths and patterns as written.
    pub Vec<PathBuf>,
);

impl LogFiles {
    /// Applies `f` to every path.
    #[must_use]
    pub fn map(&self, f: impl Fn(&Path) -> PathBuf) -> Self {
        Self(self.0.iter().map(|path| f(path)).collect())
    }
}

impl<P: Into<PathBuf>> From<P> for LogFiles {
    fn from(file: P) -> Self {
        Self(vec![file.into()])
    }
}

impl fmt::Display for LogFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<String> = self.0.iter().map(|file| file.display().to_string()).collect();
        f.write_str(&names.join(", "))
    }
}

impl Serialize for LogFiles {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        one_or_many(&self.0, to)
    }
}

impl<'de> Deserialize<'de> for LogFiles {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let files: Vec<PathBuf> =
            from.deserialize_any(OneOrMany::new("the name of a file, or a list of them"))?;
        if files.is_empty() { Err(Error::custom("name at least one file")) } else { Ok(Self(files)) }
    }
}
