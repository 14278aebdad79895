//! CSV files with columns named as in this layout: one header line, then one line per sample.

use std::collections::HashSet;
use std::fmt::Write;
use std::ops::Range;

use csv::ByteRecord;

use crate::archive::whole;
use crate::column_problem::ColumnProblem;
use crate::columns::Column;
use crate::csv_clocks::Clocks;
use crate::csv_sheet::{Sheet, line_of};
use crate::csv_text::{Numbers, decoded, text};
use crate::error::Fault;
use crate::join::Widths;
use crate::note::Note;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use crate::{Dataset, Rows, Trajectory, control_name, control_of_name, date};
use leastaction_core::forces::ControlKind;

const KNOWN: &str = "q0…, v0…, a0…, u0…, t, trajectory";

/// Names of the fields, in the order of [`Header::fields`].
const FIELDS: [&str; 4] = ["q", "v", "a", "u"];

/// Reads the table of a file whose columns are named as in this layout; u is of the kind `control` if the file does not
/// say.
pub(crate) fn read(bytes: &[u8], control: Option<ControlKind>) -> Result<(Table, Vec<Note>), Fault> {
    let content = decoded(bytes)?;
    let sheet = Sheet::open(&content, is_known)?;
    let columns = Header::parse(&sheet).map_err(|problem| (Place::Line(sheet.line), problem))?;
    let mut cells = Cells::default();
    let layout = sheet.samples(|record, part| cells.push(&columns, record, part))?;
    let mut notes: Vec<Note> = layout.into_iter().map(Note::Layout).collect();
    let (h, stated) = (stated_step(&content)?, stated_control(&content)?);
    std::mem::take(&mut cells.numbers).check()?;
    if cells.has_blanks() {
        let (table, more) = cells.joined(&columns, h, (stated, control))?;
        notes.extend(more);
        return Ok((table, notes));
    }
    Ok((Table { control: stated, ..cells.into_table(&columns, h)? }, notes))
}

/// The value of a comment `# h = …` before the header line.
pub(crate) fn stated_step(text: &[u8]) -> Result<Option<(f64, Place)>, Fault> {
    let Some((value, place)) = stated(text, "h") else { return Ok(None) };
    match value.parse() {
        Ok(h) => Ok(Some((h, place))),
        Err(_) => Err((place, Problem::NotNumber(value))),
    }
}

/// The value of a comment `# control = …` before the header line.
pub(crate) fn stated_control(text: &[u8]) -> Result<Option<ControlKind>, Fault> {
    let Some((value, place)) = stated(text, "control") else { return Ok(None) };
    control_of_name(value.trim_matches('"')).map(Some).ok_or((place, Problem::Control(value)))
}

/// The value and place of the first comment `# name = …` before the header line.
fn stated(text: &[u8], name: &str) -> Option<(String, Place)> {
    let lines = (1..).zip(text.split(|&byte| byte == b'\n'));
    let comments = lines.take_while(|(_, text)| text.starts_with(b"#") || text.trim_ascii().is_empty());
    comments.into_iter().find_map(|(line, text)| {
        let text = String::from_utf8_lossy(text);
        let (key, value) = text.trim_start_matches('#').split_once('=')?;
        (key.trim() == name).then(|| (value.trim().to_owned(), Place::Line(line)))
    })
}

/// Positions of the quantities in a line.
struct Header {
    names: Vec<String>,
    /// Positions of coordinates 0 to n − 1, for q, v, a and u; empty if the field is missing.
    fields: [Vec<usize>; 4],
    t: Option<usize>,
    trajectory: Option<usize>,
}

impl Header {
    fn parse(sheet: &Sheet<'_>) -> Result<Self, Problem> {
        if sheet.headed {
            Self::from_names(sheet.names.clone())
        } else {
            let (name, columns) = ("q".to_owned(), sheet.names.len());
            Err(ColumnProblem::NoHeader { name, columns }.into())
        }
    }

    fn from_names(names: Vec<String>) -> Result<Self, Problem> {
        refuse_duplicates(&names)?;
        let n = names.iter().filter(|name| is_field(name, "q")).count();
        if n == 0 {
            return Err(Problem::MissingPositions("column q0"));
        }
        let mut fields = FIELDS.map(|_| Vec::new());
        for (field, positions) in FIELDS.into_iter().zip(&mut fields) {
            *positions = field_columns(&names, field, n)?;
        }
        let (t, trajectory) = (position(&names, "t"), position(&names, "trajectory"));
        let columns = Self { names, fields, t, trajectory };
        columns.refuse_others()?;
        Ok(columns)
    }

