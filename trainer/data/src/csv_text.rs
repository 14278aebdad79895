//! The text of a CSV file: its encoding, its separator, and the notation of its numbers.

use std::borrow::Cow;

use csv::{ByteRecord, Error, Reader, ReaderBuilder, Trim};

use crate::error::Fault;
use crate::place::Place;
use crate::problem::Problem;

/// Possible separators; if several fit equally well, the last of these is taken.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// Decodes a file to UTF-8 without a byte order mark. UTF-16, which some spreadsheets write, is recognised by its mark.
pub(crate) fn decoded(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Fault> {
    let text = match bytes {
        [0xEF, 0xBB, 0xBF, text @ ..] => Cow::Borrowed(text),
        [0xFF, 0xFE, text @ ..] => Cow::Owned(from_utf16(text, u16::from_le_bytes)?),
        [0xFE, 0xFF, text @ ..] => Cow::Owned(from_utf16(text, u16::from_be_bytes)?),
        text => Cow::Borrowed(text),
    };
    if text.contains(&0) { Err(not_text("it contains bytes that are zero")) } else { Ok(with_header(text)) }
}

/// The text with its header as a line of cells where that is a comment, as `numpy.savetxt` writes it: the last comment above a line of
/// numbers, with as many names, of which none is a number.
fn with_header(text: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    let lines = text.split_inclusive(|byte| *byte == b'\n');
    let above: Vec<&[u8]> = lines.take_while(|line| line.starts_with(b"#")).collect();
    let (start, rest) = text.split_at(above.iter().map(|line| line.len()).sum());
    let samples = rest.split(|byte| *byte == b'\n').next().unwrap_or_default();
    match above.last() {
        Some(header) if names_columns(header, samples) => {
            let mut headed = [start, rest].concat();
            headed[start.len() - header.len()] = b' ';
            Cow::Owned(headed)
        }
        _ => text,
    }
}

/// Whether a comment has a name for every number of a line.
fn names_columns(comment: &[u8], samples: &[u8]) -> bool {
    let is_separator = |byte: &u8| b",;\t ".contains(byte) || byte.is_ascii_whitespace();
    let cells = |line: &'_ [u8]| -> Vec<Vec<u8>> {
        line.split(is_separator).filter(|cell| !cell.is_empty()).map(<[u8]>::to_vec).collect()
    };
    let (names, numbers) = (cells(comment.get(1..).unwrap_or_default()), cells(samples));
    let are_numbers = !numbers.is_empty() && numbers.iter().all(|cell| is_number(cell));
    let are_names = names.iter().all(|cell| !is_number(cell) && !cell.contains(&b'='));
    are_numbers && are_names && names.len() == numbers.len()
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Vec<u8>, Fault> {
    let (pairs, rest) = bytes.as_chunks();
    let text: Result<String, _> = char::decode_utf16(pairs.iter().map(|pair| unit(*pair))).collect();
    match text {
        Ok(text) if rest.is_empty() => Ok(text.into_bytes()),
        _ => Err(not_text("it begins as UTF-16 but does not go on so")),
    }
}

fn not_text(reason: &'static str) -> Fault {
    (Place::File, Problem::NotText(reason))
}

/// Reads the lines that are not comments as cells.
pub(crate) fn reader(text: &[u8], separator: u8) -> Reader<&[u8]> {
    ReaderBuilder::new()
        .delimiter(separator)
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .from_reader(text)
}

/// The text with its separator. Blanks, one or several in a row, are separators where nothing else can be; each row of
/// them is then replaced by a tab.
pub(crate) fn separated<'a>(text: &'a [u8], known: impl Fn(&[u8]) -> bool) -> (Cow<'a, [u8]>, u8) {
    if is_spaced(text) {
        (Cow::Owned(tabbed(text)), b'\t')
    } else {
        (Cow::Borrowed(text), separator(text, known))
    }
}

/// The separator with which the most cells of the first line are `known` names, or all of its cells are numbers.
fn separator(text: &[u8], known: impl Fn(&[u8]) -> bool) -> u8 {
    let fit = |separator: &u8| {
        let first: Option<Result<ByteRecord, Error>> = reader(text, *separator).byte_records().next();
        let Some(Ok(first)) = first else { return (0, 0) };
        let names = first.iter().filter(|cell| known(cell)).count();
        (names, if is_of_numbers(&first) { first.len() } else { 0 })
    };
    SEPARATORS.into_iter().max_by_key(fit).unwrap_or(b',')
}

