//! Columns of a log with names and units of their own.

use crate::Rows;
use crate::column_problem::ColumnProblem;
use crate::dataset::positive;
use crate::error::Fault;
use crate::join::Widths;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::Table;
use std::f64::consts::TAU;

/// A column of a log, with its conversion to SI units: value = scale × number + offset, plus multiples of other columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the header line of a `.csv` file, or `#2` for its second column; or the name of the array in an `.npz` or `.mat` file. `name[i]` is
    /// column i of a two-dimensional array; without an index the array gives all its columns. In a bag,
    /// `topic/joint/position`, `velocity` or `effort`; the time is `t`.
    pub name: String,
    /// Scale factor, finite and not 0; negative to reverse the sign.
    pub scale: f64,
    /// Value where all numbers are 0, in SI units.
    pub offset: f64,
    /// Other columns that are added, as for the joint of a differential drive.
    pub plus: Vec<Term>,
}

/// A multiple of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Name of the column, as in [`Column`].
    pub name: String,
    /// Factor, finite.
    pub scale: f64,
}

impl Column {
    /// A column in SI units.
    pub fn si(name: impl Into<String>) -> Self {
        Self::scaled(name, 1.0)
    }

    /// A column with the size of its unit in SI.
    pub fn scaled(name: impl Into<String>, scale: f64) -> Self {
        Self { name: name.into(), scale, offset: 0.0, plus: Vec::new() }
    }

    /// Names of all columns that the value is made of.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.name.as_str()).chain(self.plus.iter().map(|term| term.name.as_str()))
    }

    /// The value in SI units; a number of each of [`Column::names`].
    pub(crate) fn value(&self, numbers: impl IntoIterator<Item = f64>) -> f64 {
        let scales = std::iter::once(self.scale).chain(self.plus.iter().map(|term| term.scale));
        let sum = scales.zip(numbers).map(|(scale, number)| scale * number).reduce(|a, b| a + b);
        let sum = sum.unwrap_or_default();
        if self.offset == 0.0 { sum } else { sum + self.offset }
    }

    /// The column with other names; `None` if one of them has none.
    pub(crate) fn renamed(&self, name: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let term = |term: &Term| Some(Term { name: name(&term.name)?, scale: term.scale });
        let plus = self.plus.iter().map(term).collect::<Option<_>>()?;
        Some(Self { name: name(&self.name)?, plus, ..*self })
    }

    fn is_sound(&self) -> bool {
        let all_finite = self.offset.is_finite() && self.plus.iter().all(|term| term.scale.is_finite());
        self.scale.is_finite() && self.scale != 0.0 && all_finite
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
        if let Some(column) = all().find(|column| !column.is_sound()) {
            return Err(format!(
                "column {:?} is scaled by {}, which leaves nothing of it, or has a number that is not finite",
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
    /// The table with the step of a sampling rate (Hz), which a file without time needs.
    pub(crate) fn at_rate(self, rate: Option<f64>) -> Result<Self, Fault> {
        let Some(rate) = rate else { return Ok(self) };
        match (&self.t, &self.h) {
            (None, None) => Ok(Self { h: Some((1.0 / rate, Place::File)), ..self }),
            (t, _) => {
                let name = if t.is_some() { "t" } else { "h" };
                Err((Place::File, ColumnProblem::RateAndTime(name.to_owned()).into()))
            }
        }
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
