//! Descriptions of data sets: `meta/info.json`.

use crate::lerobot_problem::LerobotProblem;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Versions that are read.
const VERSIONS: [&str; 3] = ["v2.0", "v2.1", "v3.0"];

/// Features that number samples, and are no measurements.
const NUMBERING: [&str; 5] = ["timestamp", "frame_index", "episode_index", "index", "task_index"];

/// A description of a data set.
#[derive(Deserialize)]
pub(super) struct Info {
    codebase_version: String,
    /// Samples a second.
    pub fps: f64,
    /// Template of the paths of data files.
    pub data_path: String,
    /// Episodes of a folder of version 2.
    #[serde(default = "thousand")]
    pub chunks_size: u64,
    pub total_episodes: u64,
    pub total_frames: usize,
    pub features: BTreeMap<String, Feature>,
}

/// A feature of every sample.
#[derive(Deserialize)]
pub(super) struct Feature {
    dtype: String,
    shape: Vec<usize>,
    #[serde(default)]
    names: Value,
}

fn thousand() -> u64 {
    1000
}

impl Info {
    /// Reads a description; another version is told from a damaged one.
    pub fn parse(text: &[u8]) -> Result<Self, LerobotProblem> {
        let no = |reason: String| LerobotProblem::Info(reason);
        let value: Value = serde_json::from_slice(text).map_err(|error| no(error.to_string()))?;
        match value.get("codebase_version").and_then(Value::as_str) {
            Some(version) if !VERSIONS.contains(&version) => {
                return Err(LerobotProblem::Version(version.to_owned()));
            }
            _ => {}
        }
        let info: Self = serde_json::from_value(value).map_err(|error| no(error.to_string()))?;
        let is_rate = info.fps.is_finite() && info.fps > 0.0;
        if is_rate { Ok(info) } else { Err(no(format!("fps is {}, not a rate above 0", info.fps))) }
    }

    /// Whether every episode has a file of its own.
    pub fn has_file_per_episode(&self) -> bool {
        self.codebase_version.starts_with("v2")
    }

    /// The features that are vectors of numbers, with their names.
    pub fn vectors(&self) -> impl Iterator<Item = (&String, &Feature)> {
        self.features.iter().filter(|(_, feature)| feature.width().is_some())
    }

    /// The vectors that were measured or commanded.
    pub fn measured(&self) -> impl Iterator<Item = (&String, &Feature)> {
        self.vectors().filter(|(name, _)| !NUMBERING.contains(&name.as_str()))
    }
}

impl Feature {
    /// Numbers in a sample; `None` for images, texts and arrays of more than one axis.
    pub fn width(&self) -> Option<usize> {
        let is_number = ["float", "int", "uint", "bool"].iter().any(|kind| self.dtype.starts_with(kind));
        match self.shape[..] {
            [width] if is_number && width > 0 => Some(width),
            _ => None,
        }
    }

    /// Names of the elements, as `shoulder_pan.pos`; none unless each has one.
    pub fn elements(&self) -> Vec<&str> {
        let list = match &self.names {
            // Older data sets have them under the kind of their elements, as {"motors": [...]}.
            Value::Object(kinds) => kinds.values().find_map(Value::as_array),
            names => names.as_array(),
        };
        let names: Vec<&str> = list.into_iter().flatten().filter_map(Value::as_str).collect();
        if Some(names.len()) == self.width() { names } else { Vec::new() }
    }
}
