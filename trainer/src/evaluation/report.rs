//! Results of an evaluation, as JSON and in words.

use super::long_term::LongTerm;
use leastaction_learning::data::Dataset;
use leastaction_learning::evaluate::integration_errors;
use leastaction_learning::torque_numbers::TorqueNumbers;
use leastaction_learning::training::Solved;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::PathBuf;

/// Results of an evaluation.
#[derive(Serialize)]
pub struct Report {
    /// The model.
    pub model: PathBuf,
    /// The log.
    pub data: PathBuf,
    /// Name of the tree, if the model has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tree: Option<String>,
    /// Name of the graph, if the model has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub graph: Option<String>,
    /// Order of the steps.
    pub order: u8,
    /// Step, s.
    pub h: f64,
    /// Control kind, if the control changes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<&'static str>,
    /// Number of trajectories in the log.
    pub trajectories: usize,
    /// Number of samples in the log.
    pub samples: usize,
    /// Errors of accelerations, if the log has velocities and accelerations.
    #[serde(flatten)]
    pub acceleration: Option<Acceleration>,
    /// Errors of torques, if every coordinate is driven.
    #[serde(flatten)]
    pub torques: Option<Torques>,
    /// Errors of steps in double precision; `None` for a model with rods.
    #[serde(flatten)]
    pub steps: Option<Steps>,
    /// Errors of steps in the chip's arithmetic; `None` if core is not compiled for the model's size here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chip: Option<Steps>,
    /// Error of the inertia matrix, compared with an exact mechanism.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia_mse: Option<f64>,
    /// Predictions from random starts, compared with an exact system.
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
        self.acceleration.iter().try_for_each(|acceleration| write!(f, "{acceleration}"))?;
        self.torques.iter().try_for_each(|torques| write!(f, "{torques}"))?;
        self.steps.iter().try_for_each(|steps| steps.write(f, ""))?;
        if let Some(chip) = &self.chip {
            writeln!(f, "on the chip, in single precision")?;
            chip.write(f, "  ")?;
        }
        self.inertia_mse.iter().try_for_each(|error| row(f, "inertia matrix", Some(*error)))?;
        self.prediction.iter().try_for_each(|prediction| write!(f, "\n{prediction}"))
    }
}

/// Errors of accelerations.
#[derive(Serialize)]
pub struct Acceleration {
    /// Mean squared error over the samples that can be computed; `None` if there are none. The ratio below covers the
    /// same samples.
    pub acceleration_mse: Option<f64>,
    /// Ratio to the mean squared acceleration.
    pub acceleration_relative: Option<f64>,
    /// Number of samples for which the model has no acceleration.
    pub acceleration_unsolved: usize,
}

/// Errors of torques; motion and torques are filtered alike.
#[derive(Serialize)]
pub struct Torques {
    /// Mean over joints of mean squared error divided by variance.
    pub torque_nmse: f64,
    /// Root mean squared error of every joint, N m or N.
    pub torque_rmse: Vec<f64>,
    /// Estimates of an arm's base parameters and friction from the log alone.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "rows_of")]
    pub torque_numbers: Option<TorqueNumbers>,
}

fn rows_of<S: Serializer>(numbers: &Option<TorqueNumbers>, serializer: S) -> Result<S::Ok, S::Error> {
    numbers.as_ref().map(TorqueNumbers::rows).serialize(serializer)
}

impl fmt::Display for Torques {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        row(f, "torque, over its variance", Some(self.torque_nmse))?;
        let rmse = self.torque_rmse.iter().map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(" ");
        writeln!(f, "{:<30} {rmse}", "  root mean square, N m")?;
        self.torque_numbers.iter().try_for_each(|numbers| write!(f, "{numbers}"))
    }
}

/// Errors of steps.
#[derive(Serialize)]
pub struct Steps {
    /// Mean squared error of the steps that can be solved; `None` if there are none.
    pub one_step_mse: Option<f64>,
    /// Number of steps that cannot be solved.
    pub one_step_unsolved: usize,
    /// Mean squared error of the rollouts that reach the end; `None` if there are none. The rollout errors below cover
    /// the same rollouts.
    pub rollout_mse: Option<f64>,
    /// Median over rollouts.
    pub rollout_median: Option<f64>,
    /// Error over the first 100 steps.
    pub rollout_mse_100: Option<f64>,
    /// Number of rollouts that break off.
    pub rollouts_broken_off: usize,
    /// Mean squared error of the exact energy along the rollouts, J².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_mse: Option<f64>,
}

impl fmt::Display for Acceleration {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        row(f, "acceleration", self.acceleration_mse)?;
        row(f, "  relative to its mean square", self.acceleration_relative)?;
        left_out(f, self.acceleration_unsolved, "samples have no acceleration")
    }
}

impl Steps {
    /// Errors of single steps, and of the rollouts that reach the end (out of `rollouts`), compared with the true motions.
    pub fn new(one_step: Solved, (runs, motions): (&[Vec<f64>], &Dataset), rollouts: usize) -> Self {
        let errors = (!runs.is_empty()).then(|| integration_errors(runs, motions));
        Self {
            one_step_mse: one_step.mean_square,
            one_step_unsolved: one_step.unsolved,
            rollout_mse: errors.as_ref().map(|errors| errors.mean),
            rollout_median: errors.as_ref().map(|errors| errors.median),
            rollout_mse_100: errors.as_ref().map(|errors| errors.first_100),
            rollouts_broken_off: rollouts - runs.len(),
            energy_mse: None,
        }
    }

    fn write(&self, f: &mut fmt::Formatter, indent: &str) -> fmt::Result {
        let row = |f: &mut fmt::Formatter, name, value| row(f, &format!("{indent}{name}"), value);
        row(f, "position, one step ahead", self.one_step_mse)?;
        left_out(f, self.one_step_unsolved, "steps cannot be solved")?;
        row(f, "position, whole trajectories", self.rollout_mse)?;
        row(f, "  median over trajectories", self.rollout_median)?;
        row(f, "  first 100 steps", self.rollout_mse_100)?;
        self.energy_mse.iter().try_for_each(|error| row(f, "energy along them (J²)", Some(*error)))?;
        left_out(f, self.rollouts_broken_off, "trajectories break off at a step that cannot be solved")
    }
}

fn row(f: &mut fmt::Formatter, name: &str, value: Option<f64>) -> fmt::Result {
    let value = value.map_or("none".to_owned(), |value| format!("{value:.3e}"));
    writeln!(f, "{name:<30} {value}")
}

/// Writes how many cases the rows above do not include.
fn left_out(f: &mut fmt::Formatter, count: usize, what: &str) -> fmt::Result {
    if count == 0 { Ok(()) } else { writeln!(f, "  without {count}: these {what}") }
}
