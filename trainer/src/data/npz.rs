//! NPZ: a zip archive of NumPy arrays.

use std::io::{Cursor, Read};

use ndarray::{ArrayD, ArrayViewD, IxDyn};
use ndarray_npy::npy::header::Header;
use ndarray_npy::{ReadNpyExt, ReadableElement, WritableElement, WriteNpyExt};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::error::{Fault, Place, Problem};
use super::table::Table;
use super::{Dataset, Rows};

/// NumPy refuses longer headers too: nothing honest needs them, and a parser can be drowned in them.
const LONGEST_HEADER: usize = 10_000;

/// Brackets within brackets in a header: a record type has three.
const DEEPEST_HEADER: usize = 8;

/// Bytes of one array at most, so that a forged archive cannot unpack without end.
const LARGEST_ARRAY: u64 = 1 << 32;

const KNOWN: &str = "q, v, a, u, t, h, trajectory";

pub(super) fn read(bytes: &[u8]) -> Result<Table, Fault> {
    let archive = Archive::open(bytes)?;
    archive.refuse_others(&["q", "v", "a", "u", "t", "h", "trajectory"], KNOWN)?;
    let q = archive.rows("q", None)?.ok_or((Place::File, Problem::MissingPositions("the key q")))?;
    let like_q = Some((q.len(), q.width()));
    Ok(Table {
        v: archive.rows("v", like_q)?,
        a: archive.rows("a", like_q)?,
        u: archive.rows("u", like_q)?,
        t: archive.column("t", q.len())?.map(|t| t.reals()).transpose()?,
        h: archive.scalar("h")?.map(|h| (h, Place::Key("h".to_owned()))),
        trajectory: archive.column("trajectory", q.len())?.map(|ids| ids.integers()).transpose()?,
        lines: None,
        q,
    })
}

pub(super) fn write(dataset: &Dataset) -> Result<Vec<u8>, Fault> {
    let mut writer = Writer::new();
    for (i, name) in ["q", "v", "a", "u"].into_iter().enumerate() {
        let rows = dataset.trajectories.iter().filter_map(|trajectory| trajectory.fields()[i].1);
        let values: Vec<f64> = rows.flat_map(Rows::as_flat).copied().collect();
        if !values.is_empty() {
            writer.add(name, &[values.len() / dataset.n, dataset.n], &values)?;
        }
    }
    let times: Vec<f64> = dataset.trajectories.iter().flat_map(|trajectory| dataset.times(trajectory)).collect();
    writer.add("t", &[times.len()], &times)?;
    writer.add("h", &[], &[dataset.h])?;
    let ids = dataset.trajectories.iter().flat_map(|trajectory| vec![trajectory.id; trajectory.samples()]);
    let ids: Vec<i64> = ids.collect();
    writer.add("trajectory", &[ids.len()], &ids)?;
    writer.finish()
}

/// The arrays of an archive, as they stand.
pub(super) struct Archive {
    entries: Vec<Entry>,
}

impl Archive {
    pub(super) fn open(bytes: &[u8]) -> Result<Self, Fault> {
        if bytes.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let broken = |error: zip::result::ZipError| (Place::File, Problem::NotNpz(error.to_string()));
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        let mut entries: Vec<Entry> = Vec::with_capacity(zip.len());
        for index in 0..zip.len() {
            let entry = Entry::unpack(zip.by_index(index).map_err(broken)?)?;
            if entries.iter().any(|other| other.key == entry.key) {
                return Err((Place::File, Problem::Duplicate(format!("key {}", entry.key))));
            }
            entries.push(entry);
        }
        Ok(Self { entries })
    }

    pub(super) fn refuse_others(&self, allowed: &[&str], known: &'static str) -> Result<(), Fault> {
        let stranger = |entry: &&Entry| !entry.key.starts_with('_') && !allowed.contains(&entry.key.as_str());
        match self.entries.iter().find(stranger) {
            Some(entry) => Err((Place::File, Problem::UnknownName { name: entry.key.clone(), known })),
            None => Ok(()),
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.key == key)
    }

    pub(super) fn require(&self, key: &'static str) -> Result<&Entry, Fault> {
        self.get(key).ok_or((Place::File, Problem::MissingKey(key)))
    }

    /// A field \[samples, n\], or \[samples\] when n = 1; of the given (samples, n) if any.
    fn rows(&self, key: &str, size: Option<(usize, usize)>) -> Result<Option<Rows>, Fault> {
        let Some(entry) = self.get(key) else { return Ok(None) };
        let shape = entry.shape()?;
        let found = match *shape.as_slice() {
            [samples] => Some((samples, 1)),
            [samples, n] if n > 0 => Some((samples, n)),
            _ => None,
        };
        match (found, size) {
            (Some(found), Some(size)) if found != size => {
                Err(entry.fault(Problem::Shape { found: shape, expected: format!("[{}, {}] as of q", size.0, size.1) }))
            }
            (Some((_, n)), _) => Ok(Rows::from_flat(n, entry.reals()?)),
            (None, _) => {
                Err(entry.fault(Problem::Shape { found: shape, expected: "[samples, n] with n ≥ 1".to_owned() }))
            }
        }
    }

    fn column(&self, key: &str, samples: usize) -> Result<Option<&Entry>, Fault> {
        let Some(entry) = self.get(key) else { return Ok(None) };
        let shape = entry.shape()?;
        if shape == [samples] || shape == [samples, 1] {
            return Ok(Some(entry));
        }
        Err(entry.fault(Problem::Shape { found: shape, expected: format!("[{samples}], one for each sample of q,") }))
    }

