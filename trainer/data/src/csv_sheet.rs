//! Lines of a CSV file that are samples, and what else a logger writes between them: units, headers that come again,
//! separators after the last cell, a line that was cut off.

use crate::column_problem::ColumnProblem;
use crate::csv_text::{broken, is_number, is_of_numbers, reader, separated, text};
use crate::date;
use crate::error::Fault;
use crate::layout_note::LayoutNote;
use crate::place::Place;
use crate::problem::Problem;
use csv::{ByteRecord, Position};
use std::borrow::Cow;

/// The table in a CSV file.
pub(crate) struct Sheet<'a> {
    text: Cow<'a, [u8]>,
    separator: u8,
    /// Names of the columns: `#1`, `#2`, … without a header.
    pub names: Vec<String>,
    /// Whether the first line is a header; otherwise it has numbers only.
    pub headed: bool,
    /// Line of the header, or of the first sample.
    pub line: u64,
}

impl<'a> Sheet<'a> {
    /// Finds the separator, for which `known` recognises names, and the header.
    pub fn open(content: &'a [u8], known: impl Fn(&[u8]) -> bool) -> Result<Self, Fault> {
        let (text, separator) = separated(content, &known);
        let Some(first) = reader(&text, separator).byte_records().next() else {
            return Err((Place::File, Problem::Empty));
        };
        let first = first.map_err(broken)?;
        let headed = !is_of_numbers(&first) || first.iter().any(known);
        let name = |(i, cell): (usize, &[u8])| if headed { self::text(cell) } else { format!("#{}", i + 1) };
        let names = first.iter().enumerate().map(name).collect();
        Ok(Self { text, separator, names, headed, line: line_of(&first) })
    }

    /// Position of a column, by its name or as `#2` by its number from 1.
    pub fn position(&self, name: &str) -> Result<usize, Problem> {
        let mut found = self.names.iter().enumerate().filter(|(_, known)| *known == name);
        match (found.next(), found.next()) {
            (Some((position, _)), None) => Ok(position),
            (Some(_), Some(_)) => Err(Problem::Duplicate(format!("column {name}"))),
            (None, _) => self.numbered(name).ok_or_else(|| self.no_column(name)),
        }
    }

    fn numbered(&self, name: &str) -> Option<usize> {
        let position = name.strip_prefix('#')?.parse::<usize>().ok()?.checked_sub(1)?;
        (position < self.names.len()).then_some(position)
    }

    fn no_column(&self, name: &str) -> Problem {
        let (name, columns) = (name.to_owned(), self.names.len());
        if self.headed {
            Problem::NoColumn { name, known: self.names.clone() }
        } else {
            ColumnProblem::NoHeader { name, columns }.into()
        }
    }

    /// Hands over the samples one by one, with the number of headers before each that came again.
    pub fn samples(
        &self,
        mut take: impl FnMut(&ByteRecord, i64) -> Result<(), Fault>,
    ) -> Result<Vec<LayoutNote>, Fault> {
        let mut lines =
            Lines { sheet: self, count: 0, headers: Vec::new(), numeric: false, notes: Vec::new() };
        let mut reader = reader(&self.text, self.separator);
        let mut records = reader.byte_records().skip(usize::from(self.headed)).peekable();
        while let Some(record) = records.next() {
            let record = record.map_err(broken)?;
            if lines.is_sample(&record, records.peek().is_none())? {
                take(&record, lines.headers.len() as i64)?;
            }
        }
        Ok(lines.into_notes())
    }
}

/// Line of a record.
pub(crate) fn line_of(record: &ByteRecord) -> u64 {
    record.position().map_or(1, Position::line)
}

/// Samples and other lines so far.
struct Lines<'a> {
    sheet: &'a Sheet<'a>,
    /// Samples since the last header.
    count: usize,
    /// Lines of headers that came again.
    headers: Vec<u64>,
    /// Whether the last cell of the sample before is a number.
    numeric: bool,
    notes: Vec<LayoutNote>,
}

impl Lines<'_> {
    /// Whether a line is a sample; other lines are noted. An error if it has too few or too many cells.
    fn is_sample(&mut self, record: &ByteRecord, is_last: bool) -> Result<bool, Fault> {
        let line = line_of(record);
        if record.iter().all(<[u8]>::is_empty) {
            return Ok(false);
        }
        if self.is_header(record) {
            // Two headers in a row separate nothing.
            if self.count > 0 {
                self.headers.push(line);
                self.count = 0;
            }
            return Ok(false);
        }
        if self.count == 0 && self.sheet.headed && is_of_words(record) {
            let units = record.iter().map(text).collect::<Vec<_>>().join(", ");
            self.notes.push(LayoutNote::UnitsLine { line, units });
            return Ok(false);
        }
        if is_last && self.is_cut(record) {
            self.notes.push(LayoutNote::CutOff { line });
            return Ok(false);
        }
        self.check_length(record).map_err(|problem| (Place::Line(line), problem))?;
        self.count += 1;
        self.numeric = record.iter().next_back().is_some_and(is_number);
        Ok(true)
    }

    fn is_header(&self, record: &ByteRecord) -> bool {
        let names = self.sheet.names.iter().map(String::as_bytes);
        self.sheet.headed && record.iter().eq(names)
    }

    /// Whether the last line of the file ends too early, or within a number.
    fn is_cut(&self, record: &ByteRecord) -> bool {
        let last = record.iter().next_back().unwrap_or_default();
        let within =
            self.numeric && !last.is_empty() && !is_number(last) && !self.sheet.text.ends_with(b"\n");
        self.count > 0 && (record.len() < self.needed() || within)
    }

    /// Number of columns without those at the end that have no name.
    fn needed(&self) -> usize {
        let nameless = self.sheet.names.iter().rev().take_while(|name| name.is_empty()).count();
        self.sheet.names.len() - nameless
    }

    fn check_length(&self, record: &ByteRecord) -> Result<(), Problem> {
        let (found, expected) = (record.len(), self.sheet.names.len());
        let is_blank_beyond = record.iter().skip(expected).all(<[u8]>::is_empty);
        if found >= self.needed() && is_blank_beyond {
            Ok(())
        } else if expected > 1 && found == 2 * expected {
            Err(Problem::CommaSeparates { found, expected })
        } else {
            Err(Problem::CellCount { found, expected })
        }
    }

    fn into_notes(self) -> Vec<LayoutNote> {
        let mut notes = self.notes;
        if let Some(first) = self.headers.first() {
            notes.push(LayoutNote::HeaderAgain { line: *first, times: self.headers.len() });
        }
        notes
    }
}

/// Whether a line has words, and no number or date.
fn is_of_words(record: &ByteRecord) -> bool {
    record.iter().all(|cell| !is_number(cell) && date::seconds(&text(cell)).is_none())
}
