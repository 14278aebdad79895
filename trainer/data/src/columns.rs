//! Columns of a log with names and units of their own.

use crate::Rows;
use crate::dataset::positive;
use crate::error::Fault;
use crate::join::Widths;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use std::f64::consts::TAU;

/// A column of a log, with its conversion to SI units: value = scale × number.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the header line of a `.csv` file, or of the array in an `.npz` file. `name[i]` is column i of a
    /// two-dimensional array; without an index the array gives all its columns. In an `.mcap` file,
    /// `topic/joint/position`, `velocity` or `effort`; the time is `t`.
    pub name: String,
    /// Scale factor, finite and not 0; negative to reverse the sign.
    pub scale: f64,
}

impl Column {
    /// A column in SI units.
    pub fn si(name: impl Into<String>) -> Self {
        Self { name: name.into(), scale: 1.0 }
    }
}

/// The columns of a log that are t, q, v and u. All other columns are ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Columns {
    /// Time, scaled to s.
    pub t: Column,
    /// Generalised coordinates, scaled to m or rad.
    pub q: Vec<Column>,
    /// Velocities, scaled to m/s or rad/s; may be empty.
    pub v: Vec<Column>,
    /// Drive forces, scaled to N or N m; may be empty.
    pub u: Vec<Column>,
    /// Actuation matrix B of the generalised force B u, with a row per coordinate and an entry per drive. Without B,
    /// drive i acts on coordinate i.
    pub actuation: Option<Vec<Vec<f64>>>,
}

/// Units of columns, with their size in SI.
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

/// Size of a unit in SI; `None` for an unknown unit.
#[must_use]
pub fn unit(name: &str) -> Option<f64> {
    UNITS.into_iter().find(|(known, _)| *known == name).map(|(_, scale)| scale)
}

impl Columns {
    /// The columns of q, v and u.
    pub(crate) fn wanted(&self) -> impl Iterator<Item = &Column> {
        self.q.iter().chain(&self.v).chain(&self.u)
    }

    pub(crate) fn widths(&self) -> Widths {
        Widths { q: self.q.len(), v: self.v.len(), u: self.u.len() }
    }

    /// Checks the columns for contradictions, before any file is opened.
    ///
    /// # Errors
    /// A description of the problem.
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
    /// Converts to SI units; here every name stands for one column.
    pub(crate) fn scaled(self, columns: &Columns) -> Self {
        let t = self.t.map(|t| t.into_iter().map(|t| t * columns.t.scale).collect());
        let q = scaled(&self.q, &columns.q);
        let v = self.v.map(|v| scaled(&v, &columns.v));
        let u = self.u.map(|u| scaled(&u, &columns.u));
        Self { t, q, v, u, ..self }
    }

    /// Replaces u by generalised forces.
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

/// Multiplies every column by its own scale.
fn scaled(rows: &Rows, columns: &[Column]) -> Rows {
    let mut scales = columns.iter().map(|column| column.scale).cycle();
    rows.map(|x| x * scales.next().unwrap_or(1.0))
}

/// B u, or u itself if B is not given.
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
