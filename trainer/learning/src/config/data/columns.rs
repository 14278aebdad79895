//! `[data.columns]`: names and units of columns.

use super::list::{OneOrMany, one_or_many};
use crate::data::{Column, Columns, UNITS, unit};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt;

/// `[data.columns]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Named", into = "Named")]
pub struct ColumnsConfig {
    /// Columns as the reader of logs takes them.
    pub columns: Columns,
    /// Alternatives for the u columns of `columns`: training chooses the one with the best predictions of held-back logs.
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

/// A list of columns; a single one needs no brackets.
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

/// A column given by its name alone, or with its unit: `{ name = "enc", unit = "deg", sign = -1 }`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnConfig(pub(super) Column);

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
