//! Where a fit over windows begins.

use super::WindowLogs;
use crate::training::{Objective, linear_start};
use leastaction_core::model::ModelError;
use leastaction_models::Architecture;

/// Of rigid bodies the least-squares fit to smoothed states, if these windows are predicted better by it than by `initial`;
/// `initial` of all other models.
///
/// # Errors
/// As [`linear_start`].
pub fn first_guess(
    architecture: &Architecture,
    logs: &WindowLogs,
    initial: Vec<f64>,
    windows: &dyn Objective,
) -> Result<Vec<f64>, ModelError> {
    if architecture.family.bodies().is_none() {
        return Ok(initial);
    }
    let guess = linear_start(architecture, logs.smoothed().each_ref().map(Vec::as_slice))?;
    let loss = |weights: &[f64]| windows.held_back_loss(weights);
    Ok(if loss(&guess) < loss(&initial) { guess } else { initial })
}
