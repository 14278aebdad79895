//! What a loss over windows learns from.

use super::PlanError;
use crate::windows::{CalibrationLayout, WindowLogs, WindowLoss, WindowModel, WindowSettings};
use leastaction_models::Architecture;
use std::ops::Range;
use std::sync::Arc;

/// What is learned from over windows, once all of it is.
pub(in crate::run) struct Windowed {
    pub logs: Arc<WindowLogs>,
    pub settings: WindowSettings,
    /// Where what is learned of sensors and actuators is.
    pub layout: CalibrationLayout,
}

impl Windowed {
    /// The loss over all logs.
    ///
    /// # Errors
    /// As [`WindowModel::new`] and [`WindowLoss::new`].
    pub fn loss(&self, architecture: &Architecture) -> Result<WindowLoss, PlanError> {
        self.loss_over(architecture, 0..self.logs.count(), self.settings)
    }

    /// That over windows of so many steps, side by side, of some logs.
    ///
    /// # Errors
    /// As [`Windowed::loss`].
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
