//! `[data.join]`: further files of each recording; `leave_out`: time intervals that are not learned from.

use super::column::ColumnConfig;
use crate::data::{Column, Join, LeftOut};
use serde::de::{Deserializer, Error};
use serde::{Deserialize, Serialize, Serializer};
use std::path::PathBuf;

/// Another file of every recording: `torque = { replace = ["encoders", "torques"], t = "stamp" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JoinConfig {
    /// Text to replace in the path of the coordinates' file (its last occurrence), and the replacement that gives the path of this file.
    replace: [String; 2],
    /// Time column; by default named as in the coordinates' file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    t: Option<ColumnConfig>,
}

impl JoinConfig {
    /// The join as the reader of logs takes it; `t` is the time column of the coordinates.
    pub(super) fn named(&self, name: &str, t: &Column) -> Join {
        let [replace, by] = self.replace.clone();
        let t = self.t.as_ref().map_or_else(|| t.clone(), |t| t.0.clone());
        Join { name: name.to_owned(), replace, by, t }
    }
}

/// A time interval (s) of every file, `[2.0, 3.5]`, or of a single file, `{ file = "run-3.csv", from = 2.0, to = 3.5 }`.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOutConfig(
    /// The interval as the reader of logs takes it.
    pub LeftOut,
);

/// Textual form of an interval.
#[derive(Serialize, Deserialize)]
#[serde(untagged, expecting = "an interval is [from, to] in s, or { file = \"…\", from = …, to = … }")]
enum Written {
    Of([f64; 2]),
    InFile(InFile),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct InFile {
    file: PathBuf,
    from: f64,
    to: f64,
}

impl Serialize for LeftOutConfig {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let LeftOut { file, from, to: end } = self.0.clone();
        let written = match file {
            Some(file) => Written::InFile(InFile { file, from, to: end }),
            None => Written::Of([from, end]),
        };
        written.serialize(to)
    }
}

impl<'de> Deserialize<'de> for LeftOutConfig {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let left = match Written::deserialize(from)? {
            Written::Of([from, to]) => LeftOut { file: None, from, to },
            Written::InFile(InFile { file, from, to }) => LeftOut { file: Some(file), from, to },
        };
        // The comparison also fails for NaN.
        if left.from <= left.to {
            Ok(Self(left))
        } else {
            Err(Error::custom(format!(
                "an interval goes from {} to {} s; it begins before it ends",
                left.from, left.to
            )))
        }
    }
}
