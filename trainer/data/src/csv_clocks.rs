//! Columns of a CSV file with numbers in different rows, as in a table of several sensors: each set of rows is a clock,
//! and the clocks are joined.

use crate::Rows;
use crate::column_problem::ColumnProblem;
use crate::columns::Column;
use crate::error::Fault;
use crate::join::{Part, Wanted, Widths, joined};
use crate::layout_note::LayoutNote;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use leastaction_core::forces::ControlKind;
use std::ops::Range;

/// A column with its values in SI units, NaN where a cell is blank.
pub(crate) type Sparse<'a> = (&'a Column, &'a [f64]);

/// Columns with blank cells.
pub(crate) struct Clocks<'a> {
    /// Columns of q, v and u.
    pub wanted: Vec<Sparse<'a>>,
    pub widths: Widths,
    /// Stamp of every row, s.
    pub t: Vec<f64>,
    /// Trajectory of every row; one alone has none.
    pub trajectory: &'a [i64],
    /// Line of every row.
    pub lines: &'a [u64],
    /// Control kind that the file states.
    pub stated: Option<ControlKind>,
}

impl Clocks<'_> {
    /// The table with the stamps of the first coordinate, trajectory by trajectory; u is of the kind `control` if the
    /// file does not say.
    pub fn joined(&self, control: Option<ControlKind>) -> Result<(Table, Vec<Note>), Fault> {
        let (mut tables, mut start) = (Vec::new(), 0);
        let mut notes: Vec<Note> = self.wanted.iter().filter_map(|(of, values)| blanks(of, values)).collect();
        let mut missing = 0;
        for stretch in self.trajectory.chunk_by(|a, b| a == b) {
            let rows = start..start + stretch.len();
            start = rows.end;
            let (table, more) = self.of_trajectory(rows, control)?;
            missing += more.iter().filter_map(uncovered).sum::<usize>();
            notes.extend(more.into_iter().filter(|note| uncovered(note).is_none()));
            tables.push((stretch[0], table));
        }
        notes.extend((missing > 0).then_some(Note::Uncovered { samples: missing }));
        let is_one = matches!(&tables[..], [(0, _)]);
        let table = if is_one { tables.pop().map(|(_, table)| table) } else { stacked(&tables) };
        Ok((table.ok_or((Place::File, Problem::Empty))?, notes))
    }

    fn of_trajectory(
        &self,
        rows: Range<usize>,
        control: Option<ControlKind>,
    ) -> Result<(Table, Vec<Note>), Fault> {
        let of = Place::Line(self.lines[rows.start]);
        let is_dead = |(_, values): &&Sparse| values[rows.clone()].iter().all(|value| value.is_nan());
        if let Some((column, _)) = self.wanted.iter().find(is_dead) {
            return Err((of, ColumnProblem::NoNumbersFrom(column.name.clone()).into()));
        }
        let is_whole = rows.len() == self.lines.len();
        joined(self.parts(rows), self.widths, control)
            .map_err(|(place, problem)| (if place == Place::File && !is_whole { of } else { place }, problem))
    }

    /// Columns with numbers in the same rows, together; those of the first coordinate come first.
    fn parts(&self, rows: Range<usize>) -> Vec<Part> {
        let mut clocks: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
        for (index, (_, values)) in self.wanted.iter().enumerate() {
            let own: Vec<usize> = rows.clone().filter(|row| !values[*row].is_nan()).collect();
            match clocks.iter_mut().find(|(known, _)| *known == own) {
                Some((_, wanted)) => wanted.push(index),
                None => clocks.push((own, vec![index])),
            }
        }
        let lines = Origin::Lines(self.lines.to_vec());
        let part = |(rows, indices): (Vec<usize>, Vec<usize>)| {
            let row = |row: &usize| indices.iter().map(|i| self.wanted[*i].1[*row]).collect::<Vec<_>>();
            let values = Rows::from_rows(indices.len(), rows.iter().map(row))?;
            let wanted: Wanted = indices.iter().map(|i| (*i, self.wanted[*i].0.clone())).collect();
            let t = rows.iter().map(|row| self.t[*row]).collect();
            Some(Part { t, values, wanted, origin: lines.select(&rows), control: self.stated })
        };
        clocks.into_iter().filter_map(part).collect()
    }
}

/// A note on a column that is not in every row.
fn blanks(column: &Column, values: &[f64]) -> Option<Note> {
    let (numbers, rows) = (values.iter().filter(|value| !value.is_nan()).count(), values.len());
    let column = column.name.clone();
    (numbers < rows).then_some(Note::Layout(LayoutNote::Blanks { column, numbers, rows }))
}

fn uncovered(note: &Note) -> Option<usize> {
    match note {
        Note::Uncovered { samples } => Some(*samples),
        _ => None,
    }
}

/// Tables one below the other, each a trajectory with its id; `None` if a table lacks a field that the first has.
fn stacked(parts: &[(i64, Table)]) -> Option<Table> {
    let (_, first) = parts.first()?;
    let tables = || parts.iter().map(|(_, table)| table);
    let field = |of: fn(&Table) -> Option<&Rows>| {
        let rows = tables().map(of).collect::<Option<Vec<_>>>()?;
        let values = rows.iter().flat_map(|rows| rows.as_flat()).copied().collect();
        Rows::from_flat(rows.first()?.width(), values)
    };
    let ids = parts.iter().flat_map(|(id, table)| std::iter::repeat_n(*id, table.q.len()));
    let lines = tables().flat_map(|table| match &table.origin {
        Origin::Lines(lines) => &lines[..],
        _ => &[],
    });
    Some(Table {
        q: field(|table| Some(&table.q))?,
        v: field(|table| table.v.as_ref()),
        a: None,
        u: field(|table| table.u.as_ref()),
        t: tables().map(|table| table.t.as_deref()).collect::<Option<Vec<_>>>().map(|t| t.concat()),
        h: None,
        trajectory: Some(ids.collect()),
        control: first.control,
        origin: Origin::Lines(lines.copied().collect()),
    })
}
