//! The samples of a file at their own stamps, for callers with a resampling rule of their own.

use crate::columns::Columns;
use crate::error::Fault;
use crate::place::Place;
use crate::problem::Problem;
use crate::resample::Track;
use crate::source::Source;
use crate::table::Table;
use crate::{DataError, Rows, located};
use std::path::Path;

/// Logged data in SI units; stamps increase, and of samples with the same stamp the first is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Stamps (s).
    pub t: Vec<f64>,
    /// Positions, \[samples\]\[n\] (m, rad).
    pub q: Rows,
    /// Velocities (m/s, rad/s).
    pub v: Option<Rows>,
    /// Drive forces, one column per drive (N, N m).
    pub u: Option<Rows>,
}

impl Measured {
    /// Interpolates a field linearly at increasing times (s); constant before the first stamp and after the last.
    #[must_use]
    pub fn straight(&self, field: &Rows, at: &[f64]) -> Rows {
        if self.t.len() < 2 {
            return field.select(&vec![0; at.len()]);
        }
        let rows: Vec<usize> = (0..self.t.len()).collect();
        Track { t: &self.t, rows: &rows }.straight(field, at)
    }
}

/// Reads the columns of a file as they are: without resampling, splitting at gaps, or conversion to generalised forces.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem.
pub fn read_measured(path: &Path, columns: &Columns) -> Result<Measured, DataError> {
    located(path, || {
        let (table, _) = Source::open(path)?.named(columns, None, None)?;
        table.measured()
    })
}

impl Table {
    /// The first run of samples at its stamps.
    fn measured(self) -> Result<Measured, Fault> {
        self.check_finite()?;
        let run = self.runs()?.into_iter().next().ok_or((Place::File, Problem::Empty))?;
        let stamped = self.stamped(run)?.samples;
        let kept = |rows: &Rows| {
            let rows_kept = stamped.rows.iter().filter_map(|row| rows.get(*row));
            Rows::from_rows(rows.width(), rows_kept).unwrap_or_else(|| rows.slice(0..0))
        };
        let (q, v, u) = (kept(&self.q), self.v.as_ref().map(kept), self.u.as_ref().map(kept));
        Ok(Measured { t: stamped.t, q, v, u })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Column;

    fn columns() -> Columns {
        let si = |names: &[&str]| names.iter().map(|name| Column::si(*name)).collect::<Vec<_>>();
        let (q, v, u) = (si(&["a"]), Vec::new(), si(&["x", "y", "z"]));
        Columns { t: Column::scaled("ms", 1e-3), q, v, u, actuation: None }
    }

    fn read(text: &str) -> Result<Measured, DataError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("log.csv");
        std::fs::write(&file, text).unwrap();
        read_measured(&file, &columns())
    }

    #[test]
    fn samples_keep_their_stamps_and_repeated_ones_go() {
        let found = read("ms,a,x,y,z\n0,1,2,3,4\n2,5,6,7,8\n2,9,9,9,9\n900,1,1,2,3\n").unwrap();
        assert_eq!(found.t, [0.0, 2e-3, 0.9]);
        assert_eq!((found.q.as_flat(), found.v), (&[1.0, 5.0, 1.0][..], None));
        assert_eq!(found.u.unwrap().as_flat(), [2.0, 3.0, 4.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let error = |text: &str| read(text).unwrap_err().to_string();
        assert!(error("ms,a,x,y,z\n0,1,2,3,4\n1,1,2,3,4\n2,1,2,inf,4\n").contains("line 4, column "));
        assert!(error("ms,a,x,y,z\n0,1,2,3,4\n2,1,2,3,4\n1,1,2,3,4\n").contains("line 4, column t"));
        assert!(error("ms,a,x,y,z\n0,1,2,3,4\n1,1,2\n2,1,2,3,4\n").contains("line 3: 3 cells"));
    }
}
