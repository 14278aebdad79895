//! Logged motion: trajectories in memory and in `.npz`, `.csv` and `.mcap` files.
//!
//! | name | `.npz` array | `.csv` columns | unit |
//! |---|---|---|---|
//! | `q` | \[samples, n\] | `q0` … `q{n-1}` | m, rad (angles may be within one turn, see below) |
//! | `v` | as q, optional | `v0` … | m/s, rad/s |
//! | `a` | as q, optional | `a0` … | m/s², rad/s² |
//! | `u` | as q, optional | `u0` … | N, N·m: generalised force; 0 where there is no actuator |
//! | `t` | \[samples\] | `t` | s |
//! | `h` | one number | comment line `# h = 0.05` above the header | s |
//! | `trajectory` | \[samples\], integer | `trajectory` | |
//! | `control` | `"held"` or `"linear"`, optional | comment line `# control = held` above the header | |
//!
//! One of `t` and `h` is needed; both are written. Without `trajectory` the file is a single trajectory. For n = 1 arrays may be
//! one-dimensional, and columns may be named `q`, `v`, `a`, `u`. Arrays may have any real element type, byte order and memory order,
//! compressed or not; an archive may unpack to 2²³ numbers plus 12 for each of its bytes, but to no more than 2³⁰. CSV files have one
//! header line; lines beginning with `#` are comments. Cells are separated by commas, semicolons or tabs, whichever makes names of the
//! header line; decimal commas are read unless something in the file suggests that they separate thousands. The text is UTF-8, or UTF-16
//! with a byte order mark. A name that begins with `_` is ignored; any other unknown name is an error, so that a misspelt one is not
//! silently lost.
//!
//! **Bags of ROS 2** (`.mcap`, `sensor_msgs/JointState`) are read only by names of columns: `topic/joint/position`, `velocity` or `effort`,
//! at the stamps of their messages, in s from the first message. Columns of several topics, or of several files of one recording
//! ([`Join`]), are joined: the samples are those of the first coordinate; from other clocks positions, velocities and linear controls are
//! interpolated linearly, and held controls are averaged from sample to sample; samples are left out if another clock has a gap there, or
//! does not run.
//!
//! **Columns with other names and units** are read through a [`Reading`] that names them ([`Columns`]); all other columns are then ignored.
//! [`read_logs`] makes one log of several files. Both resample uneven stamps, and all stamps if a step is given: the new samples of a
//! stretch without gaps lie at t₀, t₀ + h, …; positions, velocities and accelerations are interpolated linearly, a held control is averaged
//! over the step in which it acts, a linear one is interpolated. An interval of more than 2.5 steps and 2.5 median intervals is a gap; of
//! samples with the same stamp the first is kept. The default step is the shortest decimal number within half a percent of the mean step.
//!
//! **Control.** `control` states the behaviour of u between samples. `held`: u_k acts from t_k to t_{k+1}, as a controller's output does;
//! the last u of a trajectory is then unused. `linear`: u is linear from u_k to u_{k+1}, as a force sensor sees it. A file need not state
//! it; the reader then decides, and takes it as held by default.
//!
//! **Time.** Samples are uniform. A stated `h` is exact. Otherwise the step is the mean of the intervals that agree with the median one,
//! taken as the shortest decimal number that the stamps cannot tell from it. Every interval must be h, to 10⁻⁶ of it plus the rounding of
//! the stamps, which is 4 ε max|t|, at most h/4, with ε = 2⁻²⁴ if all stamps are single-precision numbers (or printed ones), else 2⁻⁵³.
//!
//! **Gaps.** An interval of several times h is a gap: the trajectory is split there, its continuation gets a fresh id above all others, a
//! piece of fewer than 3 samples is left out, and a [`Note`] reports both. Three equal such intervals in a row are not gaps but another
//! step, which is an error.
//!
//! **Angles** may be given within one turn, as encoders give them, in [−π, π], [0, 2π] or any other range. A file does not say which
//! coordinates are angles, so [`read`] leaves them as they are; [`Dataset::unwrap_angles`] removes the seams.

mod angles;
mod archive;
pub mod atomic;
mod bag;
pub mod checksummed;
mod columns;
mod control;
mod csv_file;
mod csv_text;
mod doubts;
mod error;
mod intervals;
mod join;
mod left_out;
pub mod lock;
mod logs;
mod measured;
pub mod modlanet;
mod note;
mod npy;
mod npy_text;
mod npz;
mod npz_columns;
mod place;
mod resample;
mod rows;
mod source;
pub mod survey;
pub mod symo;
mod table;
mod time;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

pub use columns::{Column, Columns, UNITS, unit};
pub use control::{CONTROL_KINDS, control_name, control_of_name};
pub use doubts::Doubt;
pub use error::{DataError, Problem};
pub use logs::{Join, LeftOut, Reading, files, read_as, read_logs};
pub use measured::{Measured, read_measured};
pub use note::{Note, Resampled};
pub use place::Place;
pub use rows::Rows;

