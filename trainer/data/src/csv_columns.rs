//! CSV files with columns named by a configuration.

use crate::column_problem::ColumnProblem;
use crate::columns::{Column, Columns};
use crate::csv_clocks::Clocks;
use crate::csv_file::{stated_control, stated_step};
use crate::csv_sheet::{Sheet, line_of};
use crate::csv_text::{Numbers, decoded, text};
use crate::error::Fault;
use crate::join::Widths;
use crate::layout_note::LayoutNote;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use crate::{Rows, date};
use csv::ByteRecord;
use leastaction_core::forces::ControlKind;

/// Reads the named columns in SI units; with a `rate` (Hz) there are no stamps.
pub(crate) fn read(
    bytes: &[u8],
    columns: &Columns,
    control: Option<ControlKind>,
    rate: Option<f64>,
) -> Result<(Table, Vec<Note>), Fault> {
    let content = decoded(bytes)?;
    let all = || std::iter::once(&columns.t).chain(columns.wanted()).flat_map(Column::names);
    let sheet = Sheet::open(&content, |cell| all().any(|name| name.as_bytes() == cell))?;
    let h = stated_step(&content)?;
    let is_stated = rate.is_some() || h.is_some();
    let picks = Picks::of(&sheet, columns, rate.is_some(), is_stated);
    let picks = picks.map_err(|problem| (Place::Line(sheet.line), problem))?;
    let mut cells = Cells::new(&picks, columns);
    let layout = sheet.samples(|record, part| cells.push(&picks, record, part))?;
    let mut notes: Vec<Note> = layout.into_iter().map(Note::Layout).collect();
    let stated = stated_control(&content)?;
    let h = rate.map(|rate| (1.0 / rate, Place::File)).or(h);
    let (table, more) = cells.into_table(h, stated, control)?;
    notes.extend(more);
    Ok((table, notes))
}

/// Positions of the cells of each column.
struct Picks<'a> {
    names: &'a [String],
    t: Option<Vec<usize>>,
    /// For each column of q, v and u.
    wanted: Vec<Vec<usize>>,
}

impl<'a> Picks<'a> {
    fn of(sheet: &'a Sheet<'_>, columns: &Columns, has_rate: bool, is_stated: bool) -> Result<Self, Problem> {
        let of =
            |column: &Column| column.names().map(|name| sheet.position(name)).collect::<Result<Vec<_>, _>>();
        let wanted = columns.wanted().map(of).collect::<Result<_, _>>()?;
        let is_default = columns.t == Column::si("t");
        let t = match of(&columns.t) {
            Ok(_) if has_rate => return Err(ColumnProblem::RateAndTime(columns.t.name.clone()).into()),
            Ok(t) => Some(t),
            Err(_) if is_default && is_stated => None,
            Err(_) if is_default => return Err(ColumnProblem::NoTime { known: sheet.names.clone() }.into()),
            Err(problem) => return Err(problem),
        };
        Ok(Self { names: &sheet.names, t, wanted })
    }

    fn place(&self, record: &ByteRecord, position: usize) -> Place {
        let column = self.names.get(position).cloned().unwrap_or_default();
        Place::Cell { line: line_of(record), column }
    }
}

/// Values of one column so far; NaN where a cell is blank or a number is not finite.
struct Values<'a> {
    column: &'a Column,
    values: Vec<f64>,
    /// The first number that is not finite.
    broken: Option<Fault>,
}

impl Values<'_> {
    fn is_dead(&self) -> bool {
        self.values.iter().all(|value| value.is_nan())
    }

    fn push(&mut self, number: Result<f64, Fault>) -> Result<(), Fault> {
        match number {
            Err(fault @ (_, Problem::NotFinite(_))) => {
                self.broken.get_or_insert(fault);
                self.values.push(f64::NAN);
            }
            number => self.values.push(number?),
        }
        Ok(())
    }

    /// Refuses numbers that are not finite, and a column without numbers.
    fn check(&mut self) -> Result<(), Fault> {
        match self.broken.take() {
            Some(fault) => Err(fault),
            None if self.is_dead() => {
                Err((Place::File, ColumnProblem::NoNumbers(self.column.name.clone()).into()))
            }
            None => Ok(()),
        }
    }
}

/// Cells read so far.
struct Cells<'a> {
    columns: &'a Columns,
    t: Option<Vec<f64>>,
    wanted: Vec<Values<'a>>,
    part: Vec<i64>,
    lines: Vec<u64>,
    numbers: Numbers,
}

