//! Errors that keep a run from beginning.

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
    /// The loss needs torques, but the data has none.
    #[error(
        "an arm, and whatever has loss = \"torque\", is learned from the torques of its drives, and the data has none (u is zero or missing); \
         add them under [data.columns]"
    )]
    NoTorques,
    /// A loss of torques for a model whose commands are positions.
    #[error(
        "loss = \"torque\" needs the torques of the drives, and with `servo` the commands are positions; set loss = \"windows\", \
         which needs positions alone"
    )]
    ServoTorque,
    /// Servos of unknown stiffness move bodies of unknown mass.
    #[error(
        "`servo` learns the stiffness and the model learns every body, but positions show only their ratio: a log without torques moves \
         alike if all masses, friction and stiffnesses are doubled; give one of them, as bodies = \"known\" (of an arm), a known mass, or \
         servo = {{ stiffness = 17.0, damping = \"learned\" }}"
    )]
    ServoScale,
    /// An arm cannot be fitted to the torques.
    #[error("{0}")]
    Fit(#[from] FitError),
    /// A log cannot be made into torque samples.
    #[error("{0}")]
    Torques(#[from] TorqueError),
    /// The masses are not determined.
    #[error(
        "[[model.{types}]]: every mass of the {of} is learned, but no sample is forced (u is zero or missing), and free motion does \
         not show a common factor of all masses; give one type a known mass, as mass = 1.0, or log motion under a known force"
    )]
    Masses {
        /// Configuration key of the types.
        types: &'static str,
        /// "tree" or "graph".
        of: &'static str,
    },
    /// The trees or graphs, or their types, are invalid.
    #[error("{0}")]
    Shape(#[from] ShapeError),
    /// The loss is the DEL residual, but no force acts.
    #[error(
        "no sample is forced (u is zero or missing), and without a force the DEL residual is least for L = 0, which is \
         no model; log motion under a known force, or set loss = \"next-position\""
    )]
    Unforced,
    /// The data lacks what the loss needs.
    #[error("{0}; add it to the data, or set loss = \"next-position\", which needs positions alone")]
    Samples(#[from] SampleError),
    /// The log and the configuration disagree on the control.
    #[error(
        "[data] control = {:?}, but the log says that its u is {stated} between samples; set control = {stated:?}, or leave it out",
        control_name(*.asked), stated = control_name(*.stated)
    )]
    Control {
        /// Control kind in the configuration.
        asked: ControlKind,
        /// Control kind in the log.
        stated: ControlKind,
    },
    /// State noise is only estimated with the acceleration loss and Levenberg–Marquardt.
    #[error(
        "[training] state_noise takes loss = \"acceleration\" and optimiser = \"levenberg-marquardt\"; of noisy positions over time \
         loss = \"windows\" finds the states itself"
    )]
    StateNoise,
    /// There are no columns to choose from.
    #[error("[data.columns] names no columns of u to choose from")]
    NoColumns,
    /// Sensors and actuators are only learned over windows.
    #[error("[calibration] is learned over windows; set [training] loss = \"windows\", or leave it out")]
    Calibration,
    /// A fit to torques can learn an offset, but no other calibration number.
    #[error(
        "[calibration] loss = \"torque\" learns offset alone: a gain is a factor of all masses there, and motion is taken where and when it was \
         logged; give gain, delay and lag as numbers, or set loss = \"windows\""
    )]
    TorqueCalibration,
    /// Networks are only tried over windows, and only beside models with coordinates.
    #[error(
        "[training] try_networks: networks correct models of coordinates, which a graph has not, over windows; set loss = \"windows\", or \
         leave it out"
    )]
    Networks,
    /// An integrator is only used for windows.
    #[error("[training] integrator is of windows; set loss = \"windows\", or leave it out")]
    Integrator,
    /// Windows need Levenberg–Marquardt, which eliminates start states.
    #[error("loss = \"windows\" takes optimiser = \"levenberg-marquardt\"")]
    WindowOptimiser,
    /// No trajectory is as long as a window.
    #[error("[training] window: {0}")]
    Window(#[from] TooShort),
    /// The data holds an impossible number.
    #[error("{0}")]
    Data(Doubt),
    /// The shape is inconsistent or does not fit the data.
    #[error("[model]: {0}")]
    Model(#[from] ModelError),
}