    fn scalar(&self, key: &str) -> Result<Option<f64>, Fault> {
        let Some(entry) = self.get(key) else { return Ok(None) };
        match *entry.reals()?.as_slice() {
            [value] => Ok(Some(value)),
            _ => Err(entry.fault(Problem::Shape { found: entry.shape()?, expected: "one number".to_owned() })),
        }
    }
}

/// One array: its name and its `.npy` bytes.
pub(super) struct Entry {
    key: String,
    npy: Vec<u8>,
}

impl Entry {
    fn unpack<R: Read>(file: zip::read::ZipFile<'_, R>) -> Result<Self, Fault> {
        let key = file.name().strip_suffix(".npy").unwrap_or(file.name()).to_owned();
        let mut npy = Vec::new();
        match file.take(LARGEST_ARRAY).read_to_end(&mut npy) {
            Ok(_) => Ok(Self { key, npy }),
            Err(error) => Err((Place::Key(key), Problem::NotNpz(error.to_string()))),
        }
    }

    pub(super) fn fault(&self, problem: Problem) -> Fault {
        (Place::Key(self.key.clone()), problem)
    }

    pub(super) fn row_fault(&self, row: usize, problem: Problem) -> Fault {
        (Place::Row { key: self.key.clone(), row }, problem)
    }

    fn broken(&self, reason: impl ToString) -> Fault {
        self.fault(Problem::NotNpy(reason.to_string()))
    }

    /// The element type without its byte order, as `f8`, and the shape, once they are known to fit the data.
    fn header(&self) -> Result<(String, Vec<usize>), Fault> {
        check_header_text(&self.npy).map_err(|reason| self.broken(reason))?;
        let mut rest = self.npy.as_slice();
        let header = Header::from_reader(&mut rest).map_err(|error| self.broken(error))?;
        let descriptor = header.type_descriptor.to_string();
        let kind = descriptor.trim_matches(['\'', '"', '<', '>', '|', '=']).to_owned();
        let size: usize = kind.get(1..).and_then(|digits| digits.parse().ok()).unwrap_or(0);
        let expected = header.shape.iter().try_fold(size, |bytes, &axis| bytes.checked_mul(axis));
        if size == 0 || !["f8", "f4", "i8", "i4", "i2", "i1", "u8", "u4", "u2", "u1"].contains(&kind.as_str()) {
            Err(self.fault(Problem::ElementType(descriptor)))
        } else if expected != Some(rest.len()) {
            Err(self.broken(format!("{} bytes of data for shape {:?} of {kind}", rest.len(), header.shape)))
        } else {
            Ok((kind, header.shape))
        }
    }

    pub(super) fn shape(&self) -> Result<Vec<usize>, Fault> {
        Ok(self.header()?.1)
    }

    /// The values in row-major order, whatever the element type. 64-bit integers beyond 2⁵³ are rounded.
    pub(super) fn reals(&self) -> Result<Vec<f64>, Fault> {
        match self.header()?.0.as_str() {
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

    /// The values as integers; real numbers are accepted when they are whole.
    fn integers(&self) -> Result<Vec<i64>, Fault> {
        let values: Result<Vec<i64>, String> = match self.header()?.0.as_str() {
            "i8" => return self.convert(|x: i64| x),
            "u8" => self.convert(|x: u64| i64::try_from(x).map_err(|_| x.to_string()))?.into_iter().collect(),
            _ => self.reals()?.into_iter().map(whole).collect(),
        };
        values.map_err(|value| self.fault(Problem::NotInteger(value)))
    }

    fn convert<T: ReadableElement + Copy, U>(&self, into: impl Fn(T) -> U) -> Result<Vec<U>, Fault> {
        let array = ArrayD::<T>::read_npy(self.npy.as_slice()).map_err(|error| self.broken(error))?;
        Ok(array.iter().map(|&x| into(x)).collect())
    }
}

fn whole(x: f64) -> Result<i64, String> {
    // 2⁶³ itself does not fit; −2⁶³ does.
    let fits = x.fract() == 0.0 && (-9_223_372_036_854_775_808.0..9_223_372_036_854_775_808.0).contains(&x);
    if fits { Ok(x as i64) } else { Err(x.to_string()) }
}

/// Refuses headers that would make the parser allocate or recurse without bound.
fn check_header_text(npy: &[u8]) -> Result<(), &'static str> {
    let (start, length) = match *npy {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (10, usize::from(u16::from_le_bytes([a, b]))),
        [_, _, _, _, _, _, _, _, a, b, 0, 0, ..] => (12, usize::from(u16::from_le_bytes([a, b]))),
        _ => return Err("its header is cut off, or too long"),
    };
    let text = npy.get(start..start + length).ok_or("its header is cut off")?;
    let opening = text.iter().filter(|byte| b"([{".contains(byte)).count();
    if length > LONGEST_HEADER || opening > DEEPEST_HEADER { Err("its header is no array's") } else { Ok(()) }
}

/// An archive in the making; the same arrays give the same bytes.
pub(super) struct Writer {
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Writer {
    pub(super) fn new() -> Self {
        Self { zip: ZipWriter::new(Cursor::new(Vec::new())) }
    }

    pub(super) fn add<T: WritableElement>(&mut self, key: &str, shape: &[usize], values: &[T]) -> Result<(), Fault> {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
        let failed = |reason: String| (Place::Key(key.to_owned()), Problem::NotNpz(reason));
        let array = ArrayViewD::from_shape(IxDyn(shape), values).map_err(|error| failed(error.to_string()))?;
        self.zip.start_file(format!("{key}.npy"), options).map_err(|error| failed(error.to_string()))?;
        array.write_npy(&mut self.zip).map_err(|error| failed(error.to_string()))
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, Fault> {
        let bytes = self.zip.finish().map_err(|error| (Place::File, Problem::NotNpz(error.to_string())))?;
        Ok(bytes.into_inner())
    }
}
