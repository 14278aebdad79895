//! NPZ: a zip archive of NumPy arrays.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::archive::{Archive, Array};
use crate::error::Fault;
use crate::npy::{Element, Header};
use crate::place::Place;
use crate::problem::Problem;
use crate::table::{Origin, Table};
use crate::{Dataset, Rows, ShapedArray, control_name, control_of_name, npy_text};
use leastaction_core::forces::ControlKind;

const KNOWN: &str = "q, v, a, u, t, h, trajectory, control";

pub(crate) fn read(bytes: &[u8]) -> Result<Table, Fault> {
    let archive = Archive::open(bytes)?;
    archive.refuse_others(&["q", "v", "a", "u", "t", "h", "trajectory", "control"], KNOWN)?;
    let q = rows(archive.get("q")?, None)?.ok_or((Place::File, Problem::MissingPositions("the key q")))?;
    let like_q = Some((q.len(), q.width()));
    Ok(Table {
        v: rows(archive.get("v")?, like_q)?,
        a: rows(archive.get("a")?, like_q)?,
        u: rows(archive.get("u")?, like_q)?,
        t: column(archive.get("t")?, q.len())?.map(|t| t.reals()).transpose()?,
        h: scalar(archive.get("h")?)?.map(|h| (h, Place::Key("h".to_owned()))),
        trajectory: column(archive.get("trajectory")?, q.len())?.map(|ids| ids.integers()).transpose()?,
        control: control(&archive)?,
        origin: Origin::rows(),
        q,
    })
}

/// All arrays by name.
pub(crate) fn arrays(bytes: &[u8]) -> Result<BTreeMap<String, ShapedArray>, Fault> {
    let archive = Archive::open(bytes)?;
    let array = |key: &String| {
        let array = archive.get(key)?;
        array.map(|array| Ok((key.clone(), (array.shape().to_vec(), array.reals()?)))).transpose()
    };
    archive.keys().iter().filter_map(|key| array(key).transpose()).collect()
}

/// A field \[samples, n\], or \[samples\] if n = 1; its size must be `size`, if given.
fn rows(array: Option<Array<'_>>, size: Option<(usize, usize)>) -> Result<Option<Rows>, Fault> {
    let Some(array) = array else { return Ok(None) };
    match (array.samples_and_columns(), size) {
        (Some(found), Some((samples, n))) if found != (samples, n) => {
            Err(array.wrong_shape(format!("[{samples}, {n}] as of q")))
        }
        (Some((_, n)), _) => Ok(Rows::from_flat(n, array.reals()?)),
        (None, _) => Err(array.wrong_shape("[samples, n] with n ≥ 1".to_owned())),
    }
}

fn column(array: Option<Array<'_>>, samples: usize) -> Result<Option<Array<'_>>, Fault> {
    let fits = |array: &Array<'_>| [&[samples][..], &[samples, 1]].contains(&array.shape());
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

/// The control kind, if the archive states it.
fn control(archive: &Archive<'_>) -> Result<Option<ControlKind>, Fault> {
    let Some(name) = archive.text("control")? else { return Ok(None) };
    let kind = control_of_name(&name);
    kind.map(Some).ok_or_else(|| (Place::Key("control".to_owned()), Problem::Control(name)))
}

pub(crate) fn write(dataset: &Dataset) -> Result<Vec<u8>, Fault> {
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
    dataset.control.map_or(Ok(()), |kind| writer.add_text("control", control_name(kind)))?;
    writer.finish()
}

fn failed(key: &str, error: &dyn std::fmt::Display) -> Fault {
    (Place::Key(key.to_owned()), Problem::NotNpz(error.to_string()))
}

/// An archive under construction; equal arrays give equal bytes.
pub(crate) struct Writer {
    zip: ZipWriter<Cursor<Vec<u8>>>,
}

impl Writer {
    pub(crate) fn new() -> Self {
        Self { zip: ZipWriter::new(Cursor::new(Vec::new())) }
    }

    pub(crate) fn add<T: Element>(&mut self, key: &str, shape: &[usize], values: &[T]) -> Result<(), Fault> {
        self.start(key)?;
        let mut npy = Header::written(T::DESCRIPTOR, shape);
        values.iter().for_each(|value| value.append_to(&mut npy));
        self.zip.write_all(&npy).map_err(|error| failed(key, &error))
    }

    /// Adds a string.
    fn add_text(&mut self, key: &str, text: &str) -> Result<(), Fault> {
        self.start(key)?;
        self.zip.write_all(&npy_text::write(text)).map_err(|error| failed(key, &error))
    }

    fn start(&mut self, key: &str) -> Result<(), Fault> {
        let options =
            SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(true);
        self.zip.start_file(format!("{key}.npy"), options).map_err(|error| failed(key, &error))
    }

    pub(crate) fn finish(self) -> Result<Vec<u8>, Fault> {
        let bytes = self.zip.finish().map_err(|error| (Place::File, Problem::NotNpz(error.to_string())))?;
        Ok(bytes.into_inner())
    }
}
