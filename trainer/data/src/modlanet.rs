//! The layout of the ModLaNet authors' data sets (Lu et al., ICML 2022).
//!
//! One `.npz` file with two parts and no trajectory numbers. `x`, `v`, `ac`: \[rows, n\], positions, velocities and
//! accelerations. `t`, `E`: \[rows, 1\] or \[rows\], time since the start of the trajectory (s) and total energy (J),
//! both optional. The test part has the same arrays under `test_x` … . Any real element type is read, float64 is
//! written. Other arrays are ignored and not written.

use std::fs;
use std::ops::Range;
use std::path::Path;

use crate::archive::{Archive, Array};
use crate::dataset::{expect, finite};
use crate::error::{DataError, Fault};
use crate::npz::Writer;
use crate::place::Place;
use crate::problem::Problem;
use crate::{Dataset, Rows, Trajectory, located, store};

/// Rows of whole trajectories, one trajectory after another.
#[derive(Debug, Clone, PartialEq)]
pub struct ModlanetRows {
    /// Positions, \[rows\]\[n\] (m, rad).
    pub q: Rows,
    /// Velocities (m/s, rad/s).
    pub v: Rows,
    /// Accelerations (m/s², rad/s²).
    pub a: Rows,
    /// Time since the start of the trajectory (s), one for each row.
    pub t: Option<Vec<f64>>,
    /// Total energy (J), one for each row.
    pub energy: Option<Vec<f64>>,
}

/// The two parts of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct ModlanetSet {
    /// Training data.
    pub train: ModlanetRows,
    /// Test data: whole trajectories, none of them in `train`.
    pub test: ModlanetRows,
}

/// Keys of a part.
struct Keys {
    x: &'static str,
    v: &'static str,
    ac: &'static str,
    t: &'static str,
    energy: &'static str,
}

const TRAIN: Keys = Keys { x: "x", v: "v", ac: "ac", t: "t", energy: "E" };
const TEST: Keys = Keys { x: "test_x", v: "test_v", ac: "test_ac", t: "test_t", energy: "test_E" };

/// Reads a data set.
///
/// # Errors
/// [`DataError`] with the file, key and row, for an array that is missing, of the wrong shape, or not finite.
pub fn read(path: impl AsRef<Path>) -> Result<ModlanetSet, DataError> {
    let path = path.as_ref();
    located(path, || {
        let bytes = fs::read(path).map_err(|error| (Place::File, error.into()))?;
        let archive = Archive::open(&bytes)?;
        let set = ModlanetSet { train: read_part(&archive, &TRAIN)?, test: read_part(&archive, &TEST)? };
        same_width(&set)?;
        Ok(set)
    })
}

/// Writes the layout; the file is replaced atomically.
///
/// # Errors
/// [`DataError`]; also for a set that [`read`] would refuse.
pub fn write(path: impl AsRef<Path>, set: &ModlanetSet) -> Result<(), DataError> {
    let path = path.as_ref();
    located(path, || {
        let mut writer = Writer::new();
        add_part(&mut writer, &TRAIN, &set.train)?;
        add_part(&mut writer, &TEST, &set.test)?;
        same_width(set)?;
        store(path, &writer.finish()?)
    })
}

fn same_width(set: &ModlanetSet) -> Result<(), Fault> {
    let same = expect("q", "columns", set.test.q.width(), set.train.q.width());
    same.map_err(|problem| (Place::Key(TEST.x.to_owned()), problem))
}

fn read_part(archive: &Archive, keys: &Keys) -> Result<ModlanetRows, Fault> {
    let x = archive.require(keys.x)?;
    let (rows, n) = match *x.shape() {
        [rows, n] if rows > 0 && n > 0 => (rows, n),
        _ => return Err(x.wrong_shape("[rows, n] with at least one row and n ≥ 1".to_owned())),
    };
    let table = |array: &Array<'_>| {
        if array.shape() != [rows, n] {
            return Err(array.wrong_shape(format!("[{rows}, {n}] as of {}", keys.x)));
        }
        Rows::from_flat(n, array.finite_reals(n)?).ok_or((Place::File, Problem::Empty))
    };
    let column = |key| archive.get(key)?.map(|array| one_each(&array, rows)).transpose();
    Ok(ModlanetRows {
        q: table(&x)?,
        v: table(&archive.require(keys.v)?)?,
        a: table(&archive.require(keys.ac)?)?,
        t: column(keys.t)?,
        energy: column(keys.energy)?,
    })
}

