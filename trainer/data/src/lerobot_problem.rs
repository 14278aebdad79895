//! Problems with data sets of LeRobot.

use crate::problem::list;
use thiserror::Error;

/// Problem with a data set of LeRobot. The message says what to do about it.
#[derive(Debug, Error)]
pub enum LerobotProblem {
    /// A data set, but this program was built without the reader of Parquet files.
    #[error(
        "it is a data set of LeRobot, which this program was built without: build it with `--features lerobot`, as in \
         `cargo install --path trainer --features lerobot`"
    )]
    NotBuilt,
    /// A description that cannot be read.
    #[error("meta/info.json is not as LeRobot writes it: {0}")]
    Info(String),
    /// A data set of another version.
    #[error("it is of version {0:?}; v2.0, v2.1 and v3.0 are read: convert it by LeRobot's own scripts")]
    Version(String),
    /// A template of paths that does not number the files.
    #[error(
        "data_path in meta/info.json is {path:?}, which does not number the files: {{{missing}}} is missing"
    )]
    Path {
        /// The template.
        path: String,
        /// Name of the missing number.
        missing: &'static str,
    },
    /// A data file that is not there.
    #[error("there is no {0}; download the data set as a whole")]
    NoFile(String),
    /// Fewer or more samples than the description says.
    #[error(
        "its data files have {found} frames, but total_frames in meta/info.json is {expected}: a file of data/ is missing, or is of another \
         data set"
    )]
    Frames {
        /// Number of samples.
        found: usize,
        /// Number that is stated.
        expected: usize,
    },
    /// A data set without column names.
    #[error(
        "which features are the coordinates, and in which unit? Name them under [data.columns]; `leastaction look` lists them and writes a \
         configuration; it has {}", list(.0)
    )]
    Unnamed(Vec<String>),
    /// An unreadable Parquet file.
    #[error("{file} is not a readable Parquet file: {reason}")]
    NotParquet {
        /// The file, within the data set.
        file: String,
        /// The reason.
        reason: String,
    },
    /// A feature that a data file lacks.
    #[error("{file} has no column {name:?}, which meta/info.json lists")]
    NoColumn {
        /// The file, within the data set.
        file: String,
        /// Name of the feature.
        name: String,
    },
    /// A compression that is not read.
    #[error(
        "{file} is compressed by {codec}; Snappy and none are read: write it again, as pyarrow.parquet.write_table does by default"
    )]
    Compression {
        /// The file, within the data set.
        file: String,
        /// Name of the codec.
        codec: String,
    },
    /// A sample of another size than the description says.
    #[error("row {row} of {file} has not {width} numbers, as shape in meta/info.json says")]
    Width {
        /// The file, within the data set.
        file: String,
        /// Row, from 0.
        row: usize,
        /// Stated size.
        width: usize,
    },
}
