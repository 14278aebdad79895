//! Arrays of numbers in MATLAB's files of version 5, 6 and 7 (`save -v7`, SciPy's `savemat`).
//!
//! Structures give arrays called `name.field`, as deep as they are nested; cells, texts, sparse and complex arrays and objects are not read.
//! In MATLAB every array has two axes or more. Axes of length 1 do not count, and time runs along the longer of two, so that a row of
//! numbers is a column of samples.
//!
//! Source: MAT-File Format, version 5 (MathWorks).

use crate::Rows;
use crate::array_columns::Named;
use crate::error::Fault;
use crate::mat_elements::{Damage, Elements, Order};
use crate::mat_problem::MatProblem;
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use flate2::read::ZlibDecoder;
use std::io::Read;

/// Bytes before the first element.
const HEADER: usize = 128;
/// Bytes to which the elements of any file may unpack, however small it is.
const MOST_ANYWAY: u64 = 1 << 26;
/// Further bytes per byte of the file: logged motion does not compress to a hundredth.
const MOST_PER_BYTE: u64 = 100;
/// Deepest nesting of structures.
const DEEPEST: usize = 8;
/// Largest number of arrays.
const MOST_ARRAYS: usize = 10_000;

/// Kinds of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Classes of arrays: structures, and the first and last class of numbers.
const STRUCTURE: u32 = 2;
const NUMBERS: std::ops::RangeInclusive<u32> = 6..=15;
/// Flag of complex numbers.
const COMPLEX: u32 = 0x800;

/// The arrays of a file.
#[derive(Default)]
pub(crate) struct MatFile {
    names: Vec<String>,
    arrays: Vec<Array>,
    others: Vec<String>,
}

/// Numbers in column-major order; axes of length 1 are left out.
struct Array {
    shape: Vec<usize>,
    numbers: Vec<f64>,
}

impl MatFile {
    /// Reads a whole file.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let read = Self::default().with(bytes);
        read.map_err(|problem| (Place::File, problem))
    }

    fn with(mut self, bytes: &[u8]) -> Result<Self, Problem> {
        let order = order(bytes)?;
        let most = MOST_PER_BYTE.saturating_mul(bytes.len() as u64).saturating_add(MOST_ANYWAY);
        let mut room = most;
        let mut elements = Elements { rest: bytes.get(HEADER..).unwrap_or_default(), order };
        while let Some((kind, content)) = elements.next().map_err(no)? {
            if kind == COMPRESSED {
                let unpacked = unpacked(content, &mut room)
                    .map_err(|error| error.unwrap_or(MatProblem::Unpacked { most }))?;
                let mut within = Elements { rest: &unpacked, order };
                while let Some((kind, content)) = within.next().map_err(no)? {
                    self.element(kind, content, order)?;
                }
            } else {
                self.element(kind, content, order)?;
            }
        }
        Ok(self)
    }

    fn element(&mut self, kind: u32, content: &[u8], order: Order) -> Result<(), Problem> {
        if kind == MATRIX { self.array(&[], Elements { rest: content, order }).map_err(no) } else { Ok(()) }
    }

    /// Takes an array in, or those of a structure. `path` has the names of the structures around it and its own name, which is not written
    /// beside a field.
    fn array(&mut self, path: &[&str], mut parts: Elements<'_>) -> Result<(), Damage> {
        if parts.rest.is_empty() {
            return Ok(());
        }
        let flags = parts.integers()?.first().copied().unwrap_or_default() as u32;
        let shape = parts.integers()?;
        let own = parts.text()?;
        let path = if path.is_empty() { &[own.as_str()][..] } else { path };
        let (name, class) = (path.join("."), flags & 0xFF);
        if self.names.len() + self.others.len() >= MOST_ARRAYS {
            return Err("it has more than 10000 arrays");
        }
        if class == STRUCTURE && shape.iter().all(|axis| *axis == 1) && path.len() < DEEPEST {
            return self.structure(path, parts);
        }
        if !NUMBERS.contains(&class) || flags & COMPLEX != 0 {
            self.others.push(name);
            return Ok(());
        }
        let array = Array::new(&shape, parts.numbers()?)?;
        self.names.push(name);
        self.arrays.push(array);
        Ok(())
    }

    /// Takes in the fields of a structure: the length of their names, the names, an array of each.
    fn structure(&mut self, path: &[&str], mut parts: Elements<'_>) -> Result<(), Damage> {
        let length = parts.integers()?.first().copied().unwrap_or_default();
        let length = usize::try_from(length).ok().filter(|length| *length > 0);
        let names = parts.bytes()?;
        let names = names.chunks(length.ok_or("the fields of a structure have no names")?);
        for name in names {
            let end = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
            let name = String::from_utf8_lossy(&name[..end]);
            let Some((MATRIX, content)) = parts.next()? else {
                return Err("a field of a structure is no array");
            };
            let path: Vec<&str> = path.iter().copied().chain([&*name]).collect();
            self.array(&path, Elements { rest: content, order: parts.order })?;
        }
        Ok(())
    }

    /// Names of everything in the file that is no array of real numbers.
    pub fn others(&self) -> &[String] {
        &self.others
    }

    fn array_called(&self, name: &str) -> Option<&Array> {
        let at = self.names.iter().position(|known| known == name)?;
        self.arrays.get(at)
    }

    /// The table under leastaction's own names.
    pub fn table(&self) -> Result<Table, Fault> {
        let rows = |name: &str| self.array_called(name).map(|array| array.rows_of(name)).transpose();
        let column = |name: &str| Ok(rows(name)?.map(|rows| rows.as_flat().to_vec()));
        let [h, t] = [column("h")?, column("t")?];
        let h = h.and_then(|h| h.first().map(|h| (*h, Place::Key("h".to_owned()))));
        let trajectory = column("trajectory")?.map(|ids| ids.into_iter().map(|id| id as i64).collect());
        let q = rows("q")?.ok_or((Place::File, Problem::MissingPositions("the array q")))?;
        let [v, a, u] = [rows("v")?, rows("a")?, rows("u")?];
        let table = Table { q, v, a, u, t, h, trajectory, control: None, origin: Origin::rows() };
        table.of_one_length()
    }
}