fn one_each(array: &Array<'_>, rows: usize) -> Result<Vec<f64>, Fault> {
    if array.shape() != [rows, 1] && array.shape() != [rows] {
        return Err(array.wrong_shape(format!("[{rows}, 1], one for each row of x,")));
    }
    array.finite_reals(1)
}

fn add_part(writer: &mut Writer, keys: &Keys, part: &ModlanetRows) -> Result<(), Fault> {
    let (rows, n) = (part.q.len(), part.q.width());
    if rows == 0 {
        return Err((Place::Key(keys.x.to_owned()), Problem::Empty));
    }
    for (key, name, table) in [(keys.x, "q", &part.q), (keys.v, "v", &part.v), (keys.ac, "a", &part.a)] {
        let at = |problem| (Place::Key(key.to_owned()), problem);
        expect(name, "columns", table.width(), n).map_err(at)?;
        expect(name, "samples", table.len(), rows).map_err(at)?;
        finite(table.as_flat()).map_err(at)?;
        writer.add(key, &[rows, n], table.as_flat())?;
    }
    for (key, name, column) in [(keys.t, "t", &part.t), (keys.energy, "E", &part.energy)] {
        let at = |problem| (Place::Key(key.to_owned()), problem);
        let Some(column) = column else { continue };
        expect(name, "samples", column.len(), rows).map_err(at)?;
        finite(column).map_err(at)?;
        writer.add(key, &[rows, 1], column)?;
    }
    Ok(())
}

impl ModlanetRows {
    /// The samples of trajectories with v and a, noise included; `energy` computes the energy of each from (q, v).
    ///
    /// `None` if v or a is missing, or if there are no samples.
    #[must_use]
    pub fn from_dataset(data: &Dataset, energy: impl Fn(&[f64], &[f64]) -> f64) -> Option<Self> {
        let joined = |field: fn(&Trajectory) -> Option<&Rows>| {
            let tables: Option<Vec<&Rows>> = data.trajectories.iter().map(field).collect();
            let values: Vec<f64> = tables?.into_iter().flat_map(Rows::as_flat).copied().collect();
            Rows::from_flat(data.n, values).filter(|rows| !rows.is_empty())
        };
        let q = joined(|trajectory| Some(&trajectory.q))?;
        let v = joined(|trajectory| trajectory.v.as_ref())?;
        let a = joined(|trajectory| trajectory.a.as_ref())?;
        let t = data.trajectories.iter().flat_map(|trajectory| data.times(trajectory)).collect();
        let energy = q.iter().zip(&v).map(|(q, v)| energy(q, v)).collect();
        Some(Self { q, v, a, t: Some(t), energy: Some(energy) })
    }

    /// The rows at which trajectories begin: the first row, and every row whose time is not after that of the previous
    /// row. Without times there is only the first.
    #[must_use]
    pub fn starts(&self) -> Vec<usize> {
        let pairs = self.t.iter().flat_map(|t| t.windows(2)).zip(1..);
        let starts = pairs.filter(|(pair, _)| pair[1] <= pair[0]).map(|(_, row)| row);
        std::iter::once(0).chain(starts).collect()
    }

    /// The rows in a range.
    #[must_use]
    pub fn slice(&self, range: Range<usize>) -> Self {
        let part = |values: &Option<Vec<f64>>| {
            values.as_ref().and_then(|v| v.get(range.clone()).map(<[f64]>::to_vec))
        };
        Self {
            q: self.q.slice(range.clone()),
            v: self.v.slice(range.clone()),
            a: self.a.slice(range.clone()),
            t: part(&self.t),
            energy: part(&self.energy),
        }
    }

    /// Mean squared acceleration over rows and coordinates: the loss of a model that always predicts 0.
    #[must_use]
    pub fn mean_squared_acceleration(&self) -> f64 {
        let a = self.a.as_flat();
        a.iter().map(|a| a * a).sum::<f64>() / a.len() as f64
    }
}
