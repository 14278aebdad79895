//! A column of a log, as a configuration names it.

use crate::data::{Column, Term, UNITS, unit};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::fmt;

/// A column given by its name or its number alone; with its unit, `{ name = "enc", unit = "deg", sign = -1, offset = 12.5 }`;
/// as a sum, `{ sum = [{ name = "m6", scale = 0.5 }, "m5"] }`; or a time in two columns, `{ sec = "sec", nanosec = "nsec" }`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnConfig(pub(super) Column);

impl Serialize for ColumnConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Column { name, scale, offset, plus } = &self.0;
        if *offset != 0.0 || !plus.is_empty() {
            let first = Scaled { name, scale: *scale };
            let others = plus.iter().map(|term| Scaled { name: &term.name, scale: term.scale });
            Sum { sum: std::iter::once(first).chain(others).collect(), offset: *offset }.serialize(to)
        } else if *scale == 1.0 {
            to.serialize_str(name)
        } else {
            Scaled { name, scale: *scale }.serialize(to)
        }
    }
}

#[derive(Serialize)]
struct Scaled<'a> {
    name: &'a str,
    scale: f64,
}

#[derive(Serialize)]
struct Sum<'a> {
    sum: Vec<Scaled<'a>>,
    offset: f64,
}

/// The keys of a column.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts {
    name: Option<Name>,
    unit: Option<String>,
    per_turn: Option<f64>,
    scale: Option<f64>,
    sign: Option<i8>,
    offset: Option<f64>,
    sum: Option<Vec<ColumnConfig>>,
    sec: Option<Name>,
    nanosec: Option<Name>,
}

/// A name, or the number of a column from 1.
#[derive(Deserialize)]
#[serde(untagged, expecting = "a column is named by text, or by its number from 1")]
enum Name {
    Text(String),
    Number(u32),
}

impl Name {
    fn text(self) -> String {
        match self {
            Self::Text(name) => name,
            Self::Number(number) => format!("#{number}"),
        }
    }
}

impl Parts {
    fn column(self) -> Result<Column, String> {
        let has_unit =
            self.unit.is_some() || self.per_turn.is_some() || self.scale.is_some() || self.sign.is_some();
        match self {
            Self { name: Some(_), sum: None, sec: None, nanosec: None, .. } => self.scaled(),
            Self { name: None, sum: Some(_), sec: None, nanosec: None, .. } if !has_unit => self.added(),
            Self { name: None, sum: None, sec: Some(sec), nanosec: Some(nanosec), offset: None, .. } if !has_unit => {
                let plus = vec![Term { name: nanosec.text(), scale: 1e-9 }];
                Ok(Column { plus, ..Column::si(sec.text()) })
            }
            _ => Err("a column has a name, with its unit, sign and offset; or a sum of columns, with an offset; or sec and nanosec".to_owned()),
        }
    }

    /// A column with its unit, in which the offset is given as well.
    fn scaled(self) -> Result<Column, String> {
        let scale = self.unit_in_si()?;
        let sign = match self.sign.unwrap_or(1) {
            sign @ (1 | -1) => f64::from(sign),
            other => return Err(format!("sign is {other}; it is 1 or -1")),
        };
        let name = self.name.map(Name::text).unwrap_or_default();
        Ok(Column { offset: scale * self.offset.unwrap_or(0.0), ..Column::scaled(name, sign * scale) })
    }

    fn unit_in_si(&self) -> Result<f64, String> {
        match (self.unit.as_deref(), self.per_turn, self.scale) {
            (None, None, scale) => Ok(scale.unwrap_or(1.0)),
            (Some("counts"), Some(per_turn), None) => Ok(TAU / per_turn),
            (Some("counts"), None, None) => Err("counts need per_turn, the counts of one turn".to_owned()),
            (Some(name), None, None) => unit(name).ok_or_else(|| unknown(name)),
            _ => Err("a column has a unit or a scale; per_turn is of the unit counts".to_owned()),
        }
    }

    /// A sum of columns, with an offset in SI units.
    fn added(self) -> Result<Column, String> {
        let mut columns = self.sum.into_iter().flatten().map(|column| column.0);
        let mut sum = columns.next().ok_or("a sum needs at least one column")?;
        for Column { name, scale, offset, plus } in columns {
            sum.plus.push(Term { name, scale });
            sum.plus.extend(plus);
            sum.offset += offset;
        }
        sum.offset += self.offset.unwrap_or(0.0);
        Ok(sum)
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
        f.write_str("the name of a column, its number from 1, or a table with its name and unit")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<ColumnConfig, E> {
        Ok(ColumnConfig(Column::si(name)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<ColumnConfig, E> {
        if number > 0 {
            Ok(ColumnConfig(Column::si(format!("#{number}"))))
        } else {
            Err(E::custom(format!("there is no column {number}; columns are counted from 1")))
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColumnConfig, A::Error> {
        let parts = Parts::deserialize(MapAccessDeserializer::new(map))?;
        parts.column().map(ColumnConfig).map_err(Error::custom)
    }
}
