//! Starting point of a fit over windows.

use super::WindowLogs;
use crate::training::{LinearStart, Objective, linear_start};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;

/// For planar bodies, and for arms whose commands are positions, the least-squares fit to smoothed states if it predicts these windows
/// better than `initial`. Otherwise, and for all other models, `initial`.
///
/// # Errors
/// See [`linear_start`].
pub fn first_guess(
    architecture: &Architecture,
    logs: &WindowLogs,
    initial: Vec<f64>,
    windows: &dyn Objective,
) -> Result<LinearStart, ModelError> {
    let is_servo_arm = architecture.family.arm().is_some() && architecture.group_laws.has_servos();
    if architecture.family.bodies().is_none() && !is_servo_arm {
        return Ok(LinearStart { weights: initial, shows_scale: true });
    }
    let guess = linear_start(architecture, logs.smoothed().each_ref().map(Vec::as_slice))?;
    let loss = |weights: &[f64]| windows.held_back_loss(weights);
    let weights = if loss(&guess.weights) < loss(&initial) { guess.weights } else { initial };
    Ok(LinearStart { weights, ..guess })
}
