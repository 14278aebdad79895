//! Why a run cannot begin.

use super::super::TorqueError;
use crate::data::{Doubt, control_name};
use crate::torque::fit::FitError;
use crate::training::SampleError;
use crate::windows::TooShort;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::ModelError;
use leastaction_models::config::ShapeError;
use thiserror::Error;

/// A run that cannot begin.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlanError {
    /// The data has another number of coordinates than the model.
    #[error("{0}")]
    Coordinates(String),
    /// A loss of torques without torques.
    #[error(
        "an arm, and whatever has loss = \"torque\", is learned from the torques of its drives, and the data has none (u is zero or missing); \
         add them under [data.columns]"
    )]
    NoTorques,
    /// An arm that cannot be fitted to the torques.
    #[error("{0}")]
    Fit(#[from] FitError),
    /// A log that does not become samples of torques.
    #[error("{0}")]
    Torques(#[from] TorqueError),
    /// Masses that nothing determines.
    #[error(
        "[[model.{types}]]: every mass of the {of} is learned, but no sample is forced (u is zero or missing), and free motion does \
         not show a common factor of all masses; give one type a known mass, as mass = 1.0, or log motion under a known force"
    )]
    Masses {
        /// The key of the types.
        types: &'static str,
        /// Tree or graph.
        of: &'static str,
    },
    /// The trees or graphs and their types cannot be.
    #[error("{0}")]
    Shape(#[from] ShapeError),
    /// A DEL-residual loss without any force.
    #[error(
        "no sample is forced (u is zero or missing), and without a force the DEL residual is least for L = 0, which is \
         no model; log motion under a known force, or set loss = \"next-position\""
    )]
    Unforced,
    /// The data lacks what the loss needs.
    #[error("{0}; add it to the data, or set loss = \"next-position\", which needs positions alone")]
    Samples(#[from] SampleError),
    /// The log and the configuration say different things of the control.
    #[error(
        "[data] control = {:?}, but the log says that its u is {stated} between samples; set control = {stated:?}, or leave it out",
        control_name(*.asked), stated = control_name(*.stated)
    )]
    Control {
        /// By the configuration.
        asked: ControlKind,
        /// By the log.
        stated: ControlKind,
    },
    /// Only accelerations at noisy states are learned with them.
    #[error(
        "[training] state_noise takes loss = \"acceleration\" and optimiser = \"levenberg-marquardt\"; of noisy positions over time \
         loss = \"windows\" finds the states itself"
    )]
    StateNoise,
    /// Nothing to choose from.
    #[error("[data.columns] names no columns of u to choose from")]
    NoColumns,
    /// Only windows learn sensors and actuators.
    #[error("[calibration] is learned over windows; set [training] loss = \"windows\", or leave it out")]
    Calibration,
    /// A fit to torques takes all logs as they are, but for a constant.
    #[error(
        "[calibration] loss = \"torque\" learns offset alone: a gain is a factor of all masses there, and motion is taken where and when it was \
         logged; give gain and delay as numbers, or set loss = \"windows\""
    )]
    TorqueCalibration,
    /// Only over windows, of coordinates that can have them, networks are tried.
    #[error(
        "[training] try_networks: networks correct models of coordinates, which a graph has not, over windows; set loss = \"windows\", or \
         leave it out"
    )]
    Networks,
    /// Only windows are integrated.
    #[error("[training] integrator is of windows; set loss = \"windows\", or leave it out")]
    Integrator,
    /// Only Levenberg–Marquardt eliminates start states.
    #[error("loss = \"windows\" takes optimiser = \"levenberg-marquardt\"")]
    WindowOptimiser,
    /// No trajectory is as long as a window.
    #[error("[training] window: {0}")]
    Window(#[from] TooShort),
    /// The data holds a number that cannot be one.
    #[error("{0}")]
    Data(Doubt),
    /// The shape does not fit in itself or the data.
    #[error("[model]: {0}")]
    Model(#[from] ModelError),
}
