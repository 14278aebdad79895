//! Tables of an SQLite database, read only: pages, B-trees of tables, records.
//!
//! Sizes and page numbers in a file are not trusted: every access is within a page, and a walk visits no more pages, and reads no more
//! bytes, than the file has. Journals beside the file are not looked at here.
//!
//! Source: Database File Format (sqlite.org/fileformat2.html).

use super::sqlite_record::{Fields, Value, columns, values, varint};
use crate::bag_problem::BagProblem;
use crate::error::Fault;
use crate::place::Place;
use std::io::{Read, Seek, SeekFrom};

/// First bytes of every database.
const MAGIC: [u8; 16] = *b"SQLite format 3\0";
/// Bytes of the file before the first page's own header.
const FILE_HEADER: usize = 100;
/// Kinds of pages in the B-tree of a table.
const INTERIOR: u8 = 5;
const LEAF: u8 = 13;
/// Page with the root of the table of tables.
const SCHEMA_PAGE: u32 = 1;
/// Deepest B-tree; SQLite itself stops at this depth.
const DEEPEST: usize = 20;
/// Longest value that is read, bytes.
const LARGEST_VALUE: u64 = 1 << 28;

/// A file that can be read at any place.
pub(crate) trait Source: Read + Seek {}

impl<T: Read + Seek> Source for T {}

/// An open database.
pub(super) struct Database<'a> {
    file: &'a mut dyn Source,
    page_size: usize,
    /// Bytes of a page that hold content.
    usable: usize,
    pages: u32,
    /// Bytes that records of the table may still have: they do not share pages.
    left: u64,
}

/// A row of a table: its number, and the start of its record, of which the rest lies on overflow pages.
pub(super) struct Row<'p> {
    pub id: i64,
    length: u64,
    local: &'p [u8],
    overflow: u32,
}

/// A table: its first page, and the names of its columns.
pub(super) struct Table {
    pub name: String,
    root: u32,
    pub columns: Vec<String>,
}

pub(super) fn damaged(reason: &str) -> Fault {
    (Place::File, BagProblem::NotDb3(reason.to_owned()).into())
}

const CUT: &str = "it ends in the middle of a page";
const BEYOND: &str = "a page points beyond its end";

fn array<const N: usize>(bytes: &[u8], at: usize) -> Result<[u8; N], Fault> {
    let found = bytes.get(at..).and_then(<[u8]>::first_chunk);
    found.copied().ok_or_else(|| damaged(BEYOND))
}

fn short(bytes: &[u8], at: usize) -> Result<usize, Fault> {
    array(bytes, at).map(|bytes| usize::from(u16::from_be_bytes(bytes)))
}

fn word(bytes: &[u8], at: usize) -> Result<u32, Fault> {
    array(bytes, at).map(u32::from_be_bytes)
}

impl<'a> Database<'a> {
    pub fn open(file: &'a mut dyn Source) -> Result<Self, Fault> {
        let length = file.seek(SeekFrom::End(0)).map_err(|error| (Place::File, error.into()))?;
        let mut header = [0; FILE_HEADER];
        read_at(file, 0, &mut header)?;
        if !header.starts_with(&MAGIC) {
            return Err(damaged("it does not begin as one"));
        }
        let page_size = match short(&header, 16)? {
            1 => 1 << 16,
            size if size.is_power_of_two() && size >= 512 => size,
            _ => return Err(damaged("its pages have a size that no database has")),
        };
        let usable = page_size - usize::from(header[20]);
        if usable < 480 {
            return Err(damaged("its pages have no room for content"));
        }
        if word(&header, 56)? > 1 {
            return Err(damaged("its texts are UTF-16, which no recorder writes"));
        }
        let pages = u32::try_from(length / page_size as u64).unwrap_or(u32::MAX);
        // Old versions of SQLite leave the number of pages as it was; then the other two numbers differ.
        let is_counted = word(&header, 24)? == word(&header, 92)?;
        if is_counted && word(&header, 28)? > pages {
            return Err(damaged(CUT));
        }
        Ok(Self { file, page_size, usable, pages, left: 0 })
    }

    /// The table with this name, or `None`.
    pub fn table(&mut self, name: &str) -> Result<Option<Table>, Fault> {
        let mut found = None;
        self.walk(SCHEMA_PAGE, &mut |database, row| {
            let record = database.whole(row)?;
            if let [Value::Text("table"), Value::Text(own), _, Value::Integer(root), Value::Text(sql), ..] =
                values(&record)?[..]
                && own == name
            {
                let root = u32::try_from(root).map_err(|_| damaged("a table begins at no page"))?;
                found = Some(Table { name: own.to_owned(), root, columns: columns(sql) });
            }
            Ok(())
        })?;
        Ok(found)
    }

