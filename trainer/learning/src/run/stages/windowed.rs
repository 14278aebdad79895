//! What a loss over windows learns from.

use super::PlanError;
use crate::windows::{CalibrationLayout, WindowLogs, WindowLoss, WindowModel, WindowSettings};
use leastaction_models::Architecture;
use std::ops::Range;
use std::sync::Arc;

/// Logs and settings of a loss over windows, once all of it is learned.
pub(in crate::run) struct Windowed {
    pub logs: Arc<WindowLogs>,
    pub settings: WindowSettings,
    /// Places of what is learned of sensors and actuators.
    pub layout: CalibrationLayout,
}

impl Windowed {
    /// The loss over all logs.
    ///
    /// # Errors
    /// [`PlanError`] for a model that [`WindowModel::new`], or logs that [`WindowLoss::new`], refuses.
    pub fn loss(&self, architecture: &Architecture) -> Result<WindowLoss, PlanError> {
        self.loss_over(architecture, 0..self.logs.count(), self.settings)
    }

    /// That over windows of so many steps, side by side, of some logs.
    ///
    /// # Errors
    /// [`PlanError`], see [`Windowed::loss`].
    pub fn loss_of(
        &self,
        architecture: &Architecture,
        of: Range<usize>,
        steps: usize,
    ) -> Result<WindowLoss, PlanError> {
        self.loss_over(architecture, of, WindowSettings { steps, stride: steps, ..self.settings })
    }

    fn loss_over(
        &self,
        architecture: &Architecture,
        of: Range<usize>,
        settings: WindowSettings,
    ) -> Result<WindowLoss, PlanError> {
        Ok(WindowLoss::new(WindowModel::new(architecture)?, &self.logs, of, settings)?)
    }
}
