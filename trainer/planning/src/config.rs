//! The configuration of a plan, as it is written.

use crate::PlanError;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Configuration of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanConfig {
    /// Model file, run folder, or robot description (URDF or MJCF), all of whose numbers are then known.
    pub model: PathBuf,
    /// Tree of a model file that holds several.
    pub part: Option<String>,
    /// Tick, s; by default the step that the model was trained with.
    pub tick: Option<f64>,
    /// Order of the step, 2 or 4; by default that of the model's step, else 2.
    pub order: Option<u8>,
    /// Duration, s, or the shortest and the longest if the time is free.
    pub seconds: Seconds,
    /// Number of ticks for which a command is held; by default as many as keep the motion below 500 nodes.
    pub ticks_per_node: Option<u16>,
    /// Start of the motion.
    pub start: StartConfig,
    /// End of the motion.
    pub goal: GoalConfig,
    /// Limits that hold.
    #[serde(default)]
    pub limits: LimitsConfig,
    /// Limits that only cost.
    #[serde(default)]
    pub soft: SoftConfig,
    /// Cost.
    #[serde(default)]
    pub cost: CostConfig,
    /// Search.
    #[serde(default)]
    pub search: SearchConfig,
    /// Gains that follow the plan.
    #[serde(default)]
    pub follow: FollowConfig,
    /// Trial of the plan.
    #[serde(default)]
    pub check: CheckConfig,
    /// Policy from anywhere; not used by a plan.
    #[serde(default)]
    pub policy: PolicyConfig,
}

/// Number of nodes below which a motion is divided into ticks by default.
pub const DEFAULT_NODES: usize = 500;

/// Duration of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number of seconds, or [shortest, longest]")]
pub enum Seconds {
    /// A fixed time.
    Fixed(f64),
    /// The shortest and the longest time.
    Free([f64; 2]),
}

/// Start of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartConfig {
    /// Position, rad or m.
    pub q: Vec<f64>,
    /// Velocity; by default 0.
    pub v: Option<Vec<f64>>,
}

/// A number, or an interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number, [least, most], or [] for any")]
pub enum Range {
    /// A single number.
    One(f64),
    /// The least and the most.
    Interval([f64; 2]),
    /// Any number.
    Any([f64; 0]),
}

/// End of a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GoalConfig {
    /// Position, rad or m: numbers to be reached, or intervals.
    pub q: Option<Vec<Range>>,
    /// Velocity; by default 0, with an energy any.
    pub v: Option<Vec<Range>>,
    /// Energy T + V, J.
    pub energy: Option<f64>,
}

/// Limits that hold.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsConfig {
    /// Largest |u| of every coordinate, or an interval; 0: not driven.
    pub u: Option<Vec<Range>>,
    /// Positions, intervals.
    pub q: Option<Vec<Range>>,
    /// Largest |v|, or intervals.
    pub v: Option<Vec<Range>>,
    /// Part of the range of every command that is kept for feedback, 0 ≤ reserve < 1.
    pub reserve: f64,
}

/// Limits that only cost: ½ weight e² per second of an excess e.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SoftConfig {
    /// Positions, intervals.
    pub q: Option<Vec<Range>>,
    /// Largest |v|, or intervals.
    pub v: Option<Vec<Range>>,
    /// Weight of an excess.
    pub weight: f64,
}

impl Default for SoftConfig {
    fn default() -> Self {
        Self { q: None, v: None, weight: 100.0 }
    }
}

/// Cost per second of motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CostConfig {
    /// Weights r of ½ r u²; by default the inverse squares of the limits.
    pub u: Option<Vec<f64>>,
    /// Weights of ½ (q − q_goal)²; by default 0.
    pub q: Option<Vec<f64>>,
    /// Weights of ½ (v − v_goal)²; by default 0.
    pub v: Option<Vec<f64>>,
    /// Cost of a second, for a free time.
    pub time: f64,
}

/// Search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SearchConfig {
    /// Seed of the random start guesses.
    pub seed: u64,
    /// Number of start guesses, optimised side by side.
    pub starts: usize,
    /// Maximum number of iterations of each.
    pub iterations: u16,
}

impl Default for SearchConfig {
    fn default() -> Self {
        Self { seed: 0, starts: 8, iterations: 500 }
    }
}

/// Deviations of equal weight for the gains that follow the plan (Bryson's rule).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FollowConfig {
    /// Deviations of the positions; by default 0.1 rad or m.
    pub q: Option<Vec<f64>>,
    /// Deviations of the velocities; by default 1 rad/s or m/s.
    pub v: Option<Vec<f64>>,
    /// Deviations of the commands; by default half the limits.
    pub u: Option<Vec<f64>>,
}

/// Trial of the plan: the law follows it from random starts, also on a plant whose masses are off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CheckConfig {
    /// Number of starts; 0: no trial.
    pub starts: usize,
    /// Largest deviation of the positions, rad or m.
    pub q: f64,
    /// Largest deviation of the velocities, rad/s or m/s.
    pub v: f64,
    /// Part by which every body's mass is off, up or down.
    pub masses: f64,
}

impl Default for CheckConfig {
    fn default() -> Self {
        Self { starts: 20, q: 0.05, v: 0.1, masses: 0.05 }
    }
}

/// Policy from anywhere to the goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PolicyConfig {
    /// Number of starts from which motions are searched before the first command.
    pub starts: usize,
    /// Distances of positions from the goal within which the regulator is tried; by default 0.1 rad or m.
    pub q: Option<Vec<f64>>,
    /// Distances of velocities from 0 within which the regulator is tried; by default 0.5 rad/s or m/s.
    pub v: Option<Vec<f64>>,
    /// Velocities of the starts; by default those that the energy between start and goal makes.
    pub speeds: Option<Vec<f64>>,
}

impl Default for PolicyConfig {
    fn default() -> Self {
        Self { starts: 128, q: None, v: None, speeds: None }
    }
}

impl PlanConfig {
    /// Reads a configuration; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`PlanError::Read`], [`PlanError::Invalid`].
    pub fn read(file: &Path) -> Result<Self, PlanError> {
        let text = std::fs::read_to_string(file)
            .map_err(|error| PlanError::Read { file: file.to_owned(), error })?;
        let mut config = Self::parse(&text, file)?;
        if let Some(folder) = file.parent() {
            config.model = folder.join(&config.model);
        }
        Ok(config)
    }

    /// Parses a configuration; `file` is its name in errors.
    ///
    /// # Errors
    /// [`PlanError::Invalid`].
    pub fn parse(text: &str, file: &Path) -> Result<Self, PlanError> {
        toml::from_str(text).map_err(|error| PlanError::invalid(file, text, &error))
    }
}
