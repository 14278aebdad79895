//! Columns in arrays with names of their own, of an NPZ archive or a MATLAB file.

use crate::Rows;
use crate::archive::Archive;
use crate::column_problem::ColumnProblem;
use crate::columns::{Column, Columns};
use crate::error::Fault;
use crate::layout_note::LayoutNote;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use std::collections::HashMap;

/// Arrays of numbers with names.
pub(crate) trait Named {
    /// The names of all arrays.
    fn names(&self) -> &[String];

    /// The array with this name, a row for every sample; `None` if there is none.
    fn rows(&self, name: &str) -> Result<Option<Rows>, Fault>;
}

impl Named for Archive<'_> {
    fn names(&self) -> &[String] {
        self.keys()
    }

    fn rows(&self, name: &str) -> Result<Option<Rows>, Fault> {
        let Some(array) = self.get(name)? else { return Ok(None) };
        let Some((_, width)) = array.samples_and_columns() else {
            return Err(array.wrong_shape("[samples] or [samples, columns]".to_owned()));
        };
        Ok(Rows::from_flat(width, array.reals()?))
    }
}

/// Reads the named columns; with a `rate` (Hz) there are no stamps.
pub(crate) fn read(
    arrays: &dyn Named,
    columns: &Columns,
    rate: Option<f64>,
) -> Result<(Table, Vec<Note>), Fault> {
    let mut arrays = Arrays { arrays, read: HashMap::new() };
    let t = arrays.time(&columns.t, rate)?;
    let q = arrays.rows(&columns.q, t.as_ref().map(Vec::len))?.ok_or((Place::File, Problem::Empty))?;
    let samples = Some(q.len());
    let (v, u) = (arrays.rows(&columns.v, samples)?, arrays.rows(&columns.u, samples)?);
    let (v, note) = living(v, &columns.v);
    let h = rate.map(|rate| (1.0 / rate, Place::File));
    let table = Table { q, v, a: None, u, t, h, trajectory: None, control: None, origin: Origin::rows() };
    Ok((table, note.into_iter().collect()))
}

/// Velocities, unless one of them has no number that is finite.
fn living(v: Option<Rows>, columns: &[Column]) -> (Option<Rows>, Option<Note>) {
    let dead = |rows: &Rows| (0..rows.width()).any(|i| rows.column(i).all(|x| !x.is_finite()));
    match v {
        Some(rows) if dead(&rows) => {
            let column = columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ");
            (None, Some(Note::Layout(LayoutNote::NoVelocity { column })))
        }
        v => (v, None),
    }
}

/// The arrays of a file, each unpacked at most once.
struct Arrays<'a> {
    arrays: &'a dyn Named,
    read: HashMap<String, Rows>,
}

impl Arrays<'_> {
    /// Stamps (s), unless the samples are at a `rate`.
    fn time(&mut self, t: &Column, rate: Option<f64>) -> Result<Option<Vec<f64>>, Fault> {
        let has_time = self.arrays.names().contains(&t.name);
        match rate {
            Some(_) if has_time => {
                return Err((Place::File, ColumnProblem::RateAndTime(t.name.clone()).into()));
            }
            Some(_) => return Ok(None),
            None if !has_time && *t == Column::si("t") => {
                return Err((
                    Place::File,
                    ColumnProblem::NoTime { known: self.arrays.names().to_vec() }.into(),
                ));
            }
            None => {}
        }
        match self.rows(std::slice::from_ref(t), None)?.filter(|t| t.width() == 1) {
            Some(t) => Ok(Some(t.as_flat().to_vec())),
            None => Err((Place::Key(t.name.clone()), Problem::MissingTime("one number a sample"))),
        }
    }

    /// Columns side by side, in SI units; `None` if `columns` is empty.
    fn rows(&mut self, columns: &[Column], samples: Option<usize>) -> Result<Option<Rows>, Fault> {
        let parts = columns.iter().map(|column| self.column(column)).collect::<Result<Vec<_>, _>>()?;
        let Some(first) = parts.first() else { return Ok(None) };
        let samples = samples.unwrap_or(first.len());
        if let Some((part, column)) = parts.iter().zip(columns).find(|(part, _)| part.len() != samples) {
            let (name, what) = ("the array", "samples");
            let problem = Problem::Inconsistent { name, what, found: part.len(), expected: samples };
            return Err((Place::Key(column.name.clone()), problem));
        }
        let width = parts.iter().map(Rows::width).sum();
        let row = |k: usize| parts.iter().filter_map(move |part| part.get(k)).flatten().copied();
        Ok(Rows::from_flat(width, (0..samples).flat_map(row).collect()))
    }

    /// A column, or a whole array, in SI units.
    fn column(&mut self, column: &Column) -> Result<Rows, Fault> {
        let parts = column.names().map(|name| self.numbers(name)).collect::<Result<Vec<_>, _>>()?;
        let [first, others @ ..] = &parts[..] else { return Err((Place::File, Problem::Empty)) };
        if let Some(other) =
            others.iter().find(|rows| (rows.len(), rows.width()) != (first.len(), first.width()))
        {
            let (found, expected) = (other.as_flat().len(), first.as_flat().len());
            let problem = Problem::Inconsistent { name: "a sum", what: "numbers", found, expected };
            return Err((Place::Key(column.name.clone()), problem));
        }
        let value = |i: usize| column.value(parts.iter().filter_map(|rows| rows.as_flat().get(i)).copied());
        let values = (0..first.as_flat().len()).map(value).collect();
        Rows::from_flat(first.width(), values).ok_or((Place::Key(column.name.clone()), Problem::Empty))
    }

    /// A column, or a whole array, as it is.
    fn numbers(&mut self, name: &str) -> Result<Rows, Fault> {
        let (key, index) = indexed(name);
        if !self.read.contains_key(key) {
            let rows = self.unpack(key, name)?;
            self.read.insert(key.to_owned(), rows);
        }
        let fault = |problem| (Place::Key(key.to_owned()), problem);
        let rows = self.read.get(key).ok_or_else(|| fault(Problem::Empty))?;
        match index {
            None => Ok(rows.clone()),
            Some(index) if index < rows.width() => {
                Rows::from_flat(1, rows.column(index).collect()).ok_or_else(|| fault(Problem::Empty))
            }
            Some(index) => Err(fault(ColumnProblem::NoIndex { index, found: rows.width() }.into())),
        }
    }

    fn unpack(&self, key: &str, name: &str) -> Result<Rows, Fault> {
        if !self.arrays.names().iter().any(|known| known == key) {
            let known = self.arrays.names().to_vec();
            return Err((Place::File, Problem::NoColumn { name: name.to_owned(), known }));
        }
        self.arrays.rows(key)?.ok_or((Place::Key(key.to_owned()), Problem::Empty))
    }
}

/// Splits `name[i]` into name and index.
fn indexed(name: &str) -> (&str, Option<usize>) {
    let inner = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    match inner.and_then(|(key, index)| Some((key, index.parse().ok()?))) {
        Some((key, index)) => (key, Some(index)),
        None => (name, None),
    }
}