    fn refuse_others(&self) -> Result<(), Problem> {
        let used: Vec<_> =
            self.fields.iter().flatten().copied().chain(self.t).chain(self.trajectory).collect();
        match (0..).zip(&self.names).find(|(i, name)| !used.contains(i) && !is_ignored(name)) {
            Some((_, name)) => Err(Problem::UnknownName { name: name.clone(), known: KNOWN }),
            None => Ok(()),
        }
    }

    fn name(&self, position: usize) -> String {
        self.names.get(position).cloned().unwrap_or_default()
    }
}

/// Whether `name` is the field's letter, alone or followed by a number.
fn is_field(name: &str, field: &str) -> bool {
    name.strip_prefix(field).is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// Whether this layout has a column of this name.
fn is_known(name: &[u8]) -> bool {
    let name = text(name);
    let field = FIELDS.into_iter().any(|field| is_field(&name, field));
    field || name == "t" || name == "trajectory" || name.starts_with('_')
}

/// Whether a column is not read: its name begins with `_`, or it has none.
fn is_ignored(name: &str) -> bool {
    name.is_empty() || name.starts_with('_')
}

/// Refuses duplicate columns, except those that begin with `_`.
fn refuse_duplicates(names: &[String]) -> Result<(), Problem> {
    let mut seen = HashSet::new();
    let named = names.iter().filter(|name| !is_ignored(name));
    match named.into_iter().find(|name| !seen.insert(*name)) {
        Some(name) => Err(Problem::Duplicate(format!("column {name}"))),
        None => Ok(()),
    }
}

/// The positions of `field`0 to `field`{n−1}; empty if there are none.
fn field_columns(names: &[String], field: &'static str, n: usize) -> Result<Vec<usize>, Problem> {
    let given = names.iter().filter(|name| is_field(name, field)).count();
    if given == 0 {
        return Ok(Vec::new());
    }
    if n == 1
        && given == 1
        && let Some(position) = position(names, field)
    {
        return Ok(vec![position]);
    }
    let one = |i: usize| {
        let column = format!("{field}{i}");
        position(names, &column).ok_or(Problem::MissingColumn { column, field, n })
    };
    (0..n).map(one).collect()
}

/// The position of the column with this name.
fn position(names: &[String], name: &str) -> Option<usize> {
    names.iter().position(|other| other == name)
}

/// The samples read so far.
#[derive(Default)]
struct Cells {
    fields: [Vec<f64>; 4],
    t: Vec<f64>,
    trajectory: Vec<i64>,
    lines: Vec<u64>,
    numbers: Numbers,
}

impl Cells {
    /// Adds a sample, with NaN for blank cells; `part` is its trajectory unless a column says which.
    fn push(&mut self, columns: &Header, record: &ByteRecord, part: i64) -> Result<(), Fault> {
        let line = line_of(record);
        let place = |position: usize| Place::Cell { line, column: columns.name(position) };
        let mut real = |position: usize| {
            let cell = text(record.get(position).unwrap_or_default());
            self.numbers.read(cell, || place(position)).map_err(|problem| (place(position), problem))
        };
        for (values, positions) in self.fields.iter_mut().zip(&columns.fields) {
            for &position in positions {
                let is_blank = record.get(position).is_some_and(<[u8]>::is_empty);
                values.push(if is_blank { f64::NAN } else { real(position)? });
            }
        }
        if let Some(position) = columns.t {
            self.t.push(match date::seconds(&text(record.get(position).unwrap_or_default())) {
                Some(seconds) => seconds,
                None => real(position)?,
            });
        }
        self.trajectory.push(match columns.trajectory {
            Some(position) => integer(record, position).map_err(|problem| (place(position), problem))?,
            None => part,
        });
        self.lines.push(line);
        Ok(())
    }

    fn has_blanks(&self) -> bool {
        self.fields.iter().flatten().any(|value| value.is_nan())
    }

    /// The table of columns with numbers in different rows.
    fn joined(
        &self,
        columns: &Header,
        h: Option<(f64, Place)>,
        (stated, control): (Option<ControlKind>, Option<ControlKind>),
    ) -> Result<(Table, Vec<Note>), Fault> {
        let sparse = self.sparse(columns);
        let [q, v, a, u] = columns.fields.each_ref().map(Vec::len);
        let clocks = Clocks {
            wanted: sparse.iter().map(|(column, values)| (column, &values[..])).collect(),
            // Accelerations are interpolated as velocities are.
            widths: Widths { q, v: v + a, u },
            t: self.stamps(columns, h)?,
            trajectory: &self.trajectory,
            lines: &self.lines,
            stated,
        };
        let (table, notes) = clocks.joined(control)?;
        let part = |of: Range<usize>| {
            let rows = table.v.as_ref().filter(|_| !of.is_empty())?;
            Rows::from_rows(of.len(), rows.iter().map(|row| &row[of.clone()]))
        };
        let (v, a) = (part(0..v), part(v..v + a));
        Ok((Table { v, a, ..table }, notes))
    }

    /// Stamp of every row, s.
    fn stamps(&self, columns: &Header, h: Option<(f64, Place)>) -> Result<Vec<f64>, Fault> {
        match (columns.t, h) {
            (Some(_), _) => Ok(self.t.clone()),
            (None, Some((h, _))) => Ok((0..self.lines.len()).map(|row| h * row as f64).collect()),
            (None, None) => Err((Place::File, Problem::MissingTime("a comment line # h = 0.05"))),
        }
    }

    /// Every column of a field, with its values.
    fn sparse(&self, columns: &Header) -> Vec<(Column, Vec<f64>)> {
        let of_field = |(values, positions): (&Vec<f64>, &Vec<usize>)| -> Vec<(Column, Vec<f64>)> {
            let column = |i: usize| values.iter().skip(i).step_by(positions.len()).copied().collect();
            let name = |position: &usize| Column::si(columns.name(*position));
            positions.iter().enumerate().map(|(i, position)| (name(position), column(i))).collect()
        };
        self.fields.iter().zip(&columns.fields).flat_map(of_field).collect()
    }

    fn into_table(self, columns: &Header, h: Option<(f64, Place)>) -> Result<Table, Fault> {
        let widths = columns.fields.iter().map(Vec::len);
        let mut fields =
            self.fields.into_iter().zip(widths).map(|(values, width)| Rows::from_flat(width, values));
        let [q, v, a, u] = std::array::from_fn(|_| fields.next().flatten());
        let given = |rows: Option<Rows>| rows.filter(|rows| !rows.is_empty());
        let is_parted = columns.trajectory.is_some() || self.trajectory.last().is_some_and(|last| *last > 0);
        Ok(Table {
            q: q.ok_or((Place::File, Problem::Empty))?,
            v: given(v),
            a: given(a),
            u: given(u),
            t: columns.t.map(|_| self.t),
            h,
            trajectory: is_parted.then_some(self.trajectory),
            control: None,
            origin: Origin::Lines(self.lines),
        })
    }
}

fn integer(record: &ByteRecord, position: usize) -> Result<i64, Problem> {
    let cell = text(record.get(position).unwrap_or_default());
    // Programs that write all columns alike write 1 as 1.0 or 1e+00.
    let whole_number = || cell.parse().ok().and_then(|x: f64| whole(x).ok());
    cell.parse().ok().or_else(whole_number).ok_or(Problem::NotInteger(cell))
}

pub(crate) fn write(dataset: &Dataset) -> Result<Vec<u8>, Fault> {
    let control =
        dataset.control.map_or(String::new(), |kind| format!("# control = {}\n", control_name(kind)));
    let mut out = format!("# h = {:?}\n{control}trajectory,t", dataset.h);
    let given = dataset.trajectories.first().map(Trajectory::fields).unwrap_or_default();
    for (name, _) in given.into_iter().filter(|(_, rows)| rows.is_some()) {
        (0..dataset.n).for_each(|i| push(&mut out, format_args!(",{name}{i}")));
    }
    out.push('\n');
    for trajectory in &dataset.trajectories {
        for (k, t) in dataset.times(trajectory).enumerate() {
            push(&mut out, format_args!("{},{t:?}", trajectory.id));
            let rows = trajectory.fields().into_iter().filter_map(|(_, rows)| rows?.get(k));
            rows.flatten().for_each(|x| push(&mut out, format_args!(",{x:?}")));
            out.push('\n');
        }
    }
    Ok(out.into_bytes())
}

/// Appends text; `{:?}` prints the fewest digits that restore the same bits.
fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string does not fail.
    let _ = out.write_fmt(text);
}
