//! The arrays of an NPZ archive, checked before they are unpacked, so that a small file cannot fill the memory.

use std::cell::Cell;
use std::collections::HashSet;
use std::io::{self, Cursor, Read};

use zip::ZipArchive;

use crate::error::Fault;
use crate::npy::{self, BEFORE_HEADER, Element, Header, LONGEST_HEADER};
use crate::npy_text;
use crate::place::Place;
use crate::problem::Problem;

/// Largest count of numbers unpacked from one archive; together they take 8 GiB.
const MOST: u64 = 1 << 30;

/// Count of numbers that may be unpacked from any archive, however small; together they take 64 MiB.
const MOST_ANYWAY: u64 = 1 << 23;

/// Further count of numbers that may be unpacked per byte of the archive: logged motion does not compress to a
/// hundredth.
const MOST_PER_BYTE: u64 = 12;

/// An archive whose arrays are unpacked on demand.
pub(crate) struct Archive<'a> {
    zip: Zip<'a>,
    /// Names of the arrays, in the order of the archive.
    keys: Vec<String>,
    /// Count of numbers that may still be unpacked.
    room: Cell<u64>,
    most: u64,
}

type Zip<'a> = ZipArchive<Cursor<&'a [u8]>>;

impl<'a> Archive<'a> {
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        if bytes.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        // The library keeps one entry per name and does not report duplicates.
        if declared_entries(bytes).is_some_and(|declared| declared != zip.len()) {
            return Err((Place::File, Problem::Duplicate("an array".to_owned())));
        }
        let (mut keys, mut seen) = (Vec::with_capacity(zip.len()), HashSet::new());
        for name in (0..zip.len()).filter_map(|index| zip.name_for_index(index)) {
            let name = name.map_err(broken)?;
            let key = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
            if !seen.insert(key.clone()) {
                return Err((Place::Key(key), Problem::Duplicate("the array".to_owned())));
            }
            keys.push(key);
        }
        let most = MOST_PER_BYTE.saturating_mul(bytes.len() as u64).saturating_add(MOST_ANYWAY).min(MOST);
        Ok(Self { zip, keys, room: Cell::new(most), most })
    }

    /// The names of all arrays.
    pub(crate) fn keys(&self) -> &[String] {
        &self.keys
    }

    pub(crate) fn refuse_others(&self, allowed: &[&str], known: &'static str) -> Result<(), Fault> {
        let stranger = |key: &&String| !key.starts_with('_') && !allowed.contains(&key.as_str());
        match self.keys.iter().find(stranger) {
            Some(key) => Err((Place::File, Problem::UnknownName { name: key.clone(), known })),
            None => Ok(()),
        }
    }

    pub(crate) fn get(&self, key: &str) -> Result<Option<Array<'a>>, Fault> {
        let Some(index) = self.keys.iter().position(|other| other == key) else { return Ok(None) };
        let array = Array::new(&self.zip, index, key)?;
        let numbers = array.shape().iter().product::<usize>() as u64;
        match self.room.get().checked_sub(numbers) {
            Some(room) => self.room.set(room),
            None => return Err(array.fault(Problem::TooLarge { numbers, most: self.most })),
        }
        Ok(Some(array))
    }

    /// The string under a key.
    pub(crate) fn text(&self, key: &str) -> Result<Option<String>, Fault> {
        let Some(index) = self.keys.iter().position(|other| other == key) else { return Ok(None) };
        let text = start(&mut self.zip.clone(), index).and_then(|(_, start)| npy_text::read(&start));
        text.map(Some).map_err(|problem| (Place::Key(key.to_owned()), problem))
    }

    pub(crate) fn require(&self, key: &'static str) -> Result<Array<'a>, Fault> {
        self.get(key)?.ok_or((Place::File, Problem::MissingKey(key)))
    }
}

fn broken(error: zip::result::ZipError) -> Fault {
    (Place::File, Problem::NotNpz(error.to_string()))
}

/// The number of entries according to the archive's end record; `None` if it is too large for this record.
fn declared_entries(bytes: &[u8]) -> Option<usize> {
    let record = bytes.windows(4).rposition(|window| window == b"PK\x05\x06")?;
    let count = bytes.get(record + 10..record + 12)?;
    let count = u16::from_le_bytes(count.try_into().ok()?);
    (count != u16::MAX).then_some(count.into())
}

/// An array whose shape and element type fit the size that the archive states.
pub(crate) struct Array<'a> {
    zip: Zip<'a>,
    index: usize,
    key: String,
    /// Element type without its byte order, such as `f8`.
    kind: String,
    header: Header,
}

impl<'a> Array<'a> {
    fn new(zip: &Zip<'a>, index: usize, key: &str) -> Result<Self, Fault> {
        // Each array needs a reader of its own; the archive's directory is shared.
        let mut zip = zip.clone();
        let (kind, header) =
            header(&mut zip, index).map_err(|problem| (Place::Key(key.to_owned()), problem))?;
        Ok(Self { zip, index, key: key.to_owned(), kind, header })
    }

    pub(crate) fn shape(&self) -> &[usize] {
        &self.header.shape
    }

    /// Numbers of samples and columns of an array \[samples\] or \[samples, columns\]; `None` for another shape.
    pub(crate) fn samples_and_columns(&self) -> Option<(usize, usize)> {
        match *self.shape() {
            [samples] => Some((samples, 1)),
            [samples, columns] if columns > 0 => Some((samples, columns)),
            _ => None,
        }
    }

