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
    let q = rows(archive.get("q")?, None)?.ok_or((Place::File, Problem::MissingPositions("the key q")))?;
    let like_q = Some((q.len(), q.width()));
    Ok(Table {
        v: rows(archive.get("v")?, like_q)?,
        a: rows(archive.get("a")?, like_q)?,
        u: rows(archive.get("u")?, like_q)?,
        t: column(archive.get("t")?, q.len())?.map(|t| t.reals()).transpose()?,
        h: scalar(archive.get("h")?)?.map(|h| (h, Place::Key("h".to_owned()))),
        trajectory: column(archive.get("trajectory")?, q.len())?.map(|ids| ids.integers()).transpose()?,
        lines: None,
        q,
    })
}

/// A field \[samples, n\], or \[samples\] when n = 1; of the given (samples, n) if any.
fn rows(array: Option<Array<'_>>, size: Option<(usize, usize)>) -> Result<Option<Rows>, Fault> {
    let Some(array) = array else { return Ok(None) };
    let found = match *array.shape.as_slice() {
        [samples] => Some((samples, 1)),
        [samples, n] if n > 0 => Some((samples, n)),
        _ => None,
    };
    match (found, size) {
        (Some(found), Some((samples, n))) if found != (samples, n) => {
            Err(array.wrong_shape(format!("[{samples}, {n}] as of q")))
        }
        (Some((_, n)), _) => Ok(Rows::from_flat(n, array.reals()?)),
        (None, _) => Err(array.wrong_shape("[samples, n] with n ≥ 1".to_owned())),
    }
}

fn column(array: Option<Array<'_>>, samples: usize) -> Result<Option<Array<'_>>, Fault> {
    let fits = |array: &Array<'_>| array.shape == [samples] || array.shape == [samples, 1];
    match array {
        Some(array) if !fits(&array) => {
            Err(array.wrong_shape(format!("[{samples}], one for each sample of q,")))
        }
        other => Ok(other),
    }
}

fn scalar(array: Option<Array<'_>>) -> Result<Option<f64>, Fault> {
    let Some(array) = array else { return Ok(None) };
    match *array.reals()?.as_slice() {
        [value] => Ok(Some(value)),
        _ => Err(array.wrong_shape("one number".to_owned())),
    }
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
    let times: Vec<f64> =
        dataset.trajectories.iter().flat_map(|trajectory| dataset.times(trajectory)).collect();
    writer.add("t", &[times.len()], &times)?;
    writer.add("h", &[], &[dataset.h])?;
    let ids = dataset.trajectories.iter().flat_map(|trajectory| vec![trajectory.id; trajectory.samples()]);
    let ids: Vec<i64> = ids.collect();
    writer.add("trajectory", &[ids.len()], &ids)?;
    writer.finish()
}

/// The arrays of an archive, unpacked.
pub(super) struct Archive {
    entries: Vec<Entry>,
}

/// One array: its name and its `.npy` bytes.
struct Entry {
    key: String,
    npy: Vec<u8>,
}

impl Archive {
    pub(super) fn open(bytes: &[u8]) -> Result<Self, Fault> {
        if bytes.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
        // The library keeps one entry of each name and says nothing of others.
        if declared_entries(bytes).is_some_and(|declared| declared != zip.len()) {
            return Err((Place::File, Problem::Duplicate("an array".to_owned())));
        }
        let mut entries: Vec<Entry> = Vec::with_capacity(zip.len());
        for index in 0..zip.len() {
            let entry = Entry::unpack(zip.by_index(index).map_err(broken)?)?;
            if entries.iter().any(|other| other.key == entry.key) {
                return Err((Place::Key(entry.key), Problem::Duplicate("the array".to_owned())));
            }
            entries.push(entry);
        }
        Ok(Self { entries })
    }

    fn refuse_others(&self, allowed: &[&str], known: &'static str) -> Result<(), Fault> {
        let stranger = |entry: &&Entry| !entry.key.starts_with('_') && !allowed.contains(&entry.key.as_str());
        match self.entries.iter().find(stranger) {
            Some(entry) => Err((Place::File, Problem::UnknownName { name: entry.key.clone(), known })),
            None => Ok(()),
        }
    }

    pub(super) fn get(&self, key: &str) -> Result<Option<Array<'_>>, Fault> {
        self.entries.iter().find(|entry| entry.key == key).map(Array::new).transpose()
    }

    pub(super) fn require(&self, key: &'static str) -> Result<Array<'_>, Fault> {
        self.get(key)?.ok_or((Place::File, Problem::MissingKey(key)))
    }
}

fn broken(error: zip::result::ZipError) -> Fault {
    (Place::File, Problem::NotNpz(error.to_string()))
}

/// The number of entries in the archive's last record, unless it is stored elsewhere for being too large.
fn declared_entries(bytes: &[u8]) -> Option<usize> {
    let record = bytes.windows(4).rposition(|window| window == b"PK\x05\x06")?;
    let count = bytes.get(record + 10..record + 12)?;
    let count = u16::from_le_bytes(count.try_into().ok()?);
    (count != u16::MAX).then_some(count.into())
}

impl Entry {
    fn unpack<R: Read>(file: zip::read::ZipFile<'_, R>) -> Result<Self, Fault> {
        let name = file.name().map_err(broken)?;
        let key = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        let mut npy = Vec::new();
        match file.take(LARGEST_ARRAY).read_to_end(&mut npy) {
            Ok(_) => Ok(Self { key, npy }),
            Err(error) => Err((Place::Key(key), Problem::NotNpz(error.to_string()))),
        }
    }
}

/// An array whose shape and element type fit its data.
pub(super) struct Array<'a> {
    entry: &'a Entry,
    /// Element type without its byte order, as `f8`.
    kind: String,
    pub(super) shape: Vec<usize>,
}

