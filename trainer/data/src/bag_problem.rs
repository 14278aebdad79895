//! Problems with bags of ROS 2.

use crate::problem::list;
use thiserror::Error;

/// Problem with a bag. The message says what to do about it.
#[derive(Debug, Error)]
pub enum BagProblem {
    /// A bag without column names.
    #[error(
        "which joints are the coordinates? Name them under [data.columns]; `leastaction look` lists them and writes a configuration"
    )]
    Unnamed,
    /// An unreadable MCAP file.
    #[error(
        "not a readable .mcap file: {0}; what is sound of a recording that was cut off can be saved by `mcap recover`"
    )]
    NotMcap(String),
    /// A chunk of an MCAP file that states too large an unpacked size.
    #[error(
        "a chunk says that it unpacks to {bytes} bytes; at most {most} are read: write the file with smaller chunks"
    )]
    LargeChunk {
        /// Stated size.
        bytes: u64,
        /// Limit.
        most: u64,
    },
    /// An MCAP file that unpacks to more than is plausible for its size.
    #[error(
        "its chunks unpack to {bytes} bytes up to here, more than the {most} that are read of a file of its size"
    )]
    Unpacked {
        /// Unpacked size so far.
        bytes: u64,
        /// Limit.
        most: u64,
    },
    /// A chunk of an MCAP file with an unknown compression.
    #[error("a chunk is compressed by {0:?}; zstd, lz4 and none are read: `mcap compress` writes them")]
    Compression(String),
    /// A message that does not match its schema.
    #[error("not a sensor_msgs/JointState in CDR: {0}")]
    NotJointState(&'static str),
    /// A bag without joint states.
    #[error("no messages of sensor_msgs/JointState in CDR, as ROS 2 writes them; the file has {}", list(.0))]
    NoJointStates(Vec<String>),
    /// A message with only some of the wanted joints of its topic.
    #[error(
        "{0} is missing, though other columns of this topic are there; name joints that are sent together"
    )]
    MissingJoint(String),
    /// A time of recording out of range.
    #[error("it was recorded {0} ns after 1970, which no clock says")]
    BadTime(u64),
    /// An unreadable `.db3` file.
    #[error("not a readable .db3 file: {0}; what is sound of it can be saved by `sqlite3 FILE .recover`")]
    NotDb3(String),
    /// A `.db3` file whose last messages are in another file.
    #[error(
        "{0} beside it has messages that are not in it yet: let the recorder end, or run `sqlite3 FILE \"PRAGMA wal_checkpoint(TRUNCATE)\"`"
    )]
    Unfinished(String),
    /// A message or text of a `.db3` file that is too long.
    #[error("a value of {bytes} bytes; at most {most} are read")]
    LargeValue {
        /// Size.
        bytes: u64,
        /// Limit.
        most: u64,
    },
    /// A folder without files of a bag.
    #[error(
        "no bag is in this folder: it has neither .mcap nor .db3 files, nor a data set of LeRobot, which has meta/info.json; name logs one by one, \
         or as FOLDER/*.csv"
    )]
    NoBag,
    /// A folder that lacks a file of its bag.
    #[error(
        "metadata.yaml names {0}, which is not in the folder; copy it there, or name the files of the bag one by one"
    )]
    NoPart(String),
    /// A file that is compressed as a whole.
    #[error("{0} is compressed as a whole; unpack it: `zstd -d {0}`")]
    PackedFile(String),
    /// A message that was compressed by itself, as `ros2 bag record --compression-mode message` does.
    #[error(
        "the messages are compressed one by one; write the bag again without: `ros2 bag convert -i BAG -o out.yaml`, where out.yaml is \
         \"output_bags: [{{uri: plain, all_topics: true}}]\""
    )]
    PackedMessage,
    /// A time that a bag cannot hold.
    #[error("a message at {0} s; a bag holds times from 0 to 2147483647 s")]
    NoStamp(f64),
}