use error::Fault;
use leastaction_core::forces::ControlKind;
use source::{Format, Source, format_of};

/// Least number of samples in a trajectory: one discrete Euler–Lagrange equation.
pub const MIN_SAMPLES: usize = 3;

/// One uninterrupted, uniformly sampled motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Number in the file; unique in a data set.
    pub id: i64,
    /// Time of the first sample (s).
    pub t0: f64,
    /// Generalised coordinates, \[samples\]\[n\] (m, rad).
    pub q: Rows,
    /// Velocities (m/s, rad/s).
    pub v: Option<Rows>,
    /// Accelerations (m/s², rad/s²).
    pub a: Option<Rows>,
    /// Controls as generalised forces (N, N·m). If they are held, the last row is unused: no step follows it.
    pub u: Option<Rows>,
}

impl Trajectory {
    /// Number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.q.len()
    }

    /// Consecutive samples of a trajectory with step h (s); samples beyond the last are left out.
    #[must_use]
    pub fn part(&self, samples: Range<usize>, h: f64) -> Self {
        let rows: Vec<usize> = samples.clone().collect();
        let of = |field: &Rows| field.select(&rows);
        Self {
            id: self.id,
            t0: self.t0 + samples.start as f64 * h,
            q: of(&self.q),
            v: self.v.as_ref().map(of),
            a: self.a.as_ref().map(of),
            u: self.u.as_ref().map(of),
        }
    }

    /// Fields with their names in files.
    fn fields(&self) -> [(&'static str, Option<&Rows>); 4] {
        [("q", Some(&self.q)), ("v", self.v.as_ref()), ("a", self.a.as_ref()), ("u", self.u.as_ref())]
    }

    fn check(&self, n: usize) -> Result<(), Problem> {
        let samples = self.samples();
        if samples < MIN_SAMPLES {
            return Err(Problem::TooShort { id: self.id, samples });
        }
        for (name, rows) in self.fields().into_iter().filter_map(|(name, rows)| Some((name, rows?))) {
            expect(name, "columns", rows.width(), n)?;
            expect(name, "samples", rows.len(), samples)?;
            finite(rows.as_flat())?;
        }
        finite(&[self.t0])
    }
}

fn expect(name: &'static str, what: &'static str, found: usize, expected: usize) -> Result<(), Problem> {
    if found == expected { Ok(()) } else { Err(Problem::Inconsistent { name, what, found, expected }) }
}

fn finite(values: &[f64]) -> Result<(), Problem> {
    values.iter().find(|x| !x.is_finite()).map_or(Ok(()), |&x| Err(Problem::NotFinite(x)))
}

/// Trajectories of one mechanism, all with the same number of coordinates n and step h.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    /// Number of coordinates.
    pub n: usize,
    /// Time between samples (s).
    pub h: f64,
    /// Control kind, if the file states it.
    pub control: Option<ControlKind>,
    /// The motions, in the order of the file.
    pub trajectories: Vec<Trajectory>,
}

