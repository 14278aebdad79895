//! `[data]`: which logs, and how they are read.

use super::fields;
use crate::data::{self, Column, Columns, DataError, Dataset, Note, Reading, UNITS, unit};
use leastaction_core::forces::ControlKind;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt;
use std::path::{Path, PathBuf};

/// The log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataConfig {
    /// `.npz` or `.csv`, one or several; relative to the configuration file.
    pub file: LogFiles,
    /// The step (s) that all samples are resampled onto; else that of the files.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_limit")]
    pub step: Option<f64>,
    /// Only the first so many trajectories, at least 1.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "fields::some_positive")]
    pub trajectories: Option<usize>,
    /// Part of the trajectories held back from the end, in [0, 1).
    #[serde(default = "validation", deserialize_with = "fields::fraction")]
    pub validation: f64,
    /// What u does between samples; else what the log says, and held where it says nothing.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "fields::control_kind")]
    pub control: Option<ControlKind>,
    /// Names and units of the columns, where they are not q0, …, t.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub columns: Option<ColumnsConfig>,
}

fn validation() -> f64 {
    0.1
}

impl DataConfig {
    /// The defaults for a log.
    pub fn new(file: impl Into<LogFiles>) -> Self {
        Self {
            file: file.into(),
            step: None,
            trajectories: None,
            validation: validation(),
            control: None,
            columns: None,
        }
    }

    /// How the files are read.
    pub fn reading(&self) -> Reading {
        let columns = self.columns.as_ref().map(|columns| columns.columns.clone());
        Reading { columns, step: self.step, control: self.control }
    }

    /// This and, where other columns may be u, the same with each of those.
    pub fn alternatives(&self) -> Vec<Self> {
        let Some(ColumnsConfig { columns, other_u }) = &self.columns else { return vec![self.clone()] };
        let with = |u: &Vec<Column>| {
            let columns = Columns { u: u.clone(), ..columns.clone() };
            Self { columns: Some(ColumnsConfig { columns, other_u: Vec::new() }), ..self.clone() }
        };
        std::iter::once(&columns.u).chain(other_u).map(with).collect()
    }

    /// Reads the log; each note has its file.
    ///
    /// # Errors
    /// [`DataError`] with the file, the place in it and the problem.
    pub fn read(&self) -> Result<(Dataset, Vec<(PathBuf, Note)>), DataError> {
        data::read_logs(&data::files(&self.file.0)?, &self.reading())
    }
}

/// Files of logs, or patterns of their names with `*` and `?`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogFiles(
    /// As they are written.
    pub Vec<PathBuf>,
);

impl LogFiles {
    /// The same with every path changed.
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

/// A list that may be written as its only entry.
fn one_or_many<T: Serialize, S: Serializer>(all: &[T], to: S) -> Result<S::Ok, S::Error> {
    if let [one] = all {
        return one.serialize(to);
    }
    let mut list = to.serialize_seq(Some(all.len()))?;
    all.iter().try_for_each(|one| list.serialize_element(one))?;
    list.end()
}

/// Reads what [`one_or_many`] writes.
struct OneOrMany<T> {
    expected: &'static str,
    of: std::marker::PhantomData<T>,
}

impl<T> OneOrMany<T> {
    fn new(expected: &'static str) -> Self {
        Self { expected, of: std::marker::PhantomData }
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for OneOrMany<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Vec<T>, E> {
        T::deserialize(serde::de::value::StrDeserializer::new(text)).map(|one| vec![one])
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(|one| vec![one])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut all = Vec::new();
        while let Some(one) = list.next_element()? {
            all.push(one);
        }
        Ok(all)
    }
}

/// `[data.columns]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Named", into = "Named")]
pub struct ColumnsConfig {
    /// As the reader of logs takes them.
    pub columns: Columns,
    /// Columns that may be u in place of those: training finds out which of all predict best logs that it has not seen.
    pub other_u: Vec<Vec<Column>>,
}

/// The keys of `[data.columns]`.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Named {
    #[serde(default = "time")]
    t: ColumnConfig,
    q: ColumnList,
    #[serde(default, skip_serializing_if = "ColumnList::is_empty")]
    v: ColumnList,
    #[serde(default, skip_serializing_if = "ColumnList::is_empty")]
    u: ColumnList,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    other_u: Vec<ColumnList>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    actuation: Option<Vec<Vec<f64>>>,
}

fn time() -> ColumnConfig {
    ColumnConfig(Column::si("t"))
}

impl TryFrom<Named> for ColumnsConfig {
    type Error = String;

