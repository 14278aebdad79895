//! Columns of a log under names and in units of its own.

use crate::error::{Fault, Problem};
use crate::join::Widths;
use crate::place::Place;
use crate::table::Table;
use crate::{Rows, positive};
use std::f64::consts::TAU;

/// One column of a log, and what makes its numbers SI: value = scale × number.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name in the header line of a `.csv` file, or the array of an `.npz` file; `name[i]` is column i of a two-dimensional
    /// array, which without an index gives all of them. Of an `.mcap` file `topic/joint/position`, `velocity` or `effort`; time is `t`.
    pub name: String,
    /// Finite and not 0; below 0 where the sign is to change.
    pub scale: f64,
}

impl Column {
    /// A column in SI units.
    pub fn si(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: 1.0 }
    }
}

/// Which columns of a log are t, q, v and u. All others are ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Time, to s.
    pub t: Column,
    /// Generalised coordinates, to m or rad.
    pub q: Vec<Column>,
    /// Velocities, to m/s or rad/s; none where it is empty.
    pub v: Vec<Column>,
    /// Forces of the drives, to N or N m; none where it is empty.
    pub u: Vec<Column>,
    /// B of B u, the generalised force: a row for every coordinate, in it an entry for every drive. Without it drive i acts on coordinate
    /// i.
    pub actuation: Option<Vec<Vec<f64>>>,
}

/// Units of columns, with what one of them is in SI.
pub const UNITS: [(&str, f64); 14] = [
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
    ("rad", 1.0),
    ("deg", TAU / 360.0),
    ("rev", TAU),
    ("m", 1.0),
    ("mm", 1e-3),
    ("rad/s", 1.0),
    ("deg/s", TAU / 360.0),
    ("rpm", TAU / 60.0),
    ("N", 1.0),
    ("Nm", 1.0),
];

/// What one of a unit is in SI; `None` for an unknown one.
#[must_use]
pub fn unit(name: &str) -> Option<f64> {
    UNITS.into_iter().find(|(known, _)| *known == name).map(|(_, scale)| scale)
}

impl Columns {
    /// All but time: q, v, u.
    pub(crate) fn wanted(&self) -> impl Iterator<Item = &Column> {
        self.q.iter().chain(&self.v).chain(&self.u)
    }

    pub(crate) fn widths(&self) -> Widths {
        Widths { q: self.q.len(), v: self.v.len(), u: self.u.len() }
    }

    /// Refuses what cannot be, before any file is opened.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self) -> Result<(), String> {
        let (n, drives) = (self.q.len(), self.u.len());
        if n == 0 {
            return Err("q needs at least one column".to_owned());
        }
        let all = || std::iter::once(&self.t).chain(&self.q).chain(&self.v).chain(&self.u);
        if let Some(column) = all().find(|column| !(column.scale.is_finite() && column.scale != 0.0)) {
            return Err(format!(
                "column {:?} is scaled by {}, which leaves nothing of it",
                column.name, column.scale
            ));
        }
        positive(self.t.scale).map_err(|_| "time cannot be turned around".to_owned())?;
        match &self.actuation {
            Some(_) if drives == 0 => {
                Err("actuation says where drives act, but u names no column".to_owned())
            }
            Some(rows) if rows.iter().flatten().any(|entry| !entry.is_finite()) => {
                Err("actuation has an entry that is not finite".to_owned())
            }
            _ => Ok(()),
        }
    }
}

impl Table {
    /// The same in SI units, where every name is that of one column.
    pub(crate) fn scaled(self, columns: &Columns) -> Self {
        let t = self.t.map(|t| t.into_iter().map(|t| t * columns.t.scale).collect());
        let q = scaled(&self.q, &columns.q);
        let v = self.v.map(|v| scaled(&v, &columns.v));
        let u = self.u.map(|u| scaled(&u, &columns.u));
        Self { t, q, v, u, ..self }
    }

    /// The same with u as generalised forces.
    pub(crate) fn driven(self, actuation: Option<&[Vec<f64>]>) -> Result<Self, Fault> {
        let n = self.q.width();
        if let Some(v) = self.v.as_ref().filter(|v| v.width() != n) {
            return Err(inconsistent("v", v.width(), n));
        }
        let u = self.u.map(|u| acting(u, actuation, n)).transpose()?;
        Ok(Self { u, ..self })
    }
}

fn inconsistent(name: &'static str, found: usize, expected: usize) -> Fault {
    (Place::File, Problem::Inconsistent { name, what: "columns", found, expected })
}

/// Every column by its own scale.
fn scaled(rows: &Rows, columns: &[Column]) -> Rows {
    let mut scales = columns.iter().map(|column| column.scale).cycle();
    rows.map(|x| x * scales.next().unwrap_or(1.0))
}

/// B u, or u itself where B is not given.
fn acting(u: Rows, actuation: Option<&[Vec<f64>]>, n: usize) -> Result<Rows, Fault> {
    let Some(actuation) = actuation else {
        return if u.width() == n { Ok(u) } else { Err(inconsistent("u", u.width(), n)) };
    };
    if actuation.len() != n {
        return Err((
            Place::File,
            Problem::Inconsistent { name: "actuation", what: "rows", found: actuation.len(), expected: n },
        ));
    }
    if let Some(row) = actuation.iter().find(|row| row.len() != u.width()) {
        return Err(inconsistent("actuation", row.len(), u.width()));
    }
    let dot = |row: &[f64], u: &[f64]| row.iter().zip(u).map(|(b, u)| b * u).sum::<f64>();
    let force = |u: &[f64]| actuation.iter().map(|row| dot(row, u)).collect::<Vec<_>>();
    Rows::from_rows(n, u.iter().map(force)).ok_or_else(|| inconsistent("u", u.width(), n))
}
