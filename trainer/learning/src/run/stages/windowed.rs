//! Data of a loss over windows.

use super::PlanError;
use crate::training::Residuals;
use crate::windows::{CalibrationLayout, WindowLogs, WindowLoss, WindowModel, WindowSettings};
use leastaction_models::Architecture;
use std::ops::Range;
use std::sync::Arc;

/// Number of windows that shows which combinations of numbers are free.
const ENOUGH_WINDOWS: usize = 256;

/// Logs and settings of a loss over windows, for the stage in which everything is learned.
pub(in crate::run) struct Windowed {
    pub logs: Arc<WindowLogs>,
    pub settings: WindowSettings,
    /// Positions of the learned sensor and actuator numbers.
    pub layout: CalibrationLayout,
    /// Largest number of windows whose residuals are shown.
    pub shown: usize,
    /// Whether the windows of the last stage are those that are shown.
    pub ends_with_shown: bool,
}

impl Windowed {
    /// The loss over windows of all logs.
    ///
    /// # Errors
    /// [`PlanError`] for a model that [`WindowModel::new`] refuses, or logs that [`WindowLoss::new`] refuses.
    pub fn loss(&self, architecture: &Architecture) -> Result<WindowLoss, PlanError> {
        Ok(self.loss_over(architecture, 0..self.logs.count(), self.settings)?.with_at_most(self.shown))
    }

    /// The loss over a part of the windows of all logs that shows what all of them leave free; `None` if there are no more.
    pub fn part(&self, architecture: &Architecture) -> Option<WindowLoss> {
        let all = self.loss(architecture).ok()?;
        (Residuals::samples(&all) > ENOUGH_WINDOWS).then(|| all.with_at_most(ENOUGH_WINDOWS))
    }

    /// The loss over adjacent windows of `steps` steps, for some of the logs.
    ///
    /// # Errors
    /// [`PlanError`] as for [`Windowed::loss`].
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