    pub(crate) fn fault(&self, problem: Problem) -> Fault {
        (Place::Key(self.key.clone()), problem)
    }

    pub(crate) fn row_fault(&self, row: usize, problem: Problem) -> Fault {
        (Place::Row { key: self.key.clone(), row }, problem)
    }

    pub(crate) fn wrong_shape(&self, expected: String) -> Fault {
        self.fault(Problem::Shape { found: self.shape().to_vec(), expected })
    }

    /// The values in row-major order, whatever the element type. 64-bit integers beyond 2⁵³ are rounded.
    pub(crate) fn reals(&self) -> Result<Vec<f64>, Fault> {
        match self.kind.as_str() {
            "f8" => self.convert(|x: f64| x),
            "f4" => self.convert(|x: f32| f64::from(x)),
            "i8" => self.convert(|x: i64| x as f64),
            "i4" => self.convert(|x: i32| f64::from(x)),
            "i2" => self.convert(|x: i16| f64::from(x)),
            "i1" => self.convert(|x: i8| f64::from(x)),
            "u8" => self.convert(|x: u64| x as f64),
            "u4" => self.convert(|x: u32| f64::from(x)),
            "u2" => self.convert(|x: u16| f64::from(x)),
            _ => self.convert(|x: u8| f64::from(x)),
        }
    }

    /// The values, or the place of the first that is not finite; a row has `stride` values.
    pub(crate) fn finite_reals(&self, stride: usize) -> Result<Vec<f64>, Fault> {
        let values = self.reals()?;
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => Err(self.row_fault(i / stride, Problem::NotFinite(values[i]))),
            None => Ok(values),
        }
    }

    /// The values as integers; real numbers are accepted when they are whole.
    pub(crate) fn integers(&self) -> Result<Vec<i64>, Fault> {
        let values: Result<Vec<i64>, String> = match self.kind.as_str() {
            "i8" => return self.convert(|x: i64| x),
            "u8" => self.convert(|x: u64| i64::try_from(x).map_err(|_| x.to_string()))?.into_iter().collect(),
            _ => self.reals()?.into_iter().map(whole).collect(),
        };
        values.map_err(|value| self.fault(Problem::NotInteger(value)))
    }

    fn convert<T: Element, U: Clone>(&self, into: impl Fn(T) -> U) -> Result<Vec<U>, Fault> {
        let numbers = self.unpacked(into).map_err(|error| self.fault(Problem::NotNpz(error.to_string())))?;
        let is_one_list = self.shape().len() < 2;
        let is_sorted = is_one_list || !self.header.fortran_order;
        Ok(if is_sorted { numbers } else { npy::row_major(self.shape(), &numbers) })
    }

    /// The numbers in the order of the file.
    fn unpacked<T: Element, U>(&self, into: impl Fn(T) -> U) -> io::Result<Vec<U>> {
        let mut zip = self.zip.clone();
        let mut file = zip.by_index(self.index)?;
        io::copy(&mut file.by_ref().take(self.header.bytes as u64), &mut io::sink())?;
        let count = self.shape().iter().product();
        let numbers = npy::elements(&mut file, (count, self.header.descriptor.starts_with('>')), into)?;
        // Reading beyond the end makes the container compare its checksum.
        let _nothing = file.read(&mut [0])?;
        Ok(numbers)
    }
}

/// Element type and header, checked against the stated size.
fn header(zip: &mut Zip<'_>, index: usize) -> Result<(String, Header), Problem> {
    let (size, start) = start(zip, index)?;
    let header = Header::read(&start).map_err(damaged)?;
    let data = size.saturating_sub(header.bytes as u64);
    fitting(header, data)
}

fn damaged(reason: npy::Damage) -> Problem {
    Problem::NotNpy(reason.to_owned())
}

/// The size of an array, and its first bytes; these contain the whole header if it is short enough to be parsed.
fn start(zip: &mut Zip<'_>, index: usize) -> Result<(u64, Vec<u8>), Problem> {
    let file = zip.by_index(index).map_err(|error| Problem::NotNpz(error.to_string()))?;
    let (size, mut start) = (file.size(), Vec::new());
    let longest = (LONGEST_HEADER + BEFORE_HEADER) as u64;
    file.take(longest).read_to_end(&mut start).map_err(|error| Problem::NotNpz(error.to_string()))?;
    Ok((size, start))
}

fn fitting(header: Header, data: u64) -> Result<(String, Header), Problem> {
    let kind = header.descriptor.trim_start_matches(['<', '>', '|', '=']).to_owned();
    if !["f8", "f4", "i8", "i4", "i2", "i1", "u8", "u4", "u2", "u1"].contains(&kind.as_str()) {
        return Err(Problem::ElementType(header.descriptor));
    }
    let size = kind.chars().filter_map(|digit| digit.to_digit(10)).sum::<u32>() as u64;
    let bytes = header.shape.iter().try_fold(size, |bytes, &axis| bytes.checked_mul(axis as u64));
    if bytes != Some(data) {
        let reason = format!("{data} bytes of data for shape {:?} of {kind}", header.shape);
        return Err(Problem::NotNpy(reason));
    }
    Ok((kind, header))
}

/// The integer that a number is, or the number in digits.
pub(crate) fn whole(x: f64) -> Result<i64, String> {
    // 2⁶³ itself does not fit; −2⁶³ does.
    let fits = x.fract() == 0.0 && (-9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0).contains(&x);
    if fits { Ok(x as i64) } else { Err(x.to_string()) }
}