    /// Hands over all rows of a table in the order of their numbers.
    pub fn rows(
        &mut self,
        table: &Table,
        take: &mut dyn FnMut(&mut Self, &Row<'_>) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        self.walk(table.root, take)
    }

    /// Visits the leaves of a B-tree from left to right.
    fn walk(
        &mut self,
        root: u32,
        take: &mut dyn FnMut(&mut Self, &Row<'_>) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let mut left = self.pages;
        self.left = u64::from(self.pages) * self.page_size as u64;
        // Pages still to be visited, with their depth; the next one is the last.
        let mut waiting = vec![(root, 0)];
        while let Some((number, depth)) = waiting.pop() {
            left = left.checked_sub(1).ok_or_else(|| damaged("a page is in a table twice"))?;
            if depth > DEEPEST {
                return Err(damaged("its tables are nested too deeply"));
            }
            let page = Page::new(self.page(number)?, number)?;
            match page.kind {
                INTERIOR => {
                    waiting.extend(page.children()?.into_iter().rev().map(|child| (child, depth + 1)))
                }
                LEAF => (0..page.cells).try_for_each(|k| take(self, &page.row(k, self.usable)?))?,
                _ => return Err(damaged("a page of a table is of another kind")),
            }
        }
        Ok(())
    }

    fn page(&mut self, number: u32) -> Result<Vec<u8>, Fault> {
        if number == 0 || number > self.pages {
            return Err(damaged(if number == 0 { BEYOND } else { CUT }));
        }
        let mut page = vec![0; self.page_size];
        read_at(self.file, u64::from(number - 1) * self.page_size as u64, &mut page)?;
        page.truncate(self.usable);
        Ok(page)
    }

    /// The whole record of a row.
    pub fn whole(&mut self, row: &Row<'_>) -> Result<Vec<u8>, Fault> {
        if row.length > LARGEST_VALUE {
            let problem = BagProblem::LargeValue { bytes: row.length, most: LARGEST_VALUE };
            return Err((Place::File, problem.into()));
        }
        let rest = self.left.checked_sub(row.length);
        self.left = rest.ok_or_else(|| damaged("its rows are longer than the file"))?;
        let (mut record, mut next) = (row.local.to_vec(), row.overflow);
        // Every page adds to the record, so that a circle of pages ends with it.
        while (record.len() as u64) < row.length {
            let page = self.page(next)?;
            next = word(&page, 0)?;
            let missing = row.length as usize - record.len();
            record.extend(page.get(4..).unwrap_or_default().iter().take(missing));
        }
        Ok(record)
    }
}

fn read_at(file: &mut dyn Source, at: u64, to: &mut [u8]) -> Result<(), Fault> {
    let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(to));
    read.map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => damaged(CUT),
        _ => (Place::File, error.into()),
    })
}

/// A page of a table's B-tree.
struct Page {
    bytes: Vec<u8>,
    /// Start of the page's own header.
    start: usize,
    kind: u8,
    cells: usize,
}

impl Page {
    fn new(bytes: Vec<u8>, number: u32) -> Result<Self, Fault> {
        let start = if number == SCHEMA_PAGE { FILE_HEADER } else { 0 };
        let [kind] = array(&bytes, start)?;
        let cells = short(&bytes, start + 3)?;
        Ok(Self { bytes, start, kind, cells })
    }

    /// Bytes from cell `k` to the end of the page.
    fn cell(&self, k: usize, header: usize) -> Result<&[u8], Fault> {
        let at = short(&self.bytes, self.start + header + 2 * k)?;
        self.bytes.get(at..).ok_or_else(|| damaged(BEYOND))
    }

    /// Numbers of the pages below.
    fn children(&self) -> Result<Vec<u32>, Fault> {
        let own = (0..self.cells).map(|k| word(self.cell(k, 12)?, 0));
        own.chain(std::iter::once_with(|| word(&self.bytes, self.start + 8))).collect()
    }

    /// Row `k` of a leaf; `usable` bytes of a page decide how much of a record is in it.
    fn row(&self, k: usize, usable: usize) -> Result<Row<'_>, Fault> {
        let mut cell = self.cell(k, 8)?;
        let beyond = || damaged(BEYOND);
        let length = varint(&mut cell).ok_or_else(beyond)?;
        let id = varint(&mut cell).ok_or_else(beyond)? as i64;
        let here = local(length, usable);
        let (local, rest) = cell.split_at_checked(here).ok_or_else(beyond)?;
        let overflow = if (here as u64) < length { word(rest, 0)? } else { 0 };
        Ok(Row { id, length, local, overflow })
    }
}

/// Bytes of a record of this length that are in the leaf.
fn local(length: u64, usable: usize) -> usize {
    let most = usable - 35;
    if length <= most as u64 {
        return length as usize;
    }
    let least = (usable - 12) * 32 / 255 - 23;
    let fitting = least + ((length - least as u64) % (usable as u64 - 4)) as usize;
    if fitting <= most { fitting } else { least }
}

impl Row<'_> {
    /// The value of a column, if it is an integer that lies in the leaf.
    pub fn integer(&self, column: usize) -> Option<i64> {
        match Fields::new(self.local)?.nth(column)?? {
            Value::Integer(value) => Some(value),
            _ => None,
        }
    }
}
