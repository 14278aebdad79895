//! NPZ archives with array names of their own.

use crate::Rows;
use crate::archive::Archive;
use crate::columns::{Column, Columns};
use crate::error::Fault;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use std::collections::HashMap;

pub(crate) fn read(bytes: &[u8], columns: &Columns) -> Result<Table, Fault> {
    let archive = Archive::open(bytes)?;
    let mut arrays = Arrays { archive, read: HashMap::new() };
    let t = arrays.rows(std::slice::from_ref(&columns.t), None)?;
    let Some(t) = t.filter(|t| t.width() == 1) else {
        return Err((Place::Key(columns.t.name.clone()), Problem::MissingTime("one number a sample")));
    };
    let samples = Some(t.len());
    let q = arrays.rows(&columns.q, samples)?.ok_or((Place::File, Problem::Empty))?;
    let (v, u) = (arrays.rows(&columns.v, samples)?, arrays.rows(&columns.u, samples)?);
    let t = Some(t.as_flat().to_vec());
    Ok(Table { q, v, a: None, u, t, h: None, trajectory: None, control: None, origin: Origin::rows() })
}

/// The arrays of an archive, each unpacked at most once.
struct Arrays<'a> {
    archive: Archive<'a>,
    read: HashMap<String, Rows>,
}

impl Arrays<'_> {
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
        let (key, index) = indexed(&column.name);
        if !self.read.contains_key(key) {
            let rows = self.unpack(key, &column.name)?;
            self.read.insert(key.to_owned(), rows);
        }
        let fault = |problem| (Place::Key(key.to_owned()), problem);
        let rows = self.read.get(key).ok_or_else(|| fault(Problem::Empty))?;
        let scaled = |x: f64| x * column.scale;
        match index {
            None => Ok(rows.map(scaled)),
            Some(index) if index < rows.width() => {
                let one = rows.column(index).map(scaled).collect();
                Rows::from_flat(1, one).ok_or_else(|| fault(Problem::Empty))
            }
            Some(index) => Err(fault(Problem::NoIndex { index, found: rows.width() })),
        }
    }

    fn unpack(&self, key: &str, name: &str) -> Result<Rows, Fault> {
        let Some(array) = self.archive.get(key)? else {
            let known = self.archive.keys().to_vec();
            return Err((Place::File, Problem::NoColumn { name: name.to_owned(), known }));
        };
        let Some((_, width)) = array.samples_and_columns() else {
            return Err(array.wrong_shape("[samples] or [samples, columns]".to_owned()));
        };
        Rows::from_flat(width, array.reals()?).ok_or((Place::Key(key.to_owned()), Problem::Empty))
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