impl Dataset {
    /// Number of samples in all trajectories together.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.trajectories.iter().map(Trajectory::samples).sum()
    }

    /// Whether a control other than zero acts on any sample.
    #[must_use]
    pub fn is_forced(&self) -> bool {
        let forced = |t: &Trajectory| t.u.as_ref().is_some_and(|u| u.as_flat().iter().any(|u| *u != 0.0));
        self.trajectories.iter().any(forced)
    }

    /// The control kind; held unless stated otherwise.
    #[must_use]
    pub fn control_kind(&self) -> ControlKind {
        self.control.unwrap_or_default()
    }

    /// The sample whose u acts at the end of the step from sample `k`; u is linear in between.
    #[must_use]
    pub fn control_end(&self, k: usize) -> usize {
        match self.control_kind() {
            ControlKind::Held => k,
            ControlKind::Linear => k + 1,
        }
    }

    /// Whether u changes during any trajectory, so that its behaviour between samples matters.
    #[must_use]
    pub fn control_changes(&self) -> bool {
        let changes = |u: &Rows| u.iter().skip(1).any(|row| u.iter().next() != Some(row));
        self.trajectories.iter().any(|t| t.u.as_ref().is_some_and(changes))
    }

    /// Sets the control kind.
    ///
    /// # Errors
    /// The control kind of the file, if it differs and u changes.
    pub fn set_control(&mut self, kind: ControlKind) -> Result<(), ControlKind> {
        match self.control {
            Some(stated) if stated != kind && self.control_changes() => Err(stated),
            _ => {
                self.control = Some(kind);
                Ok(())
            }
        }
    }

    /// The first `k` trajectories, or all if there are fewer.
    #[must_use]
    pub fn truncated(&self, k: usize) -> Self {
        self.split(k).0
    }

    /// The first `k` trajectories and the rest.
    #[must_use]
    pub fn split(&self, k: usize) -> (Self, Self) {
        let (first, rest) = self.trajectories.split_at(k.min(self.trajectories.len()));
        (self.with(first.to_vec()), self.with(rest.to_vec()))
    }

    /// The stamps of a trajectory, t₀ + k h (s).
    pub fn times<'a>(&self, trajectory: &'a Trajectory) -> impl Iterator<Item = f64> + use<'a> {
        let (t0, h) = (trajectory.t0, self.h);
        (0..trajectory.samples()).map(move |k| t0 + k as f64 * h)
    }

    fn with(&self, trajectories: Vec<Trajectory>) -> Self {
        Self { trajectories, ..*self }
    }

    /// Refuses a data set that [`read`] would refuse.
    fn check(&self) -> Result<(), Fault> {
        positive(self.h).map_err(|problem| (Place::File, problem))?;
        if self.trajectories.is_empty() {
            return Err((Place::File, Problem::Empty));
        }
        let mut ids = std::collections::HashSet::new();
        for trajectory in &self.trajectories {
            let at = |problem| (Place::Trajectory(trajectory.id), problem);
            trajectory.check(self.n).map_err(at)?;
            time::check(&self.times(trajectory).collect::<Vec<_>>(), self.h).map_err(at)?;
            if !ids.insert(trajectory.id) {
                return Err(at(Problem::SameId(trajectory.id)));
            }
        }
        self.fields_everywhere()
    }

    fn fields_everywhere(&self) -> Result<(), Fault> {
        for (i, name) in ["v", "a", "u"].into_iter().enumerate() {
            let given = self.trajectories.iter().filter(|t| t.fields()[i + 1].1.is_some()).count();
            if given != 0 && given != self.trajectories.len() {
                return Err((Place::File, Problem::Partial(name)));
            }
        }
        Ok(())
    }
}

fn positive(h: f64) -> Result<(), Problem> {
    if h.is_finite() && h > 0.0 { Ok(()) } else { Err(Problem::BadStep(h)) }
}

/// Reads a log in the format of its extension, `.npz` or `.csv`, with notes on the handling of gaps.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem.
pub fn read(path: impl AsRef<Path>) -> Result<(Dataset, Vec<Note>), DataError> {
    let path = path.as_ref();
    located(path, || Source::open(path)?.table()?.into_dataset())
}

/// Reads a log as [`read`] does, from the content of a file; `path` gives the format and appears in errors.
///
/// # Errors
/// See [`read`].
pub fn decode(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(Dataset, Vec<Note>), DataError> {
    let path = path.as_ref();
    located(path, || Source::of(format_of(path)?, bytes).table()?.into_dataset())
}

/// Reads a log as [`read_as`] does, from the content of a file; `path` gives the format and appears in errors. No other files are joined.
///
/// # Errors
/// See [`read_as`].
pub fn decode_as(
    path: impl AsRef<Path>,
    bytes: &[u8],
    reading: &Reading,
) -> Result<(Dataset, Vec<Note>), DataError> {
    let path = path.as_ref();
    located(path, || logs::even(Source::of(format_of(path)?, bytes), reading, path))
}

/// Shape of an array, and its numbers in row-major order.
pub type ShapedArray = (Vec<usize>, Vec<f64>);

/// Reads the arrays of numbers in an `.npz` archive by name, of any element type, for data other than logged motion.
///
/// # Errors
/// [`DataError`] with the key, also for an array of anything but numbers.
pub fn read_arrays(path: impl AsRef<Path>) -> Result<BTreeMap<String, ShapedArray>, DataError> {
    let path = path.as_ref();
    located(path, || npz::arrays(&std::fs::read(path).map_err(|error| (Place::File, error.into()))?))
}

/// Writes a data set in the format of the extension, `.npz` or `.csv`; the file is replaced atomically.
///
/// [`read`] restores the same bits.
///
/// # Errors
/// [`DataError`]; also for a data set that [`read`] would refuse.
pub fn write(path: impl AsRef<Path>, dataset: &Dataset) -> Result<(), DataError> {
    let path = path.as_ref();
    located(path, || {
        let write = match format_of(path) {
            Ok(Format::Npz) => npz::write,
            Ok(Format::Csv) => csv_file::write,
            Ok(Format::Mcap) | Err(_) => return Err((Place::File, Problem::NotWritten)),
        };
        dataset.check()?;
        let bytes = write(dataset)?;
        store(path, &bytes)
    })
}

fn store(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    crate::atomic::write(path, bytes).map_err(|error| (Place::File, error.into()))
}

fn located<T>(path: &Path, work: impl FnOnce() -> Result<T, Fault>) -> Result<T, DataError> {
    work().map_err(|(place, problem)| DataError { file: path.to_path_buf(), place, problem })
}