    fn try_from(named: Named) -> Result<Self, String> {
        let all = |list: ColumnList| list.0.into_iter().map(|column| column.0).collect();
        let Named { t, q, v, u, other_u, actuation } = named;
        let columns = Columns { t: t.0, q: all(q), v: all(v), u: all(u), actuation };
        columns.check()?;
        let other_u: Vec<Vec<Column>> = other_u.into_iter().map(all).collect();
        if other_u.iter().any(|other| other.len() != columns.u.len()) {
            return Err(format!("each of other_u needs {} columns, as many as u", columns.u.len()));
        }
        other_u.iter().try_for_each(|other| Columns { u: other.clone(), ..columns.clone() }.check())?;
        Ok(Self { columns, other_u })
    }
}

impl From<ColumnsConfig> for Named {
    fn from(ColumnsConfig { columns, other_u }: ColumnsConfig) -> Self {
        let all = |columns: Vec<Column>| ColumnList(columns.into_iter().map(ColumnConfig).collect());
        let Columns { t, q, v, u, actuation } = columns;
        let other_u = other_u.into_iter().map(all).collect();
        Self { t: ColumnConfig(t), q: all(q), v: all(v), u: all(u), other_u, actuation }
    }
}

/// Columns, or the only one.
#[derive(Clone, Default)]
struct ColumnList(Vec<ColumnConfig>);

impl ColumnList {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for ColumnList {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        one_or_many(&self.0, to)
    }
}

impl<'de> Deserialize<'de> for ColumnList {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(OneOrMany::new("the name of a column, or a list of them")).map(Self)
    }
}

/// A column by its name, or with its unit: `{ name = "enc", unit = "deg", sign = -1 }`.
#[derive(Clone)]
struct ColumnConfig(Column);

impl Serialize for ColumnConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Column { name, scale } = &self.0;
        if *scale == 1.0 { to.serialize_str(name) } else { Scaled { name, scale: *scale }.serialize(to) }
    }
}

#[derive(Serialize)]
struct Scaled<'a> {
    name: &'a str,
    scale: f64,
}

/// The keys of a column.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    name: String,
    unit: Option<String>,
    per_turn: Option<f64>,
    scale: Option<f64>,
    sign: Option<i8>,
}

impl Parts {
    fn column(self) -> Result<Column, String> {
        let scale = match (self.unit.as_deref(), self.per_turn, self.scale) {
            (None, None, scale) => scale.unwrap_or(1.0),
            (Some("counts"), Some(per_turn), None) => TAU / per_turn,
            (Some("counts"), None, None) => {
                return Err("counts need per_turn, the counts of one turn".to_owned());
            }
            (Some(name), None, None) => unit(name).ok_or_else(|| unknown(name))?,
            _ => return Err("a column has a unit or a scale; per_turn is of the unit counts".to_owned()),
        };
        let sign = match self.sign.unwrap_or(1) {
            sign @ (1 | -1) => f64::from(sign),
            other => return Err(format!("sign is {other}; it is 1 or -1")),
        };
        Ok(Column { name: self.name, scale: sign * scale })
    }
}

fn unknown(name: &str) -> String {
    let known: Vec<&str> = UNITS.iter().map(|(known, _)| *known).chain(["counts"]).collect();
    format!(
        "{name:?} is no unit that is known here; known are {}, or give scale, what one is in SI units",
        known.join(", ")
    )
}

impl<'de> Deserialize<'de> for ColumnConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ColumnVisitor)
    }
}

struct ColumnVisitor;

impl<'de> Visitor<'de> for ColumnVisitor {
    type Value = ColumnConfig;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a column, or a table with its name and unit")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<ColumnConfig, E> {
        Ok(ColumnConfig(Column::si(name)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColumnConfig, A::Error> {
        let parts = Parts::deserialize(MapAccessDeserializer::new(map))?;
        parts.column().map(ColumnConfig).map_err(Error::custom)
    }
}
