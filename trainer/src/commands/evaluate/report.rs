//! The measures, as JSON and in words.

use super::long_term::LongTerm;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// The measures.
#[derive(Serialize)]
pub struct Report {
    pub model: PathBuf,
    pub data: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tree: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub graph: Option<String>,
    pub order: u8,
    pub h: f64,
    /// Between samples, where it changes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<&'static str>,
    pub trajectories: usize,
    pub samples: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_mse: Option<f64>,
    /// As a part of the mean squared acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_relative: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_step_mse: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rollout_mse: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rollout_median: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rollout_mse_100: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_mse: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia_mse: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prediction: Option<LongTerm>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { trajectories, samples, order, h, .. } = self;
        let control = self.control.map_or(String::new(), |control| format!(", control {control}"));
        let named = |what, name: &Option<String>| {
            name.as_ref().map_or(String::new(), |name| format!("{what} {name}; "))
        };
        let part = named("tree", &self.tree) + &named("graph", &self.graph);
        writeln!(
            f,
            "{part}{trajectories} trajectories, {samples} samples; order {order}, step {h} s{control}; mean squared errors"
        )?;
        let rows = [
            ("acceleration", self.acceleration_mse),
            ("  relative to its mean square", self.acceleration_relative),
            ("position, one step ahead", self.one_step_mse),
            ("position, whole trajectories", self.rollout_mse),
            ("  median over trajectories", self.rollout_median),
            ("  first 100 steps", self.rollout_mse_100),
            ("energy along them (J²)", self.energy_mse),
            ("inertia matrix", self.inertia_mse),
        ];
        let present = rows.iter().filter_map(|(name, value)| Some((name, (*value)?)));
        present.into_iter().try_for_each(|(name, value)| writeln!(f, "{name:<30} {value:.3e}"))?;
        self.prediction.iter().try_for_each(|prediction| write!(f, "\n{prediction}"))
    }
}
