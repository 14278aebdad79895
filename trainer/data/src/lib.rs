//! Logged motion: trajectories in memory, in `.npz`, `.csv`, `.mat`, `.mcap` and `.db3` files, and in data sets of LeRobot.
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
//! One of `t` and `h` is needed; both are written. Without `trajectory` the file is a single trajectory. For n = 1
//! arrays may be one-dimensional, and columns may be named `q`, `v`, `a`, `u`. Arrays may have any real element type,
//! byte order and memory order, compressed or not; an archive may unpack to 2²³ numbers plus 12 per byte of its size,
//! at most 2³⁰. CSV files have one header line; lines beginning with `#` are comments. Cells are separated by commas,
//! semicolons or tabs: the separator is the one with which the header line has the most known names. Decimal commas are
//! read unless the file suggests that they separate thousands. The text is UTF-8, or UTF-16 with a byte order mark. A
//! name that begins with `_` is ignored; any other unknown name is an error, so that a misspelt name is noticed.
//!
//! **MATLAB files** (`.mat`, version 5 to 7) have the arrays of an `.npz` file, without `control`; a structure's are `name.field`. Time runs
//! along the longer axis.
//!
//! **Bags of ROS 2** (`.mcap`, `.db3`, or the folder of a bag; `sensor_msgs/JointState`) are read only with named columns: `topic/joint/position`,
//! `velocity` or `effort`, at the stamps of their messages, in s from the first message. Columns of several topics, or
//! of several files of one recording ([`Join`]), are joined at the samples of the first coordinate. Positions,
//! velocities and linear controls of other clocks are interpolated linearly; held controls are averaged from sample to
//! sample. Samples are left out if another clock has a gap there, or does not run.
//!
//! **Data sets of LeRobot** (a folder with `meta/info.json`; version 2.0, 2.1 and 3.0) are read with the cargo feature `lerobot`, and only with
//! named columns: `observation.state.shoulder_pan.pos`, or `observation.state[0]`, is an element of a feature, and without an index the feature
//! gives all of them. Every episode is a trajectory. `t` need not be named: it is `timestamp`, and the step is 1/fps if the stamps say so too.
//!
//! **Columns with other names and units** are read through a [`Reading`] that names them ([`Columns`]); all other columns are then ignored.
//! [`read_logs`] makes one log of several files. Both resample uneven stamps, and all stamps if a step is given. The
//! new samples of a stretch without gaps lie at t₀, t₀ + h, …; positions, velocities and accelerations are interpolated
//! linearly, a held control is averaged over the step in which it acts, and a linear control is interpolated. An
//! interval of more than 2.5 steps and 2.5 median intervals is a gap. Short gaps are bridged if the motion shows that
//! nothing was lost: in stretches of the same length that have all their samples, interpolation is exact up to noise, and
//! the velocities before and after the gap agree with the motion across it. Of samples with the same stamp the first is
//! kept. Samples with late stamps (later than that of a sample that follows, or next to it) are left out, up to a fifth
//! of all. The default step is the shortest decimal number within half a percent of the mean step.
//!
//! **Control.** `control` states the behaviour of u between samples. `held`: u_k acts from t_k to t_{k+1}, as a
//! controller's output does; the last u of a trajectory is then unused. `linear`: u is linear from u_k to u_{k+1}, as a
//! force sensor sees it. If a file does not state it, the caller decides; the default is held.
//!
//! **Time.** Samples are uniform. A stated `h` is exact. Otherwise the step is the mean of the intervals that agree
//! with the median interval, taken as the shortest decimal number that the stamps cannot distinguish from this mean.
//! Every interval must be h, within 10⁻⁶ h plus the rounding of the stamps. This rounding is 4 ε max|t|, at most h/4,
//! with ε = 2⁻²⁴ if all stamps are single-precision numbers (or printed ones), else 2⁻⁵³.
//!
//! **Gaps.** An interval of several times h is a gap: the trajectory is split there, and its continuation gets a fresh
//! id above all others. A piece of fewer than 3 samples is left out. A [`Note`] reports both. Three equal intervals of
//! this kind in a row are not gaps but indicate another step, which is an error.
//!
//! **Angles** may be given within one turn, as encoders give them, in [−π, π], [0, 2π] or any other range. A file does not say which
//! coordinates are angles, so [`read`] leaves them as they are; [`Dataset::unwrap_angles`] removes the seams.