impl<'a> Cells<'a> {
    fn new(picks: &Picks<'_>, columns: &'a Columns) -> Self {
        let wanted = columns.wanted().map(|column| Values { column, values: Vec::new(), broken: None });
        Self {
            columns,
            t: picks.t.as_ref().map(|_| Vec::new()),
            wanted: wanted.collect(),
            part: Vec::new(),
            lines: Vec::new(),
            numbers: Numbers::default(),
        }
    }

    fn push(&mut self, picks: &Picks<'_>, record: &ByteRecord, part: i64) -> Result<(), Fault> {
        let cell = |position: &usize| record.get(*position).unwrap_or_default();
        let mut number = |position: &usize| {
            let place = || picks.place(record, *position);
            self.numbers.read(text(cell(position)), place).map_err(|problem| (place(), problem))
        };
        let mut value = |column: &Column, positions: &[usize]| {
            let numbers = positions.iter().map(&mut number).collect::<Result<Vec<_>, _>>()?;
            Ok(column.value(numbers))
        };
        if let (Some(t), Some(positions)) = (&mut self.t, &picks.t) {
            let date = positions.first().and_then(|first| date::seconds(&text(cell(first))));
            t.push(date.map_or_else(|| value(&self.columns.t, positions), Ok)?);
        }
        for (values, positions) in self.wanted.iter_mut().zip(&picks.wanted) {
            let is_blank = positions.iter().any(|at| cell(at).is_empty());
            values.push(if is_blank { Ok(f64::NAN) } else { value(values.column, positions) })?;
        }
        self.part.push(part);
        self.lines.push(line_of(record));
        Ok(())
    }

    /// The table of all columns, which are joined if they have numbers in different rows.
    fn into_table(
        mut self,
        h: Option<(f64, Place)>,
        stated: Option<ControlKind>,
        control: Option<ControlKind>,
    ) -> Result<(Table, Vec<Note>), Fault> {
        std::mem::take(&mut self.numbers).check()?;
        if self.lines.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let (widths, mut notes) = self.leave_out_dead_velocities();
        self.wanted.iter_mut().try_for_each(Values::check)?;
        if self.wanted.iter().all(|values| values.values.iter().all(|value| !value.is_nan())) {
            return Ok((self.whole(widths, h, stated)?, notes));
        }
        let (table, more) = self.clocks(widths, h.map(|(h, _)| h), stated).joined(control)?;
        notes.extend(more);
        Ok((table, notes))
    }

    /// Leaves out velocities if one of them has no number, and says which.
    fn leave_out_dead_velocities(&mut self) -> (Widths, Vec<Note>) {
        let widths = self.columns.widths();
        let v = widths.q..widths.q + widths.v;
        let Some(dead) = self.wanted[v.clone()].iter().find(|values| values.is_dead()) else {
            return (widths, Vec::new());
        };
        let note = LayoutNote::NoVelocity { column: dead.column.name.clone() };
        self.wanted.drain(v);
        (Widths { v: 0, ..widths }, vec![Note::Layout(note)])
    }

    fn clocks(&self, widths: Widths, h: Option<f64>, stated: Option<ControlKind>) -> Clocks<'_> {
        let stamps = || (0..self.lines.len()).map(|row| h.unwrap_or_default() * row as f64).collect();
        Clocks {
            wanted: self.wanted.iter().map(|values| (values.column, &values.values[..])).collect(),
            widths,
            t: self.t.clone().unwrap_or_else(stamps),
            trajectory: &self.part,
            lines: &self.lines,
            stated,
        }
    }

    /// The table without blank cells.
    fn whole(
        self,
        widths: Widths,
        h: Option<(f64, Place)>,
        control: Option<ControlKind>,
    ) -> Result<Table, Fault> {
        let Widths { q, v, u } = widths;
        let rows = 0..self.lines.len();
        let field = |columns: std::ops::Range<usize>| {
            let width = columns.len();
            let row = |row: usize| self.wanted[columns.clone()].iter().map(move |values| values.values[row]);
            Rows::from_flat(width, rows.clone().flat_map(row).collect())
        };
        let fields = [field(0..q), field(q..q + v), field(q + v..q + v + u)];
        let [Some(q), v, u] = fields else { return Err((Place::File, Problem::Empty)) };
        let trajectory = self.part.last().is_some_and(|last| *last > 0).then_some(self.part);
        let origin = Origin::Lines(self.lines);
        Ok(Table { q, v, a: None, u, t: self.t, h, trajectory, control, origin })
    }
}
