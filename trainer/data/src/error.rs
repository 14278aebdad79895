//! What can be wrong with a file of logged motion, and where.

use std::io;
use std::path::PathBuf;

use crate::place::Place;
use thiserror::Error;

/// A file that could not be read or written as logged motion.
#[derive(Debug, Error)]
#[error("{}{place}: {problem}", file.display())]
pub struct DataError {
    /// The file.
    pub file: PathBuf,
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong. The message says what to do about it.
#[derive(Debug, Error)]
pub enum Problem {
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// Neither `.npz`, `.csv` nor `.mcap`.
    #[error("unknown kind of file; name it .npz, .csv or .mcap")]
    Extension,
    /// A file to be written that is neither `.npz` nor `.csv`.
    #[error("logs are not written to files of this kind; name it .npz or .csv")]
    NotWritten,
    /// A `.mcap` file without names of columns.
    #[error(
        "which joints are the coordinates? Name them under [data.columns]; `leastaction look` lists them and writes a configuration"
    )]
    Unnamed,
    /// Not a readable MCAP file.
    #[error(
        "not a readable .mcap file: {0}; what is sound of a recording that was cut off can be saved by `mcap recover`"
    )]
    NotMcap(String),
    /// A chunk of an MCAP file that claims to unpack to too much.
    #[error(
        "a chunk says that it unpacks to {bytes} bytes; at most {most} are read: write the file with smaller chunks"
    )]
    LargeChunk {
        /// As it says.
        bytes: u64,
        /// That are read.
        most: u64,
    },
    /// An MCAP file that unpacks to more than an honest one of its size.
    #[error(
        "its chunks unpack to {bytes} bytes up to here, more than the {most} that are read of a file of its size"
    )]
    Unpacked {
        /// Up to here.
        bytes: u64,
        /// That are read.
        most: u64,
    },
    /// A chunk of an MCAP file that is compressed in a way that is not known here.
    #[error("a chunk is compressed by {0:?}; zstd, lz4 and none are read: `mcap compress` writes them")]
    Compression(String),
    /// A message that is not what its schema says.
    #[error("not a sensor_msgs/JointState in CDR: {0}")]
    NotJointState(&'static str),
    /// An MCAP file without what is read of one.
    #[error("no messages of sensor_msgs/JointState in CDR, as ROS 2 writes them; the file has {}", list(.0))]
    NoJointStates(Vec<String>),
    /// A message that has some of the joints of its topic that are wanted.
    #[error(
        "{0} is missing, though other columns of this topic are there; name joints that are sent together"
    )]
    MissingJoint(String),
    /// A time of recording beyond those that are known.
    #[error("it was recorded {0} ns after 1970, which no clock says")]
    BadTime(u64),
    /// A file whose partner has another name than the configuration says.
    #[error("{part:?} is not in its name, so that nothing says which file {name:?} is; see [data.join]")]
    NoPartner {
        /// What is to be replaced in the name.
        part: String,
        /// Of the join.
        name: String,
    },
    /// A file named under leave_out that is not read.
    #[error("leave_out under [data] names it, but the path of none of the {0} files that are read ends so")]
    NoSuchLog(usize),
    /// A log whose samples are all in intervals to leave out.
    #[error("no samples are left outside the intervals of leave_out under [data]; 3 in a row are needed")]
    AllLeftOut,
    /// Clocks of one recording that never ran together.
    #[error(
        "of {samples} samples of the coordinates {shared} lie where all other columns have some too; do the stamps of all of them \
         come from one clock?"
    )]
    NoOverlap {
        /// Of the coordinates.
        samples: usize,
        /// Where everything is there.
        shared: usize,
    },
    /// Not a readable zip archive.
    #[error("not a readable .npz file ({0}); write it again, with numpy.savez(path, q=..., t=...)")]
    NotNpz(String),
    /// Not a readable array.
    #[error("not a readable array ({0}); write it again, as plain numbers")]
    NotNpy(String),
    /// An archive that unpacks to more than an honest one of its size.
    #[error(
        "with this array the file holds more than the {most} numbers that are read of one of its size; if it is sound, write it with \
         numpy.savez, which does not compress, or leave samples out"
    )]
    TooLarge {
        /// Of this array.
        numbers: u64,
        /// Of all arrays that are read together.
        most: u64,
    },
    /// An element type that is not a real number.
    #[error("elements are of type {0}; store float64, float32 or integers")]
    ElementType(String),
    /// Broken CSV.
    #[error("{0}; write comma-separated values with one header line")]
    NotCsv(String),
    /// A CSV file that is no text.
    #[error("not readable as text ({0}); save it as UTF-8")]
    NotText(&'static str),
    /// No sample at all.
    #[error("no samples; at least 3 of them make a trajectory")]
    Empty,
    /// No positions.
    #[error("no positions; {0} is needed")]
    MissingPositions(&'static str),
    /// Nothing says how far the samples are apart.
    #[error("no time; give the stamps t or the step h ({0})")]
    MissingTime(&'static str),
    /// An array of the layout that is not there.
    #[error("{0} is missing")]
    MissingKey(&'static str),
    /// A column between others that is not there.
    #[error("column {column} is missing; {field} needs {n} columns, {field}0 to {field}{}", n - 1)]
    MissingColumn {
        /// The missing name.
        column: String,
        /// Its letter: q, v, a or u.
        field: &'static str,
        /// How many columns the letter needs.
        n: usize,
    },
    /// A name outside the layout.
    #[error(
        "{name:?} is not a known name; known are {known}; rename it, or put _ before it to have it ignored"
    )]
    UnknownName {
        /// The name as it stands.
        name: String,
        /// The names of the layout.
        known: &'static str,
    },
    /// A column that the configuration names and the file does not have.
    #[error("there is no column {name:?}; the file has {}", list(known))]
    NoColumn {
        /// As configured.
        name: String,
        /// Of the file.
        known: Vec<String>,
    },
    /// An array without such a column.
    #[error("there is no column {index}; it has {found}, counted from 0")]
    NoIndex {
        /// As configured.
        index: usize,
        /// Columns of the array.
        found: usize,
    },
    /// Files of different steps that are to be read as one log.
    #[error("the step is {found} s where {} has {expected} s; name one for all of them: step under [data]", first.display())]
    OtherStep {
        /// Of this file (s).
        found: f64,
        /// Of the first one (s).
        expected: f64,
        /// The first file.
        first: PathBuf,
    },
    /// Files of different numbers of coordinates that are to be read as one log.
    #[error("there are {found} coordinates where {} has {expected}", first.display())]
    OtherCoordinates {
        /// Of this file.
        found: usize,
        /// Of the first one.
        expected: usize,
        /// The first file.
        first: PathBuf,
    },
    /// Files that say different things of the control.
    #[error("u is {found} between samples where {} has it {expected}; say control under [data]", first.display())]
    OtherControl {
        /// Of this file.
        found: &'static str,
        /// Of the first one.
        expected: &'static str,
        /// The first file.
        first: PathBuf,
    },
    /// A pattern that no file matches.
    #[error("no file is called so")]
    NoFile,
    /// A pattern that is none.
    #[error("not a pattern of file names: {0}")]
    Pattern(String),
    /// A name that stands twice.
    #[error("{0} stands twice; remove one")]
    Duplicate(String),
    /// An array of the wrong shape.
    #[error("shape {found:?} where {expected} is needed")]
    Shape {
        /// Of the array.
        found: Vec<usize>,
        /// In words.
        expected: String,
    },
    /// A line with too few or too many cells.
    #[error("{found} cells where the header names {expected} columns")]
    CellCount {
        /// In the line.
        found: usize,
        /// In the header.
        expected: usize,
    },
    /// Twice as many cells as columns, as decimal commas make of a line that commas separate.
    #[error(
        "{found} cells where the header names {expected} columns; if they are decimal commas, write points, or separate the columns by \
         semicolons"
    )]
    CommaSeparates {
        /// In the line.
        found: usize,
        /// In the header.
        expected: usize,
    },
    /// Text that is no number.
    #[error("{0:?} is not a number; write 1.5 or -2e-3")]
    NotNumber(String),
    /// A number whose comma may be a decimal comma or separate thousands.
    #[error(
        "the comma of {0:?} may be a decimal one or separate thousands; write decimal points and no thousands separators"
    )]
    Comma(String),
    /// A number that is no whole one, as a trajectory's id must be.
    #[error("{0} is not a whole number that fits 64 bits")]
    NotInteger(String),
    /// An array that should be one string.
    #[error("elements of type {kind} in shape {shape:?}; store one string")]
    NotString {
        /// Of its elements.
        kind: String,
        /// Of the array.
        shape: Vec<usize>,
    },
    /// A word that is no kind of control.
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
    /// An interval that is not the step nor a multiple of it.
    #[error("an interval of {found} s where the step is {expected} s; resample to one step")]
    ChangingStep {
        /// Since the sample before (s).
        found: f64,
        /// Everywhere else (s).
        expected: f64,
    },
    /// Stamps that contradict the stated step.
    #[error("h is {stated} s but the stamps t are {measured} s apart; remove the wrong one")]
    StepMismatch {
        /// As written (s).
        stated: f64,
        /// Median interval (s).
        measured: f64,
    },
    /// Stamps whose rounding hides the step.
    #[error(
        "the stamps are rounded by {rounding} s, too much for a step of {h} s; let t start near 0, in float64"
    )]
    CoarseTime {
        /// What two stamps may be off (s).
        rounding: f64,
        /// The step (s).
        h: f64,
    },
    /// A step that is not a positive number.
    #[error("the step h is {0} s; it must be positive and finite")]
    BadStep(f64),
    /// A step to resample onto that is far below the interval between samples.
    #[error("a step of {h} s is less than a tenth of the {median:.3e} s between samples; name a longer one")]
    FineStep {
        /// As wanted (s).
        h: f64,
        /// Of the intervals (s).
        median: f64,
    },
    /// A trajectory the discrete Euler-Lagrange equation cannot use.
    #[error("trajectory {id} has {samples} samples; at least 3 are needed")]
    TooShort {
        /// Of the trajectory.
        id: i64,
        /// It has.
        samples: usize,
    },
    /// A trajectory whose samples do not stand together.
    #[error("trajectory {0} was left and comes again; keep its samples together, or number it anew")]
    Scattered(i64),
    /// Two trajectories of one id, side by side in memory.
    #[error("trajectory {0} is there twice; number the trajectories differently")]
    SameId(i64),
    /// Trajectories in memory that disagree.
    #[error("{name} has {found} {what} where {expected} are needed")]
    Inconsistent {
        /// q, v, a or u.
        name: &'static str,
        /// Columns or samples.
        what: &'static str,
        /// There are.
        found: usize,
        /// There should be.
        expected: usize,
    },
    /// v, a or u in some trajectories only.
    #[error("{0} is given for some trajectories only; give it for all or none")]
    Partial(&'static str),
    /// A control the layout has no room for.
    #[error("u is not 0 at coordinate {0}; this layout stores the control of the actuated coordinate only")]
    SecondControl(usize),
    /// A control of a kind that the layout does not have.
    #[error(
        "u is held between samples; this layout stores a control that is linear between them, or constant"
    )]
    HeldControl,
    /// An actuated coordinate that does not exist.
    #[error("coordinate {index} cannot be the actuated one of {n}; it is counted from 0")]
    BadActuated {
        /// As given.
        index: usize,
        /// Number of coordinates.
        n: usize,
    },
}

/// A problem and its place, before the file is known.
pub(crate) type Fault = (Place, Problem);

/// Names, the first dozen of many.
fn list(names: &[String]) -> String {
    const MOST: usize = 12;
    let shown = names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{shown}, … ({} in all)", names.len()) } else { shown }
}
