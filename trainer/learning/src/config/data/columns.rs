//! `[data.columns]`: names and units of columns.

use super::column::ColumnConfig;
use super::list::{OneOrMany, one_or_many};
use crate::data::{Column, Columns};
use serde::de::Deserializer;
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

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
    #[serde(default = "time", skip_serializing_if = "is_unnamed")]
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

fn is_unnamed(t: &ColumnConfig) -> bool {
    *t == time()
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