impl Table {
    /// The table, unless its fields differ in length.
    pub(crate) fn of_one_length(self) -> Result<Self, Fault> {
        let expected = self.q.len();
        let fields = [("v", self.v.as_ref()), ("a", self.a.as_ref()), ("u", self.u.as_ref())];
        let lengths = fields.into_iter().filter_map(|(name, rows)| Some((name, rows?.len())));
        let times =
            [("t", self.t.as_ref().map(Vec::len)), ("trajectory", self.trajectory.as_ref().map(Vec::len))];
        let times = times.into_iter().filter_map(|(name, length)| Some((name, length?)));
        let others = [("v", self.v.as_ref()), ("a", self.a.as_ref()), ("u", self.u.as_ref())];
        let wide =
            others.into_iter().find(|(_, rows)| rows.is_some_and(|rows| rows.width() != self.q.width()));
        let fault = |name, what, found, expected| {
            Err((Place::File, Problem::Inconsistent { name, what, found, expected }))
        };
        if let Some((name, found)) = lengths.chain(times).find(|(_, length)| *length != expected) {
            return fault(name, "samples", found, expected);
        }
        match wide {
            Some((name, rows)) => fault(name, "columns", rows.map_or(0, Rows::width), self.q.width()),
            None => Ok(self),
        }
    }
}

impl Named for MatFile {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn rows(&self, name: &str) -> Result<Option<Rows>, Fault> {
        self.array_called(name).map(|array| array.rows_of(name)).transpose()
    }
}

impl Array {
    fn new(shape: &[i64], numbers: Vec<f64>) -> Result<Self, Damage> {
        let axis = |axis: &i64| usize::try_from(*axis).map_err(|_| "an axis of an array is shorter than 0");
        let shape = shape.iter().map(axis).collect::<Result<Vec<_>, _>>()?;
        let count = shape.iter().try_fold(1_usize, |count, axis| count.checked_mul(*axis));
        if count != Some(numbers.len()) {
            return Err("an array has another number of values than its shape");
        }
        Ok(Self { shape: shape.into_iter().filter(|axis| *axis != 1).collect(), numbers })
    }

    /// The numbers with a row for every sample, along the longer axis.
    fn rows_of(&self, name: &str) -> Result<Rows, Fault> {
        let fault = |problem| (Place::Key(name.to_owned()), problem);
        let (samples, width) = match self.shape[..] {
            [] => (1, 1),
            [samples] => (samples, 1),
            [a, b] => (a.max(b), a.min(b)),
            _ => {
                let expected = "[samples, columns]".to_owned();
                return Err(fault(Problem::Shape { found: self.shape.clone(), expected }));
            }
        };
        let is_along_rows = self.shape.len() == 2 && self.shape[0] < self.shape[1];
        let values =
            if is_along_rows || width == 1 { self.numbers.clone() } else { self.turned(samples, width) };
        Rows::from_flat(width, values).ok_or_else(|| fault(Problem::Empty))
    }

    /// Row-major copy.
    fn turned(&self, samples: usize, width: usize) -> Vec<f64> {
        let row = |k: usize| (0..width).map(move |i| self.numbers[k + i * samples]);
        (0..samples).flat_map(row).collect()
    }
}

fn no(reason: Damage) -> Problem {
    MatProblem::NotMat(reason).into()
}

/// Byte order of a file; refuses other versions.
fn order(bytes: &[u8]) -> Result<Order, Problem> {
    if bytes.is_empty() {
        return Err(Problem::Empty);
    }
    if bytes.starts_with(b"MATLAB 7.3") || bytes.starts_with(b"\x89HDF") {
        return Err(MatProblem::Hdf5.into());
    }
    match bytes.get(124..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(Order::Little),
        Some([1, 0, b'M', b'I']) => Ok(Order::Big),
        // A file of version 4 begins with the type of its first array, a small number.
        _ if bytes
            .first_chunk()
            .is_some_and(|type_| u32::from_le_bytes(*type_).min(u32::from_be_bytes(*type_)) < 5000) =>
        {
            Err(MatProblem::Version4.into())
        }
        _ => Err(no("it does not begin as one")),
    }
}

/// The content of a compressed element; `None` in the error if there is no room for it.
fn unpacked(content: &[u8], room: &mut u64) -> Result<Vec<u8>, Option<MatProblem>> {
    let mut unpacked = Vec::new();
    let read = ZlibDecoder::new(content).take(room.saturating_add(1)).read_to_end(&mut unpacked);
    read.map_err(|_| Some(MatProblem::NotMat("a compressed part of it is damaged")))?;
    *room = room.checked_sub(unpacked.len() as u64).ok_or(None)?;
    Ok(unpacked)
}