mod angles;
mod archive;
mod array_columns;
pub mod atomic;
mod bag;
mod bag_problem;
mod bridge;
pub mod checksummed;
mod column_problem;
mod columns;
mod control;
mod csv_clocks;
mod csv_columns;
mod csv_file;
mod csv_sheet;
mod csv_text;
mod dataset;
mod date;
mod doubts;
mod error;
mod in_order;
mod intervals;
mod join;
mod layout_note;
mod left_out;
mod lerobot;
mod lerobot_problem;
pub mod lock;
mod logs;
mod mat;
mod mat_elements;
mod mat_problem;
mod measured;
pub mod modlanet;
mod note;
mod npy;
mod npy_text;
mod npz;
mod place;
mod problem;
mod resample;
mod rows;
mod source;
pub mod survey;
pub mod symo;
mod table;
mod time;

use std::collections::BTreeMap;
use std::path::Path;

pub use bag::{JointSample, JointTopic};
pub use bag_problem::BagProblem;
pub use column_problem::ColumnProblem;
pub use columns::{Column, Columns, Term, UNITS, unit};
pub use control::{CONTROL_KINDS, control_name, control_of_name};
pub use dataset::{Dataset, MIN_SAMPLES, Trajectory};
pub use doubts::Doubt;
pub use error::DataError;
pub use layout_note::LayoutNote;
pub use lerobot_problem::LerobotProblem;
pub use logs::{Join, LeftOut, Reading, files, read_as, read_logs};
pub use mat_problem::MatProblem;
pub use measured::{Measured, read_measured};
pub use note::{Note, Resampled};
pub use place::Place;
pub use problem::Problem;
pub use rows::Rows;

use error::Fault;
use source::{Format, Source, format_of};

/// Reads a log in the format of its extension, `.npz`, `.csv` or `.mat`, with notes on the handling of gaps.
///
/// # Errors
/// [`DataError`] with the file, the place in it and the problem.
pub fn read(path: impl AsRef<Path>) -> Result<(Dataset, Vec<Note>), DataError> {
    let path = path.as_ref();
    located(path, || dataset(Source::open(path)?))
}

/// Reads a log as [`read`] does, from the content of a file; `path` gives the format and appears in errors.
///
/// # Errors
/// See [`read`].
pub fn decode(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(Dataset, Vec<Note>), DataError> {
    let path = path.as_ref();
    located(path, || dataset(Source::of(format_of(path)?, bytes)))
}

/// The data set in a file, without resampling.
fn dataset(source: Source<'_>) -> Result<(Dataset, Vec<Note>), Fault> {
    let (table, mut notes) = source.table(None)?;
    let (dataset, more) = table.into_dataset()?;
    notes.extend(more);
    Ok((dataset, notes))
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
            Ok(_) | Err(_) => return Err((Place::File, Problem::NotWritten)),
        };
        dataset.check()?;
        let bytes = write(dataset)?;
        store(path, &bytes)
    })
}

/// Writes joint states as an `.mcap` file of ROS 2, with messages of `sensor_msgs/msg/JointState` in CDR; the file is replaced atomically.
///
/// # Errors
/// [`DataError`]; also for a time that a stamp of ROS 2 cannot hold.
pub fn write_bag(path: impl AsRef<Path>, topics: &[JointTopic]) -> Result<(), DataError> {
    let path = path.as_ref();
    located(path, || store(path, &bag::encoded(topics)?))
}

fn store(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    crate::atomic::write(path, bytes).map_err(|error| (Place::File, error.into()))
}

fn located<T>(path: &Path, work: impl FnOnce() -> Result<T, Fault>) -> Result<T, DataError> {
    work().map_err(|(place, problem)| DataError { file: path.to_path_buf(), place, problem })
}
