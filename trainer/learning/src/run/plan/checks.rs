//! Checks that data, model and loss fit each other.

use super::PlanError;
use crate::config::{Config, OptimiserKind, TrainingConfig, TrainingLoss};
use crate::data::Dataset;
use crate::windows::{Calibration, Setting};
use leastaction_models::{Architecture, OpenGauge};

/// Refuses data with another number of coordinates.
pub(super) fn check_coordinates(architecture: &Architecture, data: &Dataset) -> Result<(), PlanError> {
    if architecture.n() == data.n {
        return Ok(());
    }
    Err(PlanError::Coordinates(architecture.family.mismatch(data.n)))
}

/// Refuses a given noise of logged states unless the loss can take it into account.
pub(super) fn check_state_noise(training: &TrainingConfig, loss: TrainingLoss) -> Result<(), PlanError> {
    let takes = (loss, training.optimiser) == (TrainingLoss::Acceleration, OptimiserKind::LevenbergMarquardt);
    if takes || training.state_noise.is_none() { Ok(()) } else { Err(PlanError::StateNoise) }
}

/// Refuses to learn those sensor and drive numbers that the fit of an arm to torques cannot learn.
pub(super) fn check_torque_calibration(
    config: &Config,
    architecture: &Architecture,
    loss: TrainingLoss,
) -> Result<(), PlanError> {
    let is_fit = loss == TrainingLoss::Torque && architecture.family.arm().is_some();
    let Calibration { zero, gain, delay, lag, .. } = config.calibration.calibration();
    let is_learned = zero || [gain, delay, lag].contains(&Setting::Learned);
    if is_fit && is_learned { Err(PlanError::TorqueCalibration) } else { Ok(()) }
}

/// Refuses a loss of torques for a model whose commands are positions.
pub(super) fn check_servo(architecture: &Architecture, loss: TrainingLoss) -> Result<(), PlanError> {
    let takes = !architecture.group_laws.has_servos() || loss != TrainingLoss::Torque;
    if takes { Ok(()) } else { Err(PlanError::ServoTorque) }
}

/// Refuses numbers that free motion does not determine.
pub(super) fn check_gauge(architecture: &Architecture, forced: bool) -> Result<(), PlanError> {
    match architecture.family.open_gauge().filter(|_| !forced) {
        None => Ok(()),
        Some(_) if architecture.group_laws.has_servos() => Err(PlanError::ServoScale),
        Some(OpenGauge::Masses { types, of }) => Err(PlanError::Masses { types, of }),
        Some(OpenGauge::Torques) => Err(PlanError::NoTorques),
    }
}
