//! Problems in a file of logged motion.

use crate::bag_problem::BagProblem;
use crate::column_problem::ColumnProblem;
use crate::lerobot_problem::LerobotProblem;
use crate::mat_problem::MatProblem;
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Problem in a file. The message says what to do about it.
#[derive(Debug, Error)]
pub enum Problem {
    /// The operating system reported an error.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// A file that is neither `.npz`, `.csv`, `.mat`, `.mcap` nor `.db3`.
    #[error("unknown kind of file; name it .npz, .csv, .mat, .mcap or .db3")]
    Extension,
    /// A file to be written that is neither `.npz` nor `.csv`.
    #[error("logs are not written to files of this kind; name it .npz or .csv")]
    NotWritten,
    /// A problem with a bag of ROS 2.
    #[error(transparent)]
    Bag(#[from] BagProblem),
    /// A problem with a MATLAB file.
    #[error(transparent)]
    Mat(#[from] MatProblem),
    /// A problem with a data set of LeRobot.
    #[error(transparent)]
    Lerobot(Box<LerobotProblem>),
    /// A file whose name lacks the text to be replaced for a join.
    #[error("{part:?} is not in its name, so that nothing says which file {name:?} is; see [data.join]")]
    NoPartner {
        /// Text to be replaced in the name.
        part: String,
        /// Name of the join.
        name: String,
    },
    /// A file named under leave_out that is not among those read.
    #[error("leave_out under [data] names it, but the path of none of the {0} files that are read ends so")]
    NoSuchLog(usize),
    /// A log whose samples are all left out.
    #[error("no samples are left outside the intervals of leave_out under [data]; 3 in a row are needed")]
    AllLeftOut,
    /// Clocks of one recording that do not overlap.
    #[error(
        "of {samples} samples of the coordinates {shared} lie where all other columns have some too; do the stamps of all of them \
         come from one clock?"
    )]
    NoOverlap {
        /// Samples of the coordinates.
        samples: usize,
        /// Samples for which all columns have data.
        shared: usize,
    },
    /// An unreadable zip archive.
    #[error("not a readable .npz file ({0}); write it again, with numpy.savez(path, q=..., t=...)")]
    NotNpz(String),
    /// An unreadable array.
    #[error("not a readable array ({0}); write it again, as plain numbers")]
    NotNpy(String),
    /// An archive that unpacks to more than is plausible for its size.
    #[error(
        "with this array the file holds more than the {most} numbers that are read of one of its size; if it is sound, write it with \
         numpy.savez, which does not compress, or leave samples out"
    )]
    TooLarge {
        /// Numbers in this array.
        numbers: u64,
        /// Limit for all arrays that are read together.
        most: u64,
    },
    /// An element type other than real numbers.
    #[error("elements are of type {0}; store float64, float32 or integers")]
    ElementType(String),
    /// Malformed CSV.
    #[error("{0}; write comma-separated values with one header line")]
    NotCsv(String),
    /// A CSV file that is not text.
    #[error("not readable as text ({0}); save it as UTF-8")]
    NotText(&'static str),
    /// No sample at all.
    #[error("no samples; at least 3 of them make a trajectory")]
    Empty,
    /// No positions.
    #[error("no positions; {0} is needed")]
    MissingPositions(&'static str),
    /// No indication of the time between samples.
    #[error("no time; give the stamps t or the step h ({0})")]
    MissingTime(&'static str),
    /// A missing array of the layout.
    #[error("{0} is missing")]
    MissingKey(&'static str),
    /// A missing column of a field.
    #[error("column {column} is missing; {field} needs {n} columns, {field}0 to {field}{}", n - 1)]
    MissingColumn {
        /// Name of the missing column.
        column: String,
        /// Letter of the field: q, v, a or u.
        field: &'static str,
        /// Number of columns that the field needs.
        n: usize,
    },
    /// A name that is not in the layout.
    #[error(
        "{name:?} is not a known name; known are {known}; rename it, or put _ before it to have it ignored"
    )]
    UnknownName {
        /// Name in the file.
        name: String,
        /// Names of the layout.
        known: &'static str,
    },
    /// A column that the configuration names but the file lacks.
    #[error("there is no column {name:?}; the file has {}", list(known))]
    NoColumn {
        /// Configured name.
        name: String,
        /// Names in the file.
        known: Vec<String>,
    },
    /// A problem with the columns that a configuration names.
    #[error(transparent)]
    Column(#[from] ColumnProblem),
    /// Files with different steps that are to be read as one log.
    #[error("the step is {found} s where {} has {expected} s; name one for all of them: step under [data]", first.display())]
    OtherStep {
        /// Step of this file (s).
        found: f64,
        /// Step of the first file (s).
        expected: f64,
        /// The first file.
        first: PathBuf,
    },
    /// Files with different numbers of coordinates that are to be read as one log.
    #[error("there are {found} coordinates where {} has {expected}", first.display())]
    OtherCoordinates {
        /// Coordinates in this file.
        found: usize,
        /// Coordinates in the first file.
        expected: usize,
        /// The first file.
        first: PathBuf,
    },
    /// Files that disagree on the control.
    #[error("u is {found} between samples where {} has it {expected}; say control under [data]", first.display())]
    OtherControl {
        /// Control kind of this file.
        found: &'static str,
        /// Control kind of the first file.
        expected: &'static str,
        /// The first file.
        first: PathBuf,
    },
    /// A pattern that matches no file.
    #[error("no file is called so")]
    NoFile,
    /// An invalid pattern.
    #[error("not a pattern of file names: {0}")]
    Pattern(String),
    /// A duplicate name.
    #[error("{0} stands twice; remove one")]
    Duplicate(String),
    /// An array with the wrong shape.
    #[error("shape {found:?} where {expected} is needed")]
    Shape {
        /// Shape of the array.
        found: Vec<usize>,
        /// Expected shape, in words.
        expected: String,
    },
    /// A line with too few or too many cells.
    #[error("{found} cells where the header names {expected} columns")]
    CellCount {
        /// Cells in the line.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// Twice as many cells as columns, as in a line with both decimal and separating commas.
    #[error(
        "{found} cells where the header names {expected} columns; if they are decimal commas, write points, or separate the columns by \
         semicolons"
    )]
    CommaSeparates {
        /// Cells in the line.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// Text that is not a number.
    #[error("{0:?} is not a number; write 1.5 or -2e-3")]
    NotNumber(String),
    /// A number whose comma may be a decimal comma or separate thousands.
    #[error(
        "the comma of {0:?} may be a decimal one or separate thousands; write decimal points and no thousands separators"
    )]
    Comma(String),
    /// A number that is not an integer, as a trajectory's id must be.
    #[error("{0} is not a whole number that fits 64 bits")]
    NotInteger(String),
    /// An array that should be one string.
    #[error("elements of type {kind} in shape {shape:?}; store one string")]
    NotString {
        /// Type of the elements.
        kind: String,
        /// Shape of the array.
        shape: Vec<usize>,
    },
    /// A word that is not a kind of control.
    #[error("{0:?} is not what u does between samples; write \"held\" or \"linear\", or leave control out")]
    Control(String),
    /// NaN or infinite.
    #[error("{0} is not finite; remove the sample (a gap in t splits the trajectory there)")]
    NotFinite(f64),
    /// Time that does not increase.
    #[error("time goes from {before} to {after} s; sort the samples, or number the trajectories")]
    Unsorted {
        /// Stamp of the sample before (s).
        before: f64,
        /// Stamp at this place (s).
        after: f64,
    },
    /// An interval that is neither the step nor a multiple of it.
    #[error("an interval of {found} s where the step is {expected} s; resample to one step")]
    ChangingStep {
        /// Time since the previous sample (s).
        found: f64,
        /// Step elsewhere (s).
        expected: f64,
    },
    /// Stamps that contradict the stated step.
    #[error("h is {stated} s but the stamps t are {measured} s apart; remove the wrong one")]
    StepMismatch {
        /// Stated step (s).
        stated: f64,
        /// Median interval (s).
        measured: f64,
    },
    /// Stamps whose rounding is too coarse for the step.
    #[error(
        "the stamps are rounded by {rounding} s, too much for a step of {h} s; let t start near 0, in float64"
    )]
    CoarseTime {
        /// Rounding error of the difference of two stamps (s).
        rounding: f64,
        /// Step (s).
        h: f64,
    },
    /// A step that is not a positive number.
    #[error("the step h is {0} s; it must be positive and finite")]
    BadStep(f64),
    /// A resampling step far below the interval between samples.
    #[error("a step of {h} s is less than a tenth of the {median:.3e} s between samples; name a longer one")]
    FineStep {
        /// Requested step (s).
        h: f64,
        /// Median interval (s).
        median: f64,
    },
    /// A trajectory that is too short for the discrete Euler–Lagrange equation.
    #[error("trajectory {id} has {samples} samples; at least 3 are needed")]
    TooShort {
        /// Id of the trajectory.
        id: i64,
        /// Number of its samples.
        samples: usize,
    },
    /// A trajectory whose samples are not contiguous.
    #[error("trajectory {0} was left and comes again; keep its samples together, or number it anew")]
    Scattered(i64),
    /// Two trajectories in memory with the same id.
    #[error("trajectory {0} is there twice; number the trajectories differently")]
    SameId(i64),
    /// Trajectories in memory that disagree.
    #[error("{name} has {found} {what} where {expected} are needed")]
    Inconsistent {
        /// q, v, a or u.
        name: &'static str,
        /// "columns", "samples" or "rows".
        what: &'static str,
        /// Actual number.
        found: usize,
        /// Expected number.
        expected: usize,
    },
    /// A field v, a or u that only some trajectories have.
    #[error("{0} is given for some trajectories only; give it for all or none")]
    Partial(&'static str),
    /// A nonzero control that the layout cannot store.
    #[error("u is not 0 at coordinate {0}; this layout stores the control of the actuated coordinate only")]
    SecondControl(usize),
    /// A kind of control that the layout cannot store.
    #[error(
        "u is held between samples; this layout stores a control that is linear between them, or constant"
    )]
    HeldControl,
    /// An actuated coordinate out of range.
    #[error("coordinate {index} cannot be the actuated one of {n}; it is counted from 0")]
    BadActuated {
        /// Given index.
        index: usize,
        /// Number of coordinates.
        n: usize,
    },
}

impl From<LerobotProblem> for Problem {
    fn from(problem: LerobotProblem) -> Self {
        Self::Lerobot(Box::new(problem))
    }
}

/// A list of names, cut after the first dozen.
pub(crate) fn list(names: &[String]) -> String {
    const MOST: usize = 12;
    let shown = names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown}, … ({} in all)", names.len()) } else { shown }
}