impl<'a> Array<'a> {
    fn new(entry: &'a Entry) -> Result<Self, Fault> {
        let fault = |problem| (Place::Key(entry.key.clone()), problem);
        let (kind, shape) = parse(&entry.npy).map_err(fault)?;
        Ok(Self { entry, kind, shape })
    }

    pub(super) fn fault(&self, problem: Problem) -> Fault {
        (Place::Key(self.entry.key.clone()), problem)
    }

    pub(super) fn row_fault(&self, row: usize, problem: Problem) -> Fault {
        (Place::Row { key: self.entry.key.clone(), row }, problem)
    }

    pub(super) fn wrong_shape(&self, expected: String) -> Fault {
        self.fault(Problem::Shape { found: self.shape.clone(), expected })
    }

    /// The values in row-major order, whatever the element type. 64-bit integers beyond 2⁵³ are rounded.
    pub(super) fn reals(&self) -> Result<Vec<f64>, Fault> {
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

    /// The values, or the place of one that is not finite; a row has `stride` of them.
    pub(super) fn finite_reals(&self, stride: usize) -> Result<Vec<f64>, Fault> {
        let values = self.reals()?;
        match values.iter().position(|x| !x.is_finite()) {
            Some(i) => Err(self.row_fault(i / stride, Problem::NotFinite(values[i]))),
            None => Ok(values),
        }
    }

    /// The values as integers; real numbers are accepted when they are whole.
    fn integers(&self) -> Result<Vec<i64>, Fault> {
        let values: Result<Vec<i64>, String> = match self.kind.as_str() {
            "i8" => return self.convert(|x: i64| x),
            "u8" => self.convert(|x: u64| i64::try_from(x).map_err(|_| x.to_string()))?.into_iter().collect(),
            _ => self.reals()?.into_iter().map(whole).collect(),
        };
        values.map_err(|value| self.fault(Problem::NotInteger(value)))
    }

    fn convert<T: ReadableElement + Copy, U>(&self, into: impl Fn(T) -> U) -> Result<Vec<U>, Fault> {
        let array = ArrayD::<T>::read_npy(self.entry.npy.as_slice());
        let array = array.map_err(|error| self.fault(Problem::NotNpy(error.to_string())))?;
        Ok(array.iter().map(|&x| into(x)).collect())
    }
}

/// Element type and shape, once they are known to fit the data.
fn parse(npy: &[u8]) -> Result<(String, Vec<usize>), Problem> {
    check_header_text(npy).map_err(|reason| Problem::NotNpy(reason.to_owned()))?;
    let mut data = npy;
    let header = Header::from_reader(&mut data).map_err(|error| Problem::NotNpy(error.to_string()))?;
    let descriptor = header.type_descriptor.to_string();
    let kind = descriptor.trim_matches(['\'', '"', '<', '>', '|', '=']).to_owned();
    if !["f8", "f4", "i8", "i4", "i2", "i1", "u8", "u4", "u2", "u1"].contains(&kind.as_str()) {
        return Err(Problem::ElementType(descriptor));
    }
    let size = kind.chars().filter_map(|digit| digit.to_digit(10)).sum::<u32>() as usize;
    if header.shape.iter().try_fold(size, |bytes, &axis| bytes.checked_mul(axis)) != Some(data.len()) {
        let reason = format!("{} bytes of data for shape {:?} of {kind}", data.len(), header.shape);
        return Err(Problem::NotNpy(reason));
    }
    Ok((kind, header.shape))
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

    pub(super) fn add<T: WritableElement>(
        &mut self,
        key: &str,
        shape: &[usize],
        values: &[T],
    ) -> Result<(), Fault> {
        let options =
            SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
        let failed = |reason: String| (Place::Key(key.to_owned()), Problem::NotNpz(reason));
        let array =
            ArrayViewD::from_shape(IxDyn(shape), values).map_err(|error| failed(error.to_string()))?;
        self.zip.start_file(format!("{key}.npy"), options).map_err(|error| failed(error.to_string()))?;
        array.write_npy(&mut self.zip).map_err(|error| failed(error.to_string()))
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, Fault> {
        let bytes = self.zip.finish().map_err(|error| (Place::File, Problem::NotNpz(error.to_string())))?;
        Ok(bytes.into_inner())
    }
}