/// Whether a line has numbers and, apart from them, only blank cells.
pub(crate) fn is_of_numbers(record: &ByteRecord) -> bool {
    let mut filled = record.iter().filter(|cell| !cell.is_empty()).peekable();
    filled.peek().is_some() && filled.all(is_number)
}

/// Whether a cell has a number, with a decimal point or a decimal comma.
pub(crate) fn is_number(cell: &[u8]) -> bool {
    let comma = cell.contains(&b',') && !cell.ends_with(b",");
    let number = std::str::from_utf8(cell)
        .map(|cell| if comma { cell.replacen(',', ".", 1) } else { cell.to_owned() });
    number.is_ok_and(|cell| cell.parse::<f64>().is_ok())
}

/// Whether the first two lines have the same number of words, and neither commas, semicolons nor tabs alone separate
/// them.
fn is_spaced(text: &[u8]) -> bool {
    let is_row = |line: &&[u8]| !line.starts_with(b"#") && !line.trim_ascii().is_empty();
    let mut lines = text.split(|byte| *byte == b'\n').filter(is_row);
    let (Some(first), Some(second)) = (lines.next(), lines.next()) else { return false };
    let words = words(first).count();
    let others = first.iter().any(|byte| b",;\"".contains(byte)) && !self::words(first).all(is_number);
    let cells = |line: &[u8]| line.trim_ascii().split(|byte| *byte == b'\t').count();
    let has_blanks = second.trim_ascii().contains(&b' ') || cells(first) != cells(second);
    words > 1 && words == self::words(second).count() && !others && has_blanks
}

fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Replaces the blanks between the words of each line by single tabs; comments stay.
fn tabbed(text: &[u8]) -> Vec<u8> {
    let line = |line: &[u8]| {
        if line.starts_with(b"#") { line.to_vec() } else { words(line).collect::<Vec<_>>().join(&b'\t') }
    };
    text.split(|byte| *byte == b'\n').map(line).collect::<Vec<_>>().join(&b'\n')
}

/// Parser of numbers with decimal points or decimal commas, as long as the file is unambiguous.
#[derive(Default)]
pub(crate) struct Numbers {
    /// Whether a number had a point.
    points: bool,
    /// The first number with a comma, and its place.
    comma: Option<(Place, String)>,
    /// Whether a number had a comma that cannot separate thousands.
    decimal: bool,
}

impl Numbers {
    /// Reads the finite number in a cell.
    pub(crate) fn read(&mut self, cell: String, place: impl Fn() -> Place) -> Result<f64, Problem> {
        self.points |= cell.contains('.');
        let value = match cell.split_once(',') {
            None => cell.parse(),
            Some((whole, rest)) => {
                self.decimal |= !may_be_thousands(whole, rest);
                self.comma.get_or_insert_with(|| (place(), cell.clone()));
                format!("{whole}.{rest}").parse()
            }
        };
        match value {
            Ok(value) if f64::is_finite(value) => Ok(value),
            Ok(value) => Err(Problem::NotFinite(value)),
            Err(_) => Err(Problem::NotNumber(cell)),
        }
    }

    /// Refuses commas that could separate thousands.
    pub(crate) fn check(self) -> Result<(), Fault> {
        match self.comma {
            Some((place, cell)) if self.points || !self.decimal => Err((place, Problem::Comma(cell))),
            _ => Ok(()),
        }
    }
}

/// Whether a comma between these parts could separate thousands, as in 1,500.
fn may_be_thousands(whole: &str, rest: &str) -> bool {
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let whole = whole.trim_start_matches(['+', '-']);
    (1..=3).contains(&whole.len())
        && digits(whole)
        && !whole.starts_with('0')
        && rest.len() == 3
        && digits(rest)
}

/// An error of the CSV reader, with its line.
pub(crate) fn broken(error: csv::Error) -> Fault {
    let place = error.position().map_or(Place::File, |position| Place::Line(position.line()));
    (place, Problem::NotCsv(error.to_string()))
}

/// A cell as text.
pub(crate) fn text(cell: &[u8]) -> String {
    String::from_utf8_lossy(cell).into_owned()
}
