//! The end of a run, with its messages and its report.

use super::error::stuck;
use super::{Monitor, Run, RunError, report, within};
use crate::report::ReportError;
use crate::training::Objective;
use crate::windows::Certainty;

/// The reason why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The iteration limit is reached.
    Iterations,
    /// No step lowers the loss any more.
    Converged,
    /// The training loss has reached its target.
    Target,
    /// The validation loss has not fallen for too many iterations.
    Patience,
    /// The time limit is reached.
    Time,
    /// Stopped from outside.
    Interrupted,
}

impl Ending {
    /// One-word name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iterations => "iterations",
            Self::Converged => "converged",
            Self::Target => "target",
            Self::Patience => "patience",
            Self::Time => "time",
            Self::Interrupted => "interrupted",
        }
    }
}

impl Run {
    /// Precision of the best numbers, as the report states it; `None` if the run does not learn over windows.
    pub fn certainty(&self) -> Option<Certainty> {
        within(self.pool.as_ref(), || report::certainty(&self.plan, &self.state))
    }

    /// Moves the best numbers along what the logs leave free, back to where the run begins.
    pub(super) fn hold_what_is_free(&mut self) {
        let Self { plan, state, pool, .. } = self;
        within(pool.as_ref(), || state.hold_what_is_free(plan));
    }

    /// The error of a loss that cannot be evaluated.
    pub(super) fn stuck(&self) -> RunError {
        stuck(&self.plan, self.stage().map_or("", |stage| stage.name), self.state.iteration)
    }

    /// Writes the report page, if the run learned over windows.
    pub(super) fn write_report(&self) -> Result<(), ReportError> {
        match within(self.pool.as_ref(), || report::html(&self.plan, &self.state))? {
            Some(page) => Ok(crate::atomic::write(&self.folder.report(), page.as_bytes())?),
            None => Ok(()),
        }
    }

    /// Number of training samples that cannot be solved with the best weights and thus count as predicted by a constant
    /// velocity, and the number of all training samples; `None` before the last stage.
    pub(super) fn unsolved(&self) -> Option<(usize, usize)> {
        let stage = self.stage().filter(|_| self.is_in_last_stage())?;
        Some((self.unsolved_of(&*stage.objective), stage.objective.samples()))
    }

    pub(super) fn is_in_last_stage(&self) -> bool {
        self.state.stage + 1 == self.plan.stages.len()
    }

    fn unsolved_of(&self, objective: &dyn Objective) -> usize {
        // The parameters of single samples differ between stages, and for held-back samples, so they are set anew.
        let weights = || objective.enter(self.state.best.weights.clone());
        within(self.pool.as_ref(), || objective.solved(&weights()).unsolved)
    }

    /// Warns of results that are useless although no error occurred.
    pub(super) fn say_what_was_not_learned(&self, unsolved: usize, monitor: &mut dyn Monitor) {
        if self.state.iteration > 0 && self.state.best.iteration == 0 {
            monitor.warning("nothing was learned: no iteration was better than the initial weights");
        }
        let Some(stage) = self.plan.stages.last() else { return };
        let mut say = |unsolved: usize, name: &str, objective: &dyn Objective| {
            if unsolved > 0 {
                monitor.warning(&format!(
                    "{unsolved} of {} {name} samples cannot be solved with the best weights: they count as predicted by a constant \
                     velocity",
                    objective.samples()
                ));
            }
        };
        say(unsolved, "training", &*stage.objective);
        if let Some(validation) = &stage.validation {
            say(self.unsolved_of(&**validation), "held-back", &**validation);
        }
    }
}
