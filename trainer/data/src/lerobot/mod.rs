//! Data sets of LeRobot of version 2.0, 2.1 and 3.0: folders whose `meta/info.json` describes Parquet files in `data`.
//!
//! A feature of numbers, such as `observation.state`, is an array with a row for every sample; an element of it is
//! `observation.state[0]`, or has its name, `observation.state.shoulder_pan.pos`. Stamps count from the start of their episode,
//! which is a trajectory.
//!
//! Source: huggingface/lerobot, `src/lerobot/datasets`.

#[cfg_attr(not(feature = "lerobot"), path = "no_column.rs")]
mod column;
mod files;
mod info;

use crate::Rows;
use crate::array_columns::{self, Named};
use crate::columns::{Column, Columns};
use crate::error::Fault;
use crate::lerobot_problem::LerobotProblem;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use info::{Feature, Info};
use std::fs;
use std::path::{Path, PathBuf};

/// Names of the stamps and of the number of the episode.
pub(crate) const TIME: &str = "timestamp";
const EPISODE: &str = "episode_index";

/// Deviation of a stamp from a multiple of the step, in steps, that rounding to single precision does not exceed within hours.
const ROUNDING: f64 = 0.01;

/// A data set, of which columns are read as they are asked for.
pub(crate) struct Lerobot {
    folder: PathBuf,
    info: Info,
    files: Vec<String>,
    names: Vec<String>,
}

/// Whether a folder is a data set of LeRobot.
pub(crate) fn is_at(folder: &Path) -> bool {
    described(folder).is_file()
}

fn described(folder: &Path) -> PathBuf {
    folder.join("meta").join("info.json")
}

impl Lerobot {
    /// Reads the description.
    pub fn open(folder: &Path) -> Result<Self, Fault> {
        let text = fs::read(described(folder)).map_err(|error| (Place::File, error.into()))?;
        let no = |problem: LerobotProblem| (Place::File, problem.into());
        let info = Info::parse(&text).map_err(no)?;
        let files = files::all(folder, &info).map_err(no)?;
        let of_elements = info.measured().flat_map(|(name, feature)| named(name, feature));
        let names = info.vectors().map(|(name, _)| name.clone()).chain(of_elements).collect();
        Ok(Self { folder: folder.to_owned(), info, files, names })
    }

    /// Reads the named columns of all episodes; with a `rate` (Hz) the stamps are passed over.
    pub fn table(&self, columns: &Columns, rate: Option<f64>) -> Result<(Table, Vec<Note>), Fault> {
        let (mut table, notes) = array_columns::read(self, &self.resolved(columns, rate), rate)?;
        table.trajectory = Some(self.episodes()?);
        if table.t.as_ref().is_some_and(|t| self.is_at_rate(t)) {
            table.h = Some((1.0 / self.info.fps, Place::Key("fps of meta/info.json".to_owned())));
        }
        Ok((table.of_one_length()?, notes))
    }

    /// The features that are measurements or commands, each with the names of its columns.
    pub fn elements(&self) -> Vec<(&String, Vec<String>)> {
        self.info.measured().map(|(name, feature)| (name, of_columns(name, feature))).collect()
    }

    /// Names of the features that are no vectors of numbers, as images.
    pub fn others(&self) -> Vec<String> {
        let is_other = |(_, feature): &(&String, &Feature)| feature.width().is_none();
        self.info.features.iter().filter(is_other).map(|(name, _)| name.clone()).collect()
    }

    /// The array of a feature that must be there.
    pub fn feature(&self, name: &str) -> Result<Rows, Fault> {
        let missing = || Problem::NoColumn { name: name.to_owned(), known: self.names.clone() };
        self.rows(name)?.ok_or_else(|| (Place::File, missing()))
    }

    /// The number of the episode of every sample.
    pub fn episodes(&self) -> Result<Vec<i64>, Fault> {
        let episodes = self.feature(EPISODE)?;
        let (found, expected) = (episodes.len(), self.info.total_frames);
        if found != expected {
            return Err((Place::File, LerobotProblem::Frames { found, expected }.into()));
        }
        Ok(episodes.as_flat().iter().map(|episode| *episode as i64).collect())
    }

    /// The refusal to read without named columns.
    pub fn unnamed(&self) -> Fault {
        (Place::File, LerobotProblem::Unnamed(self.names.clone()).into())
    }

    /// The columns with elements by their indices, and the stamps where no time is named.
    fn resolved(&self, columns: &Columns, rate: Option<f64>) -> Columns {
        let indexed = |column: &Column| {
            column.renamed(|name| Some(self.indexed(name))).unwrap_or_else(|| column.clone())
        };
        let all = |columns: &[Column]| columns.iter().map(indexed).collect();
        let is_unnamed = columns.t == Column::si("t") && rate.is_none();
        Columns {
            t: if is_unnamed { Column::si(TIME) } else { indexed(&columns.t) },
            q: all(&columns.q),
            v: all(&columns.v),
            u: all(&columns.u),
            actuation: columns.actuation.clone(),
        }
    }

    /// The name of an element by its index; any other name as it is.
    fn indexed(&self, name: &str) -> String {
        let at = |(feature, described): (&String, &Feature)| {
            let rest = name.strip_prefix(feature.as_str())?.strip_prefix('.')?;
            let index = described.elements().iter().position(|element| *element == rest)?;
            Some(format!("{feature}[{index}]"))
        };
        let is_feature = self.info.features.contains_key(name);
        let found = if is_feature { None } else { self.info.measured().find_map(at) };
        found.unwrap_or_else(|| name.to_owned())
    }

    /// Whether all stamps are those of the stated rate, so that the step is exactly its inverse.
    fn is_at_rate(&self, t: &[f64]) -> bool {
        let off = |t: &f64| (t * self.info.fps - (t * self.info.fps).round()).abs();
        t.iter().all(|t| off(t) <= ROUNDING)
    }
}

impl Named for Lerobot {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn rows(&self, name: &str) -> Result<Option<Rows>, Fault> {
        let Some(width) = self.info.features.get(name).and_then(Feature::width) else { return Ok(None) };
        let mut values = Vec::new();
        for file in &self.files {
            let more = column::read(&self.folder, file, (name, width));
            let more = more.map_err(|problem| (Place::File, problem.into()))?;
            values.extend(more);
        }
        Ok(Rows::from_flat(width, values))
    }
}

/// Names of the elements of a feature that have some.
fn named(name: &str, feature: &Feature) -> Vec<String> {
    feature.elements().iter().map(|element| format!("{name}.{element}")).collect()
}

/// Names of a feature's columns: by elements, else by indices, or that of the feature for a single number.
fn of_columns(name: &str, feature: &Feature) -> Vec<String> {
    match (named(name, feature), feature.width()) {
        (names, _) if !names.is_empty() => names,
        (_, None | Some(1)) => vec![name.to_owned()],
        (_, Some(width)) => (0..width).map(|i| format!("{name}[{i}]")).collect(),
    }
}
